//! Files of ROS 2 interfaces: `.msg`, and `.srv`, which is two of them with a line `---` between.

use std::fmt;

use super::names::is_package;

/// Messages in lists and strings are no longer than this, as their bounds say.
const LONGEST: u64 = u32::MAX as u64;
/// The types of numbers, with what they are called here.
const NUMBERS: [(&str, &str); 12] = [
    ("int8", "i8"),
    ("uint8", "u8"),
    ("int16", "i16"),
    ("uint16", "u16"),
    ("int32", "i32"),
    ("uint32", "u32"),
    ("int64", "i64"),
    ("uint64", "u64"),
    ("float32", "f32"),
    ("float64", "f64"),
    ("byte", "u8"),
    ("char", "u8"),
];

/// A definition: a message, or the request or the answer of a service.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RosDefinition {
    /// The comment at its beginning.
    pub docs: Vec<String>,
    /// Its constants.
    pub constants: Vec<RosConstant>,
    /// Its fields.
    pub fields: Vec<RosField>,
}

/// A constant of a definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosConstant {
    /// Its comment.
    pub docs: Vec<String>,
    /// Its type in Rust.
    pub kind: &'static str,
    /// Its name.
    pub name: String,
    /// Its value in Rust.
    pub value: String,
}

/// A field of a definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosField {
    /// Its comment.
    pub docs: Vec<String>,
    /// Its name.
    pub name: String,
    /// What it is, or each element of its list.
    pub base: RosBase,
    /// What makes a list of it.
    pub list: RosList,
    /// The line and the column of its type.
    pub place: (usize, usize),
}

/// What a field is, or each element of its list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RosBase {
    /// A number or a truth, by the name of its type in Rust.
    Plain(&'static str),
    /// A text, of so many bytes at most.
    String(Option<u64>),
    /// A message, with its package if it is of another one.
    Message(Option<String>, String),
}

/// What makes a list of a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RosList {
    /// Nothing: it is one value.
    None,
    /// So many values.
    Length(u64),
    /// At most so many values.
    Most(u64),
    /// Values.
    Unbounded,
}

/// A fault of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosFault {
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
    /// What is wrong, and what is expected.
    pub message: String,
}

impl fmt::Display for RosFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}:{}: {}", self.line, self.column, self.message)
    }
}

/// Reads a file: the definition of a message, or those of the request and the answer of a service.
///
/// ```
/// use saoms_registry::ros::{RosBase, read_ros_file};
///
/// let lamp = read_ros_file("# A lamp.\nbool on  # or off\nstring<=8[] names\n", false).unwrap().remove(0);
/// assert_eq!((&*lamp.docs[0], &lamp.fields[1].base), ("A lamp.", &RosBase::String(Some(8))));
/// let faults = read_ros_file("bool On\nint3 x\n", false).unwrap_err();
/// assert_eq!(faults[1].to_string(), "2:1: there is no type `int3`");
/// ```
///
/// # Errors
/// All faults of the file.
pub fn read_ros_file(text: &str, is_service: bool) -> Result<Vec<RosDefinition>, Vec<RosFault>> {
    let mut reading = Reading { parts: vec![Part::default()], faults: Vec::new() };
    for (number, line) in text.lines().enumerate() {
        reading.line(number + 1, line, is_service);
    }
    if is_service && reading.parts.len() != 2 {
        let lines = text.lines().count().max(1);
        reading.fault((lines, 1), "a service has a line `---` between its request and its answer".to_owned());
    }
    match reading.faults.is_empty() {
        true => Ok(reading.parts.into_iter().map(|part| part.definition).collect()),
        false => Err(reading.faults),
    }
}

struct Reading {
    parts: Vec<Part>,
    faults: Vec<RosFault>,
}

#[derive(Default)]
struct Part {
    definition: RosDefinition,
    /// The comment so far, which may be about what comes next.
    docs: Vec<String>,
    /// True once something stands before an empty line: the comment there was about the whole.
    has_begun: bool,
}

impl Reading {
    fn fault(&mut self, (line, column): (usize, usize), message: String) {
        self.faults.push(RosFault { line, column, message });
    }

    fn part(&mut self) -> &mut Part {
        if self.parts.is_empty() {
            self.parts.push(Part::default());
        }
        let last = self.parts.len() - 1;
        &mut self.parts[last]
    }

    fn line(&mut self, number: usize, line: &str, is_service: bool) {
        if is_service && line.trim_end() == "---" {
            if self.parts.len() == 2 {
                return self
                    .fault((number, 1), "a service has one request and one answer: remove this `---`".to_owned());
            }
            return self.parts.push(Part::default());
        }
        let (code, comment) = split(line);
        let comment = comment.map(|comment| comment.trim().to_owned()).filter(|comment| !comment.is_empty());
        let part = self.part();
        if code.trim().is_empty() {
            match comment {
                Some(comment) => part.docs.push(comment),
                None => {
                    let docs = std::mem::take(&mut part.docs);
                    if !part.has_begun && part.definition.docs.is_empty() {
                        part.definition.docs = docs;
                    }
                }
            }
            return;
        }
        let mut docs = std::mem::take(&mut part.docs);
        if !part.has_begun && part.definition.docs.is_empty() && !docs.is_empty() && comment.is_some() {
            // What stands first is about the whole where the line has a comment of its own.
            part.definition.docs = std::mem::take(&mut docs);
        }
        part.has_begun = true;
        docs.extend(comment);
        self.code(number, code, docs);
    }

    /// Reads a constant or a field.
    fn code(&mut self, number: usize, code: &str, docs: Vec<String>) {
        let column = |at: usize| code.get(..at).unwrap_or(code).chars().count() + 1;
        let start = code.len() - code.trim_start().len();
        let rest = &code[start..];
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        let (kind, behind) = rest.split_at(end);
        let at = start + end + (behind.len() - behind.trim_start().len());
        let behind = behind.trim();
        let length = behind.find(|one: char| !(one.is_ascii_alphanumeric() || one == '_')).unwrap_or(behind.len());
        let (name, value) = behind.split_at(length);
        if name.is_empty() {
            return self.fault((number, column(at)), "there is no name behind the type".to_owned());
        }
        let value = value.trim();
        let place = (number, column(start));
        let (base, list) = match self.kind(kind, place) {
            Some(found) => found,
            None => return,
        };
        if let Some(value) = value.strip_prefix('=') {
            return self.constant((number, column(at)), name, (base, list, place), value.trim(), docs);
        }
        let is_name = name.starts_with(|first: char| first.is_ascii_lowercase())
            && !name.contains(|one: char| one.is_ascii_uppercase())
            && !name.contains("__")
            && !name.ends_with('_');
        if !is_name {
            let text = format!("`{name}` is no name of a field: small letters, digits and single `_`, a letter first");
            return self.fault((number, column(at)), text);
        }
        let part = self.part();
        if part.definition.fields.iter().any(|field| field.name == name) {
            return self.fault((number, column(at)), format!("there is another field `{name}`"));
        }
        let mut docs = docs;
        if !value.is_empty() {
            docs.push(format!("In ROS 2 the default is `{}`.", value.replace('`', "'")));
        }
        part.definition.fields.push(RosField { docs, name: name.to_owned(), base, list, place });
    }

    /// The type that a text names.
    fn kind(&mut self, text: &str, place: (usize, usize)) -> Option<(RosBase, RosList)> {
        let (base, list) = match text.find('[').filter(|_| text.ends_with(']')) {
            Some(at) => (&text[..at], Some(&text[at + 1..text.len() - 1])),
            None => (text, None),
        };
        let bound = |text: &str| text.parse::<u64>().ok().filter(|bound| (1..=LONGEST).contains(bound));
        let list = match list {
            None => Some(RosList::None),
            Some("") => Some(RosList::Unbounded),
            Some(list) => match list.strip_prefix("<=") {
                Some(most) => bound(most).map(RosList::Most),
                None => bound(list).map(RosList::Length),
            },
        };
        let Some(list) = list else {
            let text = format!("`{text}` is no list: write `[]`, `[3]` or `[<=3]`");
            self.fault(place, text);
            return None;
        };
        let base = match base {
            "bool" => RosBase::Plain("bool"),
            "string" => RosBase::String(None),
            "wstring" => {
                self.fault(place, "`wstring` is not supported: use `string`, which is in UTF-8".to_owned());
                return None;
            }
            _ if base.starts_with("string<=") => {
                let Some(most) = bound(&base["string<=".len()..]) else {
                    self.fault(place, format!("`{base}` has no bound of a text: write `string<=8`"));
                    return None;
                };
                RosBase::String(Some(most))
            }
            _ => match NUMBERS.iter().find(|(name, _)| *name == base) {
                Some((_, kind)) => RosBase::Plain(kind),
                None => self.message(base, place)?,
            },
        };
        Some((base, list))
    }

    /// The message that a text names.
    fn message(&mut self, text: &str, place: (usize, usize)) -> Option<RosBase> {
        let parts: Vec<&str> = text.split('/').collect();
        let (package, own) = match parts.as_slice() {
            [own] => (None, *own),
            [package, own] | [package, "msg", own] => (Some((*package).to_owned()), *own),
            _ => (None, ""),
        };
        let has_package = package.as_deref().is_none_or(is_package);
        let is_own = own.starts_with(|first: char| first.is_ascii_uppercase())
            && own.chars().all(|one| one.is_ascii_alphanumeric());
        if !has_package || !is_own {
            self.fault(place, format!("there is no type `{}`", text.escape_debug()));
            return None;
        }
        Some(RosBase::Message(package, own.to_owned()))
    }

    fn constant(
        &mut self,
        at: (usize, usize),
        name: &str,
        (base, list, place): (RosBase, RosList, (usize, usize)),
        value: &str,
        docs: Vec<String>,
    ) {
        let is_name = name.starts_with(|first: char| first.is_ascii_uppercase())
            && !name.contains(|one: char| one.is_ascii_lowercase());
        if !is_name {
            let text = format!("`{name}` is no name of a constant: capital letters, digits and `_`, a letter first");
            return self.fault(at, text);
        }
        if self.part().definition.constants.iter().any(|one| one.name == name) {
            return self.fault(at, format!("there is another constant `{name}`"));
        }
        let kind = match (&base, list) {
            (RosBase::Plain(kind), RosList::None) => kind,
            (RosBase::String(_), RosList::None) => "&str",
            _ => return self.fault(place, "a constant is a number, a truth or a text".to_owned()),
        };
        match constant(kind, value) {
            Some(value) => {
                self.part().definition.constants.push(RosConstant { docs, kind, name: name.to_owned(), value });
            }
            None => self.fault(at, format!("`{}` is no value of the type of `{name}`", value.escape_debug())),
        }
    }
}

/// What stands before a comment, and the comment; in a text between quotes there is none.
fn split(line: &str) -> (&str, Option<&str>) {
    let mut quote = None;
    for (at, one) in line.char_indices() {
        match (one, quote) {
            ('#', None) => return (&line[..at], Some(&line[at + 1..])),
            ('"' | '\'', None) => quote = Some(one),
            (one, Some(open)) if one == open => quote = None,
            _ => {}
        }
    }
    // A single quote, as in `it's`, begins no text.
    match (quote, line.find('#')) {
        (Some(_), Some(at)) => (&line[..at], Some(&line[at + 1..])),
        _ => (line, None),
    }
}

/// A value of a constant as Rust has it.
fn constant(kind: &str, value: &str) -> Option<String> {
    let whole = || {
        let (sign, digits) = value.strip_prefix('-').map_or((1, value), |digits| (-1, digits));
        let digits = digits.strip_prefix('+').unwrap_or(digits);
        let found = match digits.get(..2).map(str::to_ascii_lowercase).as_deref() {
            Some("0x") => i128::from_str_radix(&digits[2..], 16),
            Some("0o") => i128::from_str_radix(&digits[2..], 8),
            Some("0b") => i128::from_str_radix(&digits[2..], 2),
            _ => digits.parse(),
        };
        found.ok().and_then(|found| found.checked_mul(sign))
    };
    let within =
        |least: i128, most: i128| whole().filter(|found| (least..=most).contains(found)).map(|one| one.to_string());
    match kind {
        "bool" => match value {
            "true" | "True" | "1" => Some("true".to_owned()),
            "false" | "False" | "0" => Some("false".to_owned()),
            _ => None,
        },
        "&str" => {
            let quoted = |quote: char| value.strip_prefix(quote)?.strip_suffix(quote);
            let text = quoted('"').or_else(|| quoted('\'')).unwrap_or(value);
            Some(format!("\"{}\"", text.escape_default()))
        }
        "f32" | "f64" => {
            let found: f64 = value.parse().ok()?;
            found.is_finite().then(|| format!("{found:?}"))
        }
        "i8" => within(i8::MIN.into(), i8::MAX.into()),
        "u8" => within(0, u8::MAX.into()),
        "i16" => within(i16::MIN.into(), i16::MAX.into()),
        "u16" => within(0, u16::MAX.into()),
        "i32" => within(i32::MIN.into(), i32::MAX.into()),
        "u32" => within(0, u32::MAX.into()),
        "i64" => within(i64::MIN.into(), i64::MAX.into()),
        _ => within(0, u64::MAX.into()),
    }
}
