//! Reading on behind what is not well-formed: common slips are mended in a copy of the text, and what is found there is told where it is in the
//! text itself, so that all of them are told at once.

use std::sync::Arc;

use super::parse::{Parsed, parse};
use crate::diagnostic::{Diagnostic, Edit, Suggestion, codes, nearest};
use crate::source::{FileId, Location, Span};

/// Slips of a file that are mended: behind more, nobody reads on.
const MOST: usize = 20;
/// Bytes that are read for this: a large file is not read so often, and its copies take memory.
const MOST_BYTES: usize = 2 << 20;
/// What stands for the namespace of a prefix that is bound to none.
const NO_NAMESPACE: &str = "urn:bound-to-nothing";

/// A text with faults, read as far as it can be.
#[derive(Debug)]
pub(crate) struct Mended {
    /// What the mended text is; its places are those of that text.
    pub(crate) parsed: Parsed,
    /// What was mended, told of the text itself.
    pub(crate) faults: Vec<Diagnostic>,
    text: Arc<String>,
    places: Places,
}

/// Reads on behind the fault of what was read.
pub(crate) fn mend(file: FileId, text: &Arc<String>, mut parsed: Parsed) -> Mended {
    let mut places = Places { file, text: Arc::clone(text), edits: Vec::new(), unbound: Vec::new() };
    let mut faults: Vec<Diagnostic> = Vec::new();
    let mut mended = Arc::clone(text);
    for _ in 0..MOST.min(MOST_BYTES / text.len().max(1)) {
        if parsed.tangle.is_some() {
            break;
        }
        let Some(edits) = parsed.fault.as_ref().and_then(|fault| slip(fault, &mended, &mut places.unbound))
        else {
            break;
        };
        let Some(more) = places.with(&edits) else { break };
        faults.extend(parsed.fault.take().map(|fault| places.of(fault)));
        places.edits = more;
        mended = Arc::new(places.applied());
        // One tree at a time.
        parsed.document = None;
        parsed = parse(file, &mended);
    }
    Mended { parsed, faults, text: mended, places }
}

impl Mended {
    /// What is found in the mended text, told of the text itself; `None` where it is only about what was mended.
    pub(crate) fn told(&self, one: Diagnostic) -> Option<Diagnostic> {
        let Places { file, unbound, .. } = &self.places;
        let Span { start, end } = one.location.span;
        let is_unbound = |prefix: &String| {
            let named = self.text.get(start as usize..end as usize);
            named
                .and_then(|name| name.strip_prefix(prefix.as_str()))
                .is_some_and(|rest| rest.starts_with(':'))
        };
        let is_about_mends = one.location.file == *file
            && (self.places.is_made(one.location.span)
                || unbound.iter().any(is_unbound)
                || one.message.contains(NO_NAMESPACE));
        (!is_about_mends).then(|| self.places.of(one))
    }
}

/// What is written in place of what, in order.
#[derive(Debug)]
struct Places {
    file: FileId,
    text: Arc<String>,
    edits: Vec<Made>,
    /// The prefixes that are bound to nothing.
    unbound: Vec<String>,
}

#[derive(Clone, Debug)]
struct Made {
    /// In the text itself.
    from: Span,
    replacement: String,
    /// Whether it says what nobody wrote.
    is_invented: bool,
}

impl Places {
    /// The mended text.
    fn applied(&self) -> String {
        let text = &self.text;
        let (mut mended, mut at) = (String::with_capacity(text.len() + 64), 0);
        for Made { from, replacement, .. } in &self.edits {
            mended.push_str(&text[at..from.start as usize]);
            mended.push_str(replacement);
            at = from.end as usize;
        }
        mended.push_str(&text[at..]);
        mended
    }

    /// What was written, each with where it is in the mended text.
    fn made(&self) -> impl Iterator<Item = (&Made, Span)> {
        let mut longer = 0;
        self.edits.iter().map(move |made| {
            let start = (i64::from(made.from.start) + longer) as u32;
            longer += made.replacement.len() as i64 - i64::from(made.from.end - made.from.start);
            (made, Span::new(start, start + made.replacement.len() as u32))
        })
    }

    /// Where a byte of the mended text is in the text itself: of what was written, where that starts or ends.
    fn place(&self, at: u32, is_end: bool) -> u32 {
        let mut longer = 0;
        for (made, new) in self.made() {
            if at < new.start || at == new.start && (is_end || new.start < new.end) {
                break;
            }
            if at < new.end || at == new.end && is_end {
                return if is_end { made.from.end } else { made.from.start };
            }
            longer = i64::from(new.end) - i64::from(made.from.end);
        }
        (i64::from(at) - longer) as u32
    }

    fn span(&self, span: Span) -> Span {
        let start = self.place(span.start, false);
        Span::new(start, self.place(span.end, true).max(start))
    }

    fn location(&self, at: Location) -> Location {
        if at.file == self.file { self.span(at.span).in_file(at.file) } else { at }
    }

    /// Whether a place of the mended text touches what was mended.
    fn touches(&self, span: Span) -> bool {
        self.made().any(|(_, new)| span.start < new.end && new.start < span.end || span == new)
    }

    /// Whether a place of the mended text is what nobody wrote.
    fn is_made(&self, span: Span) -> bool {
        self.made().any(|(made, new)| made.is_invented && span.start <= new.end && new.start <= span.end)
    }

    /// A diagnostic about the mended text, as one of the text itself.
    fn of(&self, mut one: Diagnostic) -> Diagnostic {
        one.suggestions.retain_mut(|suggestion| self.stays(suggestion));
        one.location = self.location(one.location);
        one.labels.iter_mut().for_each(|label| label.location = self.location(label.location));
        let edits = one.suggestions.iter_mut().flat_map(|suggestion| &mut suggestion.edits);
        edits.for_each(|edit| edit.location = self.location(edit.location));
        one
    }

    /// Whether a suggestion is one for the text itself, apart from what is written there already: a way to mend what was mended is not known.
    fn stays(&self, suggestion: &mut Suggestion) -> bool {
        suggestion.edits.retain(|edit| {
            let Span { start, end } = self.location(edit.location).span;
            let written = self.text.get(start as usize..end as usize);
            let is_mended = edit.location.file == self.file && self.touches(edit.location.span);
            !(is_mended && written == Some(edit.replacement.as_str()))
        });
        let mut edits = suggestion.edits.iter().filter(|edit| edit.location.file == self.file);
        !edits.any(|edit| self.touches(edit.location.span))
    }

    /// With more, which are places of the mended text; `None` where they touch what was mended.
    fn with(&self, more: &[Made]) -> Option<Vec<Made>> {
        let mut all = self.edits.clone();
        for one in more {
            if self.touches(one.from) {
                return None;
            }
            all.push(Made { from: self.span(one.from), ..one.clone() });
        }
        all.sort_by_key(|made| (made.from.start, made.from.end));
        let is_apart = |pair: &[Made]| pair[0].from.end <= pair[1].from.start;
        all.windows(2).all(is_apart).then_some(all)
    }
}

/// How a fault is mended so that nothing false is found behind it; `None` where nobody can know what is meant.
fn slip(fault: &Diagnostic, text: &str, unbound: &mut Vec<String>) -> Option<Vec<Made>> {
    let span = fault.location.span;
    let found = text.get(span.start as usize..span.end as usize)?;
    let suggested = || match &fault.suggestions[..] {
        [only] => Some(only.edits.iter().map(of_edit).collect::<Vec<Made>>()),
        _ => None,
    };
    let one = |from, replacement: &str| {
        Some(vec![Made { from, replacement: replacement.to_owned(), is_invented: true }])
    };
    let code = fault.code;
    if code == &codes::XML_PREFIX {
        return prefix(fault, found, text, unbound);
    }
    if code == &codes::XML_TAG_MISMATCH {
        let made = suggested()?;
        let [Made { replacement, .. }] = &made[..] else { return None };
        let name = |tag| str::strip_suffix(str::strip_prefix(tag, "</")?, ">");
        let (found, expected) = (name(found)?.trim_end(), name(replacement)?);
        let place = Span::new(span.start + 2, span.start + 2 + found.len() as u32);
        // Another name is perhaps that of an element around it.
        let is_near = nearest(found, [expected]).is_some();
        return is_near
            .then(|| vec![Made { from: place, replacement: expected.to_owned(), is_invented: false }]);
    }
    if code == &codes::XML_ENTITY {
        return suggested().or_else(|| one(span, "_"));
    }
    if code == &codes::XML_ATTRIBUTE {
        let Some(made) = suggested() else {
            // It is a name, without a value.
            return if is_attribute_name(found) { one(Span::empty(span.end), "=\"\"") } else { None };
        };
        return attribute(found, span, made, text);
    }
    if code == &codes::XML_SYNTAX {
        return suggested().or_else(|| if found == "&" { one(span, " ") } else { None });
    }
    if code == &codes::XML_NAME {
        // Behind a `<` with a blank there is an element as a rule.
        return suggested().filter(|made| made.iter().all(|one| one.replacement != "&lt;"));
    }
    if code == &codes::XML_DUPLICATE_ATTRIBUTE { suggested() } else { None }
}

/// How an attribute is mended, where no other reading of it is likely.
fn attribute(found: &str, span: Span, mut made: Vec<Made>, text: &str) -> Option<Vec<Made>> {
    let first = made.first_mut()?;
    let behind = &text[first.from.end as usize..];
    match first.replacement.as_str() {
        // A name without `=` may be something else in place of the `=` of a shorter one.
        "=" if span.end == first.from.start && !behind.is_empty() => {
            first.is_invented = first.from.start == first.from.end;
            is_quoted(behind).then_some(made)
        }
        // Behind a value that ended too early there is the rest of it.
        " " => {
            let name = behind.find(|c| !is_name_character(c)).filter(|length| *length > 0)?;
            let value = behind[name..].trim_start().strip_prefix('=')?.trim_start();
            is_quoted(value).then_some(made)
        }
        // A word without quotes may be the start of more.
        word if *word == *format!("\"{found}\"") => {
            let is_whole = behind.starts_with([' ', '\t', '\r', '\n', '>']) || behind.starts_with("/>");
            is_whole.then_some(made)
        }
        _ => Some(made),
    }
}

/// Whether a text starts with a value in quotes.
fn is_quoted(text: &str) -> bool {
    let Some(quote) = text.chars().next().filter(|c| matches!(c, '"' | '\'')) else { return false };
    let end = text[1..].find([quote, '<', '>', '\n']);
    end.is_some_and(|end| text[1 + end..].starts_with(quote))
}

fn is_attribute_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(is_name_character)
}

fn is_name_character(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | ':')
}

fn of_edit(edit: &Edit) -> Made {
    Made { from: edit.location.span, replacement: edit.replacement.clone(), is_invented: false }
}

/// A prefix is declared in the root element: as the one that is meant, where one is, so that it is told once.
fn prefix(fault: &Diagnostic, found: &str, text: &str, unbound: &mut Vec<String>) -> Option<Vec<Made>> {
    let edit = match &fault.suggestions[..] {
        [only] => only.edits.first(),
        _ => None,
    };
    if let Some(edit) = edit.filter(|edit| edit.replacement.starts_with(" xmlns:")) {
        return Some(vec![of_edit(edit)]);
    }
    if found.is_empty() || found.contains(['=', '"', ':']) {
        return None;
    }
    let bound = edit.and_then(|edit| declared(text, &edit.replacement));
    let uri = bound.unwrap_or_else(|| {
        unbound.push(found.to_owned());
        NO_NAMESPACE
    });
    let root = root_name_end(text)?;
    let replacement = format!(" xmlns:{found}=\"{uri}\"");
    Some(vec![Made { from: Span::empty(root), replacement, is_invented: false }])
}

/// What a prefix is bound to, as it is written.
fn declared<'t>(text: &'t str, prefix: &str) -> Option<&'t str> {
    let start = text.find(&format!("xmlns:{prefix}=\""))? + prefix.len() + 8;
    text[start..].split('"').next()
}

/// Where the name of the root element ends.
fn root_name_end(text: &str) -> Option<u32> {
    let mut at = 0;
    loop {
        at += text[at..].find('<')?;
        let rest = &text[at..];
        let end = match rest.as_bytes().get(1)? {
            b'?' => rest.find("?>")? + 2,
            b'!' => rest.find("-->")? + 3,
            _ => {
                let length = rest.find([' ', '\t', '\r', '\n', '>', '/'])?;
                return Some((at + length) as u32);
            }
        };
        at += end;
    }
}
