//! Paths of a `source`: `$name`, and the part of its value that steps lead to.
//!
//! SCA takes an XPath (Assembly 1.1, 4.1.3). A path is the part of it that fleets use: steps down into elements by name
//! or `*`, each with one predicate, steps to any depth (`//`), and at the end an attribute or a text. Where a step
//! leads to several elements, the next one starts from all of them, as in XPath. Prefixes do not count. Everything else
//! of XPath is an error.

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

use super::raw::{Piece, Raw};
use super::type_name::local;
use crate::check::report::list;
use crate::check::values::replica::Instance;
use crate::diagnostic::{nearest, quoted};
use crate::limits::{LISTED_PARTS, PATH_ELEMENTS, SEARCHED_PARTS};
use crate::syntax::{Attribute, Element};

/// The fault of a step of another form.
const NO_STEP: &str = "this is not a step of a path";

/// The place of an element among its siblings.
pub(crate) const POSITION: &str = "position()";

/// The forms of steps, for help.
pub(crate) const FORMS: &str = "write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or \
    `name[@attribute='value']`, and at the end `@attribute` or `text()`";

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum PathFaultKind {
    /// The path is unresolved.
    Wrong,
    /// It is an XPath that is no path: another program may understand it.
    Unknown,
    /// The paths of the fleet look at too many elements.
    TooMany,
}

/// A fault of a path.
pub(crate) struct PathFault {
    /// Its bytes.
    pub(crate) step: Range<usize>,
    pub(crate) message: String,
    pub(crate) kind: PathFaultKind,
    /// A name in the step, and the one that is probably meant by it.
    pub(crate) instead: Option<(String, String)>,
}

impl PathFault {
    pub(crate) fn new(step: Range<usize>, message: impl Into<String>) -> Self {
        Self { step, message: message.into(), kind: PathFaultKind::Wrong, instead: None }
    }

    /// The fault of what another program may understand.
    pub(crate) fn unknown(step: Range<usize>, message: impl Into<String>) -> Self {
        Self { kind: PathFaultKind::Unknown, ..Self::new(step, message) }
    }

    /// The fault of a step where paths have looked at too many elements.
    pub(crate) fn too_many(step: Range<usize>) -> Self {
        let message = format!("the paths of sources visit more than {PATH_ELEMENTS} elements");
        Self { kind: PathFaultKind::TooMany, ..Self::new(step, message) }
    }

    /// With the name among those that there are which is nearly this one.
    pub(crate) fn near<'n>(mut self, name: &str, known: impl IntoIterator<Item = &'n str>) -> Self {
        self.instead = nearest(name, known).map(|meant| (name.to_owned(), meant.to_owned()));
        self
    }
}

/// `$name`, `$name[2]`, `$name/path` or `$name[2]/path`: the name, and what follows it.
pub(crate) fn expression(source: &str) -> Option<(&str, Option<&str>)> {
    let rest = source.strip_prefix('$')?;
    let end = rest.find(['/', '[']).unwrap_or(rest.len());
    let (name, path) = rest.split_at(end);
    (!name.is_empty()).then_some((name, (!path.is_empty()).then_some(path)))
}

/// The place of the value that `[2]` behind the name means, of so many; `None` where the path starts from all of them.
pub(crate) fn one_of(count: usize, path: &str) -> Result<Option<usize>, PathFault> {
    let Some((at, step)) = steps(path).next().filter(|(_, step)| !step.is_empty()) else { return Ok(None) };
    let Some(Predicate::Position(wanted)) = predicate(step) else {
        return Err(PathFault::unknown(at, NO_STEP));
    };
    match wanted.of(count) {
        Some(place) => Ok(Some(place)),
        None => Err(PathFault::new(at, format!("the property has {}", counted(count, "value")))),
    }
}

/// The values of a step that leads to no element, such as `@name` or `text()`.
pub(crate) fn ends<'a>(
    around: &[Element<'a>],
    (at, step): (Range<usize>, &str),
    is_last: bool,
    instance: Option<&'a Instance>,
) -> Option<Result<Raw<'a>, PathFault>> {
    let name = step.strip_prefix('@').filter(|name| is_name(name));
    if name.is_some() || step == "text()" {
        let value = |one: Element<'a>| match name {
            Some(name) => Some(attribute(one, name)?.trimmed()),
            None => one.trimmed_text(),
        };
        let found = around.iter().filter_map(|one| value(*one)).map(|text| Piece::text(text, instance));
        let found: Vec<Piece<'a>> = found.collect();
        return Some(match name {
            _ if is_last && !found.is_empty() => Ok(Raw(found)),
            Some(name) if is_last => Err(no_attribute(at, name, around)),
            Some(_) => Err(PathFault::new(at, "an attribute has no parts")),
            None if is_last => Err(PathFault::new(at, "there is no text here")),
            None => Err(PathFault::new(at, "a text has no parts")),
        });
    }
    let is_missing = step.is_empty();
    let step = at.start.saturating_sub(1)..at.end;
    is_missing.then(|| Err(PathFault::new(step, format!("a step is missing: {FORMS}"))))
}

/// The fault of a step that is of no form that is understood here.
pub(crate) fn no_step(step: &str, at: Range<usize>) -> PathFault {
    if step.matches('[').count() > step.matches(']').count() {
        return PathFault::unknown(at, "a `]` is missing at the end of this step");
    }
    PathFault::unknown(at, NO_STEP)
}

/// The steps of what follows the name with their bytes, between each `/` that is not within quotation marks.
pub(crate) fn steps(path: &str) -> impl Iterator<Item = (Range<usize>, &str)> {
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

/// The test of a step: the elements that it leads to.
pub(crate) struct Test<'p> {
    /// Their name; any without.
    pub(crate) name: Option<&'p str>,
    pub(crate) predicate: Option<Predicate<'p>>,
}

pub(crate) enum Predicate<'p> {
    Position(Position),
    /// An attribute such as `@id`, or an element inside, has this value.
    Value {
        of: &'p str,
        value: &'p str,
    },
}

impl<'p> Predicate<'p> {
    /// The value that it asks for, and what has to have it.
    pub(crate) fn asked(&self) -> Option<(&'p str, Cow<'p, str>)> {
        match *self {
            Self::Value { of, value } => Some((of, value.into())),
            Self::Position(Position::Number(number)) => Some((POSITION, number.to_string().into())),
            Self::Position(Position::Last) => None,
        }
    }
}

#[derive(Clone, Copy)]
pub(crate) enum Position {
    /// From one on.
    Number(usize),
    Last,
}

impl Position {
    /// Its index among so many.
    pub(crate) fn of(self, count: usize) -> Option<usize> {
        let place = match self {
            Self::Number(number) => number.checked_sub(1),
            Self::Last => count.checked_sub(1),
        };
        place.filter(|place| *place < count)
    }
}

impl<'p> Test<'p> {
    pub(crate) fn of(step: &'p str) -> Option<Self> {
        let step = step.strip_prefix("child::").unwrap_or(step);
        // As some tools write a name without a prefix.
        let by_predicate = step.strip_prefix("*[local-name()='").and_then(|rest| rest.split_once("']"));
        let (name, rest) = match by_predicate {
            Some((name, rest)) => (name, rest),
            None => step.split_at(step.find('[').unwrap_or(step.len())),
        };
        // Other axes are no names.
        if name.contains("::") {
            return None;
        }
        let predicate = if rest.is_empty() { None } else { Some(predicate(rest)?) };
        let name = if name == "*" { None } else { Some(local(name)).filter(|name| is_name(name)).map(Some)? };
        Some(Self { name, predicate })
    }

    /// True if an element has the name that the step asks for.
    pub(crate) fn is_of_name(&self, one: Element<'_>) -> bool {
        self.name.is_none_or(|name| one.local_name() == name)
    }

    /// The reason why the step at these bytes leads to none of these elements, some of which have its name.
    pub(crate) fn fault(&self, at: Range<usize>, all: &[Element<'_>], named: &[Element<'_>]) -> PathFault {
        if named.is_empty() {
            let known = different(all.iter().map(|one| one.local_name()));
            let asked = self.name.map_or(String::new(), |name| format!(" {}", quoted(name)));
            let message = match known.is_empty() {
                true => format!("there is no part{asked}: there are no parts here"),
                false => format!("there is no part{asked}; the parts are {}", list(known.iter().copied())),
            };
            let message = message + self.of_values();
            return PathFault::new(at, message).near(self.name.unwrap_or_default(), known);
        }
        let Some(Predicate::Value { of, value }) = self.predicate else {
            let fault = PathFault::new(at, self.no_place(named));
            return match self.predicate {
                Some(Predicate::Position(Position::Number(0))) => {
                    PathFault { instead: Some(("[0]".to_owned(), "[1]".to_owned())), ..fault }
                }
                _ => fault,
            };
        };
        let Some(name) = of.strip_prefix('@') else {
            return PathFault::new(
                at,
                format!("no part here contains a part {} with the value {}", quoted(of), quoted(value)),
            );
        };
        let values = named.iter().take(SEARCHED_PARTS).filter_map(|one| attribute(*one, name)).take(LISTED_PARTS);
        let values: Vec<_> = values.map(|one| one.value()).collect();
        let known = match values.is_empty() {
            true => "no part has this attribute".to_owned(),
            false => format!("its values are {}", list(values.iter().map(|value| &**value))),
        };
        let message =
            format!("no part here has the attribute {} with the value {}: {known}", quoted(name), quoted(value));
        PathFault::new(at, message).near(value, values.iter().map(|value| &**value))
    }

    /// The message for a path into `<value>` elements: a variable is the values, not the elements around them.
    pub(crate) fn of_values(&self) -> &'static str {
        if self.name == Some("value") { "; to get the second value of a property, write `$name[2]`" } else { "" }
    }

    /// The reason why none of these elements is at a position: positions count within each parent.
    fn no_place(&self, named: &[Element<'_>]) -> String {
        let parent = |one: &Element<'_>| one.parent().map(Element::id);
        let groups: Vec<usize> =
            named.chunk_by(|one, other| parent(one) == parent(other)).map(<[Element<'_>]>::len).collect();
        let counted = is_counted(named.len(), self.name);
        match groups[..] {
            [_] | [] => format!(
                "there {counted}, counted from `[1]`: the last one is {}",
                quoted(&format!("{}[{}]", self.name.unwrap_or("*"), named.len()))
            ),
            _ => {
                let (most, count) = (groups.iter().max().copied().unwrap_or_default(), groups.len());
                format!(
                    "there {counted} in {count} elements, at most {most} per element, and `[...]` counts within each \
                    element"
                )
            }
        }
    }
}

/// `[2]`, `[last()]`, `[@name='value']` or `[part='value']`; the values can be numbers.
fn predicate(text: &str) -> Option<Predicate<'_>> {
    let inside = text.strip_prefix('[')?.strip_suffix(']')?.trim();
    let place = |text: &str| {
        if text == "last()" {
            return Some(Predicate::Position(Position::Last));
        }
        let is_number = !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit());
        // A number that is too large is one that nothing has.
        is_number.then(|| Predicate::Position(Position::Number(text.parse().unwrap_or(usize::MAX))))
    };
    let Some((name, value)) = inside.split_once('=') else { return place(inside) };
    let (name, value) = (name.trim(), value.trim());
    if name == POSITION {
        return place(value);
    }
    let value = match value.chars().next().filter(|open| matches!(open, '\'' | '"')) {
        Some(open) => value[1..].strip_suffix(open).filter(|value| !value.contains(open))?,
        None => Some(value).filter(|value| value.parse::<f64>().is_ok())?,
    };
    let of = if name.starts_with('@') { name } else { local(name) };
    is_name(name.strip_prefix('@').unwrap_or(name)).then_some(Predicate::Value { of, value })
}

pub(crate) fn attribute<'a>(element: Element<'a>, name: &str) -> Option<Attribute<'a>> {
    element.attributes().find(|one| one.local_name() == local(name))
}

/// The different names among some.
fn different<'n>(names: impl Iterator<Item = &'n str>) -> Vec<&'n str> {
    let mut seen = HashSet::new();
    names.take(SEARCHED_PARTS).filter(|name| seen.insert(*name)).take(LISTED_PARTS).collect()
}

fn no_attribute(at: Range<usize>, name: &str, around: &[Element<'_>]) -> PathFault {
    let known = different(around.iter().flat_map(|one| one.attributes()).map(Attribute::local_name));
    let said = match known.is_empty() {
        true => "there are no attributes here".to_owned(),
        false => format!("the attributes are {}", list(known.iter().copied())),
    };
    PathFault::new(at, format!("there is no attribute {}; {said}", quoted(name))).near(local(name), known)
}

/// True if it can be the name of an element or an attribute, as far as that tells it from other steps.
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
