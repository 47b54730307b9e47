use std::ops::Range;

use crate::extension::LineFault;

/// An event as a line writes it: its name, its fields, and the component that it is for.
///
/// ```
/// use saoms_api::event::EventCall;
///
/// let call = EventCall::read("fire at=(3, 4) size=1..3 to Hall1")?;
/// assert_eq!(call.name.text, "fire");
/// assert_eq!(call.arguments[0].value.text, "(3, 4)");
/// assert_eq!(call.arguments[1].ends().len(), 2);
/// assert_eq!(call.to.unwrap().text, "Hall1");
/// # Ok::<(), saoms_api::extension::LineFault>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EventCall {
    /// The name of the event.
    pub name: Word,
    /// Its fields, in the order in which they are written.
    pub arguments: Vec<Argument>,
    /// The component behind `to`; `None` for all that take the event.
    pub to: Option<Word>,
}

/// A word with its place in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// The word.
    pub text: String,
    /// Its bytes in the text.
    pub bytes: Range<usize>,
}

/// A field with its value: `size=2`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Argument {
    /// The name of the field.
    pub name: Word,
    /// The value, or two with `..` between them, from which one is drawn.
    pub value: Word,
}

/// The word before the component that an event is for.
const TO: &str = "to";

impl Word {
    fn of(text: &str, bytes: Range<usize>) -> Word {
        Word { text: text[bytes.clone()].to_owned(), bytes }
    }

    /// A word that stands in no text.
    pub(super) fn unplaced(text: &str) -> Word {
        Word { text: text.to_owned(), bytes: 0..0 }
    }

    pub(super) fn moved(&mut self, by: usize) {
        self.bytes = self.bytes.start + by..self.bytes.end + by;
    }
}

impl Argument {
    /// The value; of a range, both ends of it.
    pub fn ends(&self) -> Vec<Word> {
        let text = self.value.text.as_str();
        let Some(dots) = range_dots(text) else { return vec![self.value.clone()] };
        let start = self.value.bytes.start;
        let word = |part: Range<usize>| {
            let inner = &text[part.clone()];
            let from = part.start + (inner.len() - inner.trim_start().len());
            let mut word = Word::of(text, from..from + inner.trim().len());
            word.moved(start);
            word
        };
        vec![word(0..dots), word(dots + 2..text.len())]
    }
}

impl EventCall {
    /// Reads an event. Places are bytes of the text.
    ///
    /// # Errors
    /// The first word that has not the form of an event.
    pub fn read(text: &str) -> Result<EventCall, LineFault> {
        let mut words = words(text).into_iter().peekable();
        let end = text.trim_end().len();
        let Some(name) = words.next() else {
            return Err(LineFault::new(end..end, "found the end of the line, expected an event"));
        };
        let mut call = EventCall { name: Word::of(text, name), arguments: Vec::new(), to: None };
        while let Some(bytes) = words.next() {
            let word = &text[bytes.clone()];
            if word == TO {
                let Some(component) = words.next() else {
                    let message = "found the end of the line, expected the component after `to`";
                    return Err(LineFault::new(end..end, message));
                };
                call.to = Some(Word::of(text, component));
                if let Some(more) = words.next() {
                    let found = &text[more.clone()];
                    let message = format!("found `{found}`, expected the end of the line after the component");
                    let fault = LineFault::new(more, message);
                    return Err(fault.help("write the fields before `to`, and another event on a line of its own"));
                }
                break;
            }
            call.arguments.push(argument(text, bytes, words.peek())?);
        }
        for (place, one) in call.arguments.iter().enumerate() {
            if call.arguments[..place].iter().any(|other| other.name.text == one.name.text) {
                let message = format!("found the field `{}` twice", one.name.text);
                return Err(LineFault::new(one.name.bytes.clone(), message).help("keep one of them"));
            }
        }
        Ok(call)
    }

    /// The same event, in a text that starts so many bytes before the one that was read.
    #[must_use]
    pub fn moved(mut self, by: usize) -> EventCall {
        let fields = self.arguments.iter_mut().flat_map(|one| [&mut one.name, &mut one.value]);
        std::iter::once(&mut self.name).chain(fields).chain(&mut self.to).for_each(|word| word.moved(by));
        self
    }

    /// The bytes from its name to its last word.
    pub fn bytes(&self) -> Range<usize> {
        let last = self.arguments.last().map_or(&self.name, |one| &one.value);
        self.name.bytes.start..self.to.as_ref().unwrap_or(last).bytes.end
    }
}

/// The field that a word is.
fn argument(text: &str, bytes: Range<usize>, next: Option<&Range<usize>>) -> Result<Argument, LineFault> {
    let word = &text[bytes.clone()];
    let sign = word.find('=').filter(|sign| *sign > 0 && is_name(&word[..*sign]));
    let Some(sign) = sign else {
        let message = format!("found `{word}`, expected a field such as `size=2`, or `to` and a component");
        let is_parted = word.starts_with('=') || next.is_some_and(|next| text[next.clone()].starts_with('='));
        let fault = LineFault::new(bytes, message);
        return Err(if is_parted { fault.help("write the field, `=` and its value without blanks") } else { fault });
    };
    let (name, value) = (bytes.start..bytes.start + sign, bytes.start + sign + 1..bytes.end);
    if value.is_empty() {
        let message = format!("found no value of the field `{}`", &text[name.clone()]);
        return Err(LineFault::new(bytes, message).help("write the field, `=` and its value without blanks"));
    }
    Ok(Argument { name: Word::of(text, name), value: Word::of(text, value) })
}

fn is_name(text: &str) -> bool {
    text.chars().all(|letter| letter.is_alphanumeric() || letter == '_')
}

/// The words of a line. Brackets and quotes keep blanks together, and so does `..` between two values.
fn words(text: &str) -> Vec<Range<usize>> {
    let mut words: Vec<Range<usize>> = Vec::new();
    let (mut start, mut depth, mut is_quoted) = (None, 0_u32, false);
    for (at, sign) in text.char_indices() {
        match sign {
            '"' => is_quoted = !is_quoted,
            '(' | '[' if !is_quoted => depth += 1,
            ')' | ']' if !is_quoted => depth = depth.saturating_sub(1),
            _ => {}
        }
        let is_blank = sign.is_whitespace() && depth == 0 && !is_quoted;
        match (start, is_blank) {
            (None, false) => start = Some(at),
            (Some(first), true) => {
                words.push(first..at);
                start = None;
            }
            _ => {}
        }
    }
    words.extend(start.map(|first| first..text.trim_end().len()));
    joined(text, words)
}

/// Joins what stands around `..`.
fn joined(text: &str, words: Vec<Range<usize>>) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    for word in words {
        let goes_on = text[word.clone()].starts_with("..");
        match all.last_mut() {
            Some(last) if goes_on || text[last.clone()].ends_with("..") => last.end = word.end,
            _ => all.push(word),
        }
    }
    all
}

/// The place of `..` outside of brackets and quotes.
fn range_dots(text: &str) -> Option<usize> {
    let (mut depth, mut is_quoted) = (0_u32, false);
    for (at, sign) in text.char_indices() {
        match sign {
            '"' => is_quoted = !is_quoted,
            '(' | '[' if !is_quoted => depth += 1,
            ')' | ']' if !is_quoted => depth = depth.saturating_sub(1),
            '.' if depth == 0 && !is_quoted && text[at..].starts_with("..") => return Some(at),
            _ => {}
        }
    }
    None
}
