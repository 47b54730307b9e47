use std::fmt;
use std::time::Duration;

use smol_str::{SmolStr, format_smolstr};

use super::PropertyKind;
use super::bound::Number;
use crate::host::format_duration;

/// A value of a property that does not consist of others.
#[derive(Clone, Debug, PartialEq)]
pub enum Scalar {
    /// True or false.
    Boolean(bool),
    /// A whole number.
    Integer(Integer),
    /// A finite number.
    Float(f64),
    /// A duration.
    Duration(Duration),
    /// A string, or the chosen text of an enumeration. Beyond the boundary to a plugin, and in tests, also the text
    /// of a value of any other type, which its taker reads: see [`Rule::take`](super::Rule::take).
    Text(SmolStr),
}

/// A whole number of any integer type. It is aligned so that values are no larger for it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(Rust, packed(8))]
pub struct Integer(i128);

impl Integer {
    /// The number.
    pub const fn get(self) -> i128 {
        self.0
    }
}

impl<T: Into<i128>> From<T> for Integer {
    fn from(number: T) -> Integer {
        Integer(number.into())
    }
}

impl fmt::Debug for Integer {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.get().fmt(formatter)
    }
}

impl Scalar {
    /// The value of a literal in source code, which is a text that nobody has read where it is no value of its type. A
    /// number comes as such, too, since the compiler reads no fractions.
    pub const fn of_literal(kind: PropertyKind, text: &'static str, number: Option<f64>) -> Scalar {
        match (kind, text.as_bytes()) {
            (PropertyKind::Boolean, b"true") => Scalar::Boolean(true),
            (PropertyKind::Boolean, b"false") => Scalar::Boolean(false),
            _ => match Number::of(kind, text, number) {
                Some(number) => Scalar::of(number),
                None => Scalar::Text(SmolStr::new_static(text)),
            },
        }
    }

    const fn of(number: Number) -> Scalar {
        match number {
            Number::Integer(number) => Scalar::Integer(Integer(number)),
            Number::Float(number) => Scalar::Float(number),
            Number::Duration(duration) => Scalar::Duration(duration),
        }
    }

    /// The number or the duration, which can be compared with bounds.
    #[inline]
    pub(super) const fn number(&self) -> Option<Number> {
        match self {
            Scalar::Integer(number) => Some(Number::Integer(number.get())),
            Scalar::Float(number) => Some(Number::Float(*number)),
            Scalar::Duration(duration) => Some(Number::Duration(*duration)),
            Scalar::Boolean(_) | Scalar::Text(_) => None,
        }
    }

    /// The text; `None` where it is read as something else.
    #[inline]
    pub fn as_text(&self) -> Option<&SmolStr> {
        match self {
            Scalar::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The usual text of the value, which its type reads as this value.
    pub fn text(&self) -> SmolStr {
        match self {
            Scalar::Text(text) => text.clone(),
            other => format_smolstr!("{other}"),
        }
    }
}

impl Scalar {
    /// True if a text that was read as this value is its usual [`text`](Scalar::text).
    pub fn is_usually(&self, text: &str) -> bool {
        match self {
            // At most blanks around it do not count.
            Scalar::Text(own) => own.len() == text.len(),
            // Most numbers are nothing but digits, which need not be written to be compared.
            Scalar::Integer(_) if !text.starts_with('0') && text.bytes().all(|byte| byte.is_ascii_digit()) => true,
            value => value.text() == text,
        }
    }
}

impl fmt::Display for Scalar {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Scalar::Boolean(value) => value.fmt(formatter),
            Scalar::Integer(number) => number.get().fmt(formatter),
            Scalar::Float(number) => number.fmt(formatter),
            Scalar::Duration(duration) => formatter.write_str(&format_duration(*duration)),
            Scalar::Text(text) => formatter.write_str(text),
        }
    }
}

/// Reads a value of a scalar type. `None` when the text is no such value; [`Rule::check`](super::Rule::check) gives the
/// reason.
pub fn parse_scalar(kind: PropertyKind, text: &SmolStr) -> Option<Scalar> {
    let trimmed = trim(text);
    match kind {
        PropertyKind::Boolean => match trimmed {
            "true" | "1" => Some(Scalar::Boolean(true)),
            "false" | "0" => Some(Scalar::Boolean(false)),
            _ => None,
        },
        PropertyKind::Integer | PropertyKind::Float | PropertyKind::Duration => {
            Number::read(kind, trimmed).map(Scalar::of)
        }
        PropertyKind::Enumeration if trimmed.len() < text.len() => Some(Scalar::Text(trimmed.into())),
        PropertyKind::String | PropertyKind::Enumeration => Some(Scalar::Text(text.clone())),
        PropertyKind::Complex => None,
    }
}

/// A text without the blanks around it, of which most have none: a look at both ends is enough then.
pub(crate) fn trim(text: &str) -> &str {
    match text.as_bytes() {
        [first, .., last] if first.is_ascii_graphic() && last.is_ascii_graphic() => text,
        [only] if only.is_ascii_graphic() => text,
        _ => text.trim(),
    }
}
