//! Where the `source` of a property leads: `$name`, and the part of its value that a path of steps leads to.
//!
//! SCA takes an XPath (Assembly 1.1, 4.1.3). Understood are steps down into elements by name or `*`, each with one predicate, and at the end an attribute or a
//! text; what steps lead to several elements, leads on from all of them, as in XPath. Prefixes do not count. The work grows with the value and the
//! length of the path alone: each step goes one level down.

use std::ops::Range;

use super::raw::{Piece, Raw};
use super::report::list;
use crate::diagnostic::quoted;
use crate::xml::{Attribute, Element};

/// What is understood, for those who wrote something else.
const FORMS: &str = "steps are `name` or `*`, `name[2]`, `name[last()]` or `name[@attribute='value']`, and at the end `@attribute` or `text()`";

/// A fault of a path: its bytes, and what is wrong.
type Fault = (Range<usize>, String);

/// `$name`, `$name[2]`, `$name/path` or `$name[2]/path`: the name, and what follows it.
pub(super) fn expression(source: &str) -> Option<(&str, Option<&str>)> {
    let rest = source.strip_prefix('$')?;
    let end = rest.find(['/', '[']).unwrap_or(rest.len());
    let (name, path) = rest.split_at(end);
    (!name.is_empty()).then_some((name, (!path.is_empty()).then_some(path)))
}

/// The parts of a value that what follows the name leads to.
pub(super) fn walk<'a>(mut whole: Raw<'a>, path: &str) -> Result<Raw<'a>, Fault> {
    let mut steps = steps(path).peekable();
    if let Some((at, step)) = steps.next().filter(|(_, step)| !step.is_empty()) {
        // What stands directly behind the name is about its values.
        let Some(Predicate::Place(wanted)) = predicate(step) else {
            return Err((
                at,
                format!("{} is not understood: behind the name stands `[2]` or `/`", quoted(step)),
            ));
        };
        let count = whole.0.len();
        let Some(place) = wanted.of(count) else {
            return Err((at, format!("the property has {}", counted(count, "value"))));
        };
        whole = Raw(vec![whole.0.swap_remove(place)]);
    }
    if steps.peek().is_none() {
        return Ok(whole);
    }
    let mut instance = None;
    let (mut around, mut here): (Vec<Element<'a>>, Vec<Element<'a>>) = (Vec::new(), Vec::new());
    let first = steps.peek().map_or("", |(_, step)| *step);
    for piece in whole.0 {
        let (elements, of) = match piece {
            Piece::Elements(elements, of) => (elements, of),
            Piece::Whole(_, root, of) => (vec![root], of),
            Piece::Text(_) => continue,
        };
        instance = of;
        // `$order/total` also means the `total` of a value that is written as one element.
        match elements[..] {
            [only] if is_within(only, first) => {
                around.push(only);
                here.extend(only.children());
            }
            _ => here.extend(elements),
        }
    }
    if here.is_empty() && around.is_empty() {
        return Err((0..path.len(), "the property has a simple value: there are no parts in it".to_owned()));
    }
    while let Some((at, step)) = steps.next() {
        let is_last = steps.peek().is_none();
        if let Some(name) = step.strip_prefix('@').filter(|name| is_name(name)) {
            return match is_last {
                false => Err((at, "an attribute has no parts".to_owned())),
                true => attributes(&around, name, instance).ok_or_else(|| no_attribute(at, name, &around)),
            };
        }
        if step == "text()" {
            return match is_last {
                false => Err((at, "a text has no parts".to_owned())),
                true => texts(&around, instance).ok_or_else(|| (at, "there is no text here".to_owned())),
            };
        }
        if step.is_empty() {
            return Err((at.start.saturating_sub(1)..at.end, format!("a step is missing: {FORMS}")));
        }
        let Some(test) = Test::of(step) else {
            return Err((at, format!("{} is not understood: {FORMS}", quoted(step))));
        };
        let found = test.of_all(&here).map_err(|message| (at.clone(), message))?;
        if is_last {
            return Ok(Raw::of_elements(&found, instance));
        }
        here = found.iter().flat_map(|one| one.children()).collect();
        around = found;
    }
    Err((0..path.len(), "the path is empty".to_owned()))
}

/// The steps of what follows the name with their bytes, the first of which stands before the first `/`. One within quotation marks is none.
fn steps(path: &str) -> impl Iterator<Item = (Range<usize>, &str)> {
    let mut start = Some(0);
    std::iter::from_fn(move || {
        let from = start?;
        let mut quote = None;
        let end = path[from..].find(|letter: char| match quote {
            Some(open) => {
                if letter == open {
                    quote = None;
                }
                false
            }
            None => {
                quote = matches!(letter, '\'' | '"').then_some(letter);
                letter == '/'
            }
        });
        let end = end.map_or(path.len(), |length| from + length);
        start = (end < path.len()).then_some(end + 1);
        Some((from..end, &path[from..end]))
    })
}

/// Whether the first step is one inside the one element of a value rather than to it.
fn is_within(only: Element<'_>, step: &str) -> bool {
    match Test::of(step) {
        Some(Test { name: Some(name), .. }) => {
            only.local_name() != name && only.children().any(|child| child.local_name() == name)
        }
        Some(Test { name: None, .. }) => false,
        None => step.starts_with('@') || step == "text()",
    }
}

/// What a step asks of elements.
struct Test<'p> {
    /// Their name; any without.
    name: Option<&'p str>,
    predicate: Option<Predicate<'p>>,
}

enum Predicate<'p> {
    Place(Place),
    /// An attribute has this value.
    Attribute(&'p str, &'p str),
}

#[derive(Clone, Copy)]
enum Place {
    /// From one on.
    Number(usize),
    Last,
}

impl Place {
    /// Its index among so many.
    fn of(self, count: usize) -> Option<usize> {
        let place = match self {
            Self::Number(number) => number.checked_sub(1),
            Self::Last => count.checked_sub(1),
        };
        place.filter(|place| *place < count)
    }
}

impl<'p> Test<'p> {
    fn of(step: &'p str) -> Option<Self> {
        let step = step.strip_prefix("child::").unwrap_or(step);
        // As some tools write a name without a prefix.
        let by_predicate = step.strip_prefix("*[local-name()='").and_then(|rest| rest.split_once("']"));
        let (name, rest) = match by_predicate {
            Some((name, rest)) => (name, rest),
            None => step.split_at(step.find('[').unwrap_or(step.len())),
        };
        let predicate = if rest.is_empty() { None } else { Some(predicate(rest)?) };
        let name =
            if name == "*" { None } else { Some(local(name)).filter(|name| is_name(name)).map(Some)? };
        Some(Self { name, predicate })
    }

    fn of_all<'a>(&self, all: &[Element<'a>]) -> Result<Vec<Element<'a>>, String> {
        let is_named = |one: &Element<'_>| self.name.is_none_or(|name| one.local_name() == name);
        let named: Vec<Element<'a>> = all.iter().copied().filter(is_named).collect();
        if named.is_empty() {
            let mut known: Vec<&str> = Vec::new();
            for one in all.iter().map(|one| one.local_name()) {
                if known.len() < 50 && !known.contains(&one) {
                    known.push(one);
                }
            }
            let asked = self.name.map_or(String::new(), |name| format!(" {}", quoted(name)));
            return Err(match known.is_empty() {
                true => format!("there is no part{asked}: there are no parts here"),
                false => format!("there is no part{asked}; the parts are {}", list(known)),
            });
        }
        match &self.predicate {
            None => Ok(named),
            Some(Predicate::Place(wanted)) => {
                let found = within_parents(&named, *wanted);
                match found.is_empty() {
                    false => Ok(found),
                    true => Err(format!("there {}, from `[1]` on", is_counted(named.len(), self.name))),
                }
            }
            Some(Predicate::Attribute(name, value)) => {
                let has = |one: &Element<'_>| attribute(*one, name).is_some_and(|one| one.value() == *value);
                let found: Vec<Element<'a>> = named.iter().copied().filter(has).collect();
                if found.is_empty() {
                    let values = named.iter().filter_map(|one| attribute(*one, name)).take(50);
                    let values: Vec<_> = values.map(|one| one.value()).collect();
                    let known = match values.is_empty() {
                        true => "none has it".to_owned(),
                        false => format!("its values are {}", list(values.iter().map(|value| &**value))),
                    };
                    return Err(format!(
                        "no part here has {} as its {}: {known}",
                        quoted(value),
                        quoted(name)
                    ));
                }
                Ok(found)
            }
        }
    }
}

/// Those at a place among their siblings; siblings stand beside each other.
fn within_parents<'a>(all: &[Element<'a>], wanted: Place) -> Vec<Element<'a>> {
    let parent = |one: &Element<'a>| one.parent().map(Element::id);
    let siblings = all.chunk_by(|one, other| parent(one) == parent(other));
    siblings.filter_map(|these| Some(these[wanted.of(these.len())?])).collect()
}

/// `[2]`, `[last()]` or `[@name='value']`.
fn predicate(text: &str) -> Option<Predicate<'_>> {
    let inside = text.strip_prefix('[')?.strip_suffix(']')?.trim();
    if let Some(rest) = inside.strip_prefix('@') {
        let (name, value) = rest.split_once('=')?;
        let value = value.trim();
        let open = value.chars().next().filter(|open| matches!(open, '\'' | '"'))?;
        let value = value[1..].strip_suffix(open).filter(|value| !value.contains(open))?;
        return Some(Predicate::Attribute(name.trim(), value)).filter(|_| is_name(name.trim()));
    }
    if inside == "last()" {
        return Some(Predicate::Place(Place::Last));
    }
    let is_number = !inside.is_empty() && inside.bytes().all(|digit| digit.is_ascii_digit());
    // A number that is too large is one that nothing has.
    is_number.then(|| Predicate::Place(Place::Number(inside.parse().unwrap_or(usize::MAX))))
}

fn attributes<'a>(
    around: &[Element<'a>],
    name: &str,
    instance: Option<&'a super::instance::Instance>,
) -> Option<Raw<'a>> {
    let found = around.iter().filter_map(|one| attribute(*one, name));
    let found: Vec<Piece<'a>> = found.map(|one| Piece::text(one.trimmed(), instance)).collect();
    (!found.is_empty()).then_some(Raw(found))
}

fn texts<'a>(around: &[Element<'a>], instance: Option<&'a super::instance::Instance>) -> Option<Raw<'a>> {
    let found = around.iter().filter_map(|one| one.trimmed_text());
    let found: Vec<Piece<'a>> = found.map(|text| Piece::text(text, instance)).collect();
    (!found.is_empty()).then_some(Raw(found))
}

fn attribute<'a>(element: Element<'a>, name: &str) -> Option<Attribute<'a>> {
    element.attributes().find(|one| one.local_name() == local(name))
}

fn no_attribute(at: Range<usize>, name: &str, around: &[Element<'_>]) -> Fault {
    let mut known: Vec<&str> = Vec::new();
    for one in around.iter().flat_map(|one| one.attributes()).map(Attribute::local_name) {
        if known.len() < 50 && !known.contains(&one) {
            known.push(one);
        }
    }
    let known = match known.is_empty() {
        true => "there are none here".to_owned(),
        false => format!("the attributes are {}", list(known)),
    };
    (at, format!("there is no attribute {}; {known}", quoted(name)))
}

/// A name without its prefix.
fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// Whether it can be the name of an element or an attribute, as far as that tells it from other steps.
fn is_name(name: &str) -> bool {
    let is_other = |letter: char| letter.is_whitespace() || "[](){}*@'\"=<>|$,/!+".contains(letter);
    !name.is_empty() && !name.contains(is_other) && !name.contains("::") && !name.starts_with('.')
}

fn is_counted(count: usize, name: Option<&str>) -> String {
    let verb = if count == 1 { "is" } else { "are" };
    let name = name.map_or(String::new(), |name| format!(" {}", quoted(name)));
    format!("{verb} {}{name}", counted(count, "part"))
}

fn counted(count: usize, what: &str) -> String {
    match count {
        0 => format!("no {what}"),
        1 => format!("one {what}"),
        _ => format!("{count} {what}s"),
    }
}
