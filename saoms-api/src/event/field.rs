//! The fields of events: which texts are their values.

use std::cmp::Ordering;

use crate::host::declaration::{Bound, PropertyKind, Rule, Scalar};

/// A field of an event.
#[derive(Clone, Debug, PartialEq)]
pub struct EventField {
    /// Its name.
    pub name: String,
    /// Its type.
    pub of: FieldType,
    /// The name of the struct that its type is, or is made of; empty for others.
    pub message: String,
}

/// The type of a field, or of a part of one.
#[derive(Clone, Debug, PartialEq)]
pub enum FieldType {
    /// A single value.
    Scalar {
        /// Its type, as that of a property.
        kind: PropertyKind,
        /// The least and the greatest value of an integer.
        bounds: Option<(String, String)>,
        /// The names of the constants of an enumeration.
        allowed: Vec<String>,
        /// The most bytes of a text.
        most: Option<usize>,
    },
    /// A struct: the values of its fields in round brackets, as in `(3,4)`.
    Group(Vec<EventField>),
    /// A list: values in square brackets, as in `[1,2,3]`.
    List {
        /// The type of the elements.
        of: Box<FieldType>,
        /// The fewest elements.
        least: usize,
        /// The most elements.
        most: Option<usize>,
    },
    /// A value that may be left out.
    Optional(Box<FieldType>),
}

/// The value of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum FieldValue {
    /// A single value.
    Scalar(Scalar),
    /// The values of a struct, by the names of its fields.
    Group(Vec<(String, FieldValue)>),
    /// The elements of a list.
    List(Vec<FieldValue>),
    /// Nothing.
    None,
}

impl FieldValue {
    /// The order of two numbers or durations; `None` for all else.
    pub(super) fn order(&self, other: &FieldValue) -> Option<Ordering> {
        match (self, other) {
            (FieldValue::Scalar(Scalar::Integer(one)), FieldValue::Scalar(Scalar::Integer(other))) => {
                Some(one.get().cmp(&other.get()))
            }
            (FieldValue::Scalar(Scalar::Float(one)), FieldValue::Scalar(Scalar::Float(other))) => {
                one.partial_cmp(other)
            }
            (FieldValue::Scalar(Scalar::Duration(one)), FieldValue::Scalar(Scalar::Duration(other))) => {
                Some(one.cmp(other))
            }
            _ => None,
        }
    }
}

impl FieldType {
    /// A single value without bounds.
    pub fn scalar(kind: PropertyKind) -> FieldType {
        FieldType::Scalar { kind, bounds: None, allowed: Vec::new(), most: None }
    }

    /// True if an event may leave the field out.
    pub fn is_optional(&self) -> bool {
        matches!(self, FieldType::Optional(_))
    }

    /// Reads a value.
    ///
    /// # Errors
    /// An error says what was found and what was expected, in one line.
    pub fn read(&self, text: &str) -> Result<FieldValue, String> {
        let refused = || format!("found `{text}`, expected {}", self.expected());
        match self {
            FieldType::Scalar { kind: PropertyKind::String, most, .. } => {
                let value = match text.strip_prefix('"') {
                    Some(rest) => rest.strip_suffix('"').ok_or_else(refused)?,
                    None => text,
                };
                match most.is_some_and(|most| value.len() > most) {
                    true => Err(refused()),
                    false => Ok(FieldValue::Scalar(Scalar::Text(value.into()))),
                }
            }
            FieldType::Scalar { kind, bounds, allowed, .. } => {
                let allowed: Vec<&str> = allowed.iter().map(String::as_str).collect();
                rule(*kind, bounds.as_ref(), &allowed).check(text).map(FieldValue::Scalar)
            }
            FieldType::Group(fields) => {
                let parts = list(text, '(', ')').filter(|parts| parts.len() == fields.len()).ok_or_else(refused)?;
                let values = fields.iter().zip(parts).map(|(field, part)| {
                    Ok((field.name.clone(), field.of.read(part).map_err(|error| format!("{}: {error}", field.name))?))
                });
                values.collect::<Result<_, String>>().map(FieldValue::Group)
            }
            FieldType::List { of, least, most } => {
                let parts = list(text, '[', ']').ok_or_else(refused)?;
                if parts.len() < *least || most.is_some_and(|most| parts.len() > most) {
                    return Err(refused());
                }
                parts.into_iter().map(|part| of.read(part)).collect::<Result<_, _>>().map(FieldValue::List)
            }
            FieldType::Optional(of) => of.read(text),
        }
    }

    /// The expected value in words, as in `a whole number from 0 to 255`.
    pub fn expected(&self) -> String {
        match self {
            FieldType::Scalar { kind: PropertyKind::String, most: Some(most), .. } => {
                format!("a text of at most {most} bytes, in quotes if it has blanks")
            }
            FieldType::Scalar { kind: PropertyKind::String, .. } => "a text, in quotes if it has blanks".to_owned(),
            FieldType::Scalar { kind, bounds, allowed, .. } => {
                let allowed: Vec<&str> = allowed.iter().map(String::as_str).collect();
                rule(*kind, bounds.as_ref(), &allowed).expected()
            }
            FieldType::Group(fields) => {
                let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
                format!("`({})`, such as `{}`", names.join(","), self.sample())
            }
            FieldType::List { of, least, most } => {
                let count = match most {
                    Some(most) if most == least => format!("{most} values"),
                    Some(most) => format!("at most {most} values"),
                    None => "values".to_owned(),
                };
                format!("{count} in brackets such as `{}`, each {}", self.sample(), of.expected())
            }
            FieldType::Optional(of) => of.expected(),
        }
    }

    /// A value, as an example.
    pub fn sample(&self) -> String {
        match self {
            FieldType::Scalar { allowed, .. } if !allowed.is_empty() => allowed[0].clone(),
            FieldType::Scalar { kind, .. } => match kind {
                PropertyKind::Boolean => "true",
                PropertyKind::Float => "1.5",
                PropertyKind::Duration => "2s",
                PropertyKind::Integer => "1",
                _ => "\"text\"",
            }
            .to_owned(),
            FieldType::Group(fields) => {
                let parts: Vec<String> = fields.iter().map(|field| field.of.sample()).collect();
                format!("({})", parts.join(","))
            }
            FieldType::List { of, least, .. } => format!("[{}]", vec![of.sample(); (*least).clamp(1, 3)].join(",")),
            FieldType::Optional(of) => of.sample(),
        }
    }

    /// The only values that it has, where these are few.
    pub fn choices(&self) -> Vec<&str> {
        match self {
            FieldType::Scalar { kind: PropertyKind::Boolean, .. } => vec!["true", "false"],
            FieldType::Scalar { allowed, .. } => allowed.iter().map(String::as_str).collect(),
            FieldType::Optional(of) => of.choices(),
            _ => Vec::new(),
        }
    }

    /// True if a value can be drawn from between two others.
    pub(super) fn has_ranges(&self) -> bool {
        match self {
            FieldType::Scalar { kind, .. } => {
                matches!(kind, PropertyKind::Integer | PropertyKind::Float | PropertyKind::Duration)
            }
            FieldType::Group(fields) => fields.iter().all(|field| field.of.has_ranges()),
            FieldType::List { .. } => false,
            FieldType::Optional(of) => of.has_ranges(),
        }
    }
}

fn rule<'a>(kind: PropertyKind, bounds: Option<&'a (String, String)>, allowed: &'a [&'a str]) -> Rule<'a> {
    let bound = |text: &'a String| Bound::read(kind, text);
    let (min, max) = bounds.map_or((None, None), |(least, most)| (bound(least), bound(most)));
    Rule { min, max, allowed, ..Rule::of(kind) }
}

/// The values between two brackets, with commas outside of further brackets and quotes between them.
fn list(text: &str, open: char, close: char) -> Option<Vec<&str>> {
    let inner = text.strip_prefix(open)?.strip_suffix(close)?;
    if inner.trim().is_empty() {
        return Some(Vec::new());
    }
    let (mut depth, mut is_quoted) = (0_u32, false);
    let parts = inner.split(|sign: char| {
        match sign {
            '"' => is_quoted = !is_quoted,
            '(' | '[' if !is_quoted => depth += 1,
            ')' | ']' if !is_quoted => depth = depth.saturating_sub(1),
            _ => {}
        }
        sign == ',' && depth == 0 && !is_quoted
    });
    Some(parts.map(str::trim).collect())
}
