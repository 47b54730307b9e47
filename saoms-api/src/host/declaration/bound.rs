use std::time::Duration;

use super::{PropertyKind, trim};
use crate::time::read_duration;

/// A bound of the values of a property.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound<'a> {
    text: &'a str,
    number: Number,
}

impl<'a> Bound<'a> {
    /// A bound in source code; `None` where it is no number of this type. A number comes as such, too, since the
    /// compiler reads no fractions.
    pub const fn of_literal(kind: PropertyKind, text: &'a str, number: Option<f64>) -> Option<Bound<'a>> {
        match Number::of(kind, text, number) {
            Some(number) => Some(Bound { text, number }),
            None => None,
        }
    }

    /// A bound in a declaration.
    pub fn read(kind: PropertyKind, text: &'a str) -> Option<Bound<'a>> {
        Some(Bound { text, number: Number::read(kind, trim(text))? })
    }

    /// The text in the declaration.
    pub const fn text(&self) -> &'a str {
        self.text
    }

    #[inline]
    pub(super) const fn number(&self) -> Number {
        self.number
    }
}

/// A value that has an order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    Integer(i128),
    Float(f64),
    Duration(Duration),
}

impl Number {
    /// The number that a text without blanks around it is, and `number` where that has a fraction.
    pub(super) const fn of(kind: PropertyKind, text: &str, number: Option<f64>) -> Option<Number> {
        match kind {
            PropertyKind::Integer => match integer(text) {
                Some(number) => Some(Number::Integer(number)),
                None => None,
            },
            PropertyKind::Duration => match read_duration(text) {
                Ok(duration) => Some(Number::Duration(duration)),
                Err(_) => None,
            },
            PropertyKind::Float => match number {
                Some(number) => Some(Number::Float(number)),
                None => None,
            },
            _ => None,
        }
    }

    /// The same, read while the program runs.
    pub(super) fn read(kind: PropertyKind, text: &str) -> Option<Number> {
        // `parse` also knows `inf` and `NaN`, which no range could refuse.
        let finite = || text.parse().ok().filter(|number: &f64| number.is_finite());
        Number::of(kind, text, if kind == PropertyKind::Float { finite() } else { None })
    }

    /// True if both are of one type, and this is the less.
    #[inline]
    pub(super) const fn is_below(self, other: Number) -> bool {
        match (self, other) {
            (Number::Integer(own), Number::Integer(other)) => own < other,
            (Number::Float(own), Number::Float(other)) => own < other,
            (Number::Duration(own), Number::Duration(other)) => own.as_nanos() < other.as_nanos(),
            _ => false,
        }
    }
}

/// A whole number; those of ordinary size are read much faster than 128 bits are.
const fn integer(text: &str) -> Option<i128> {
    match i64::from_str_radix(text, 10) {
        Ok(number) => Some(number as i128),
        Err(_) => match i128::from_str_radix(text, 10) {
            Ok(number) => Some(number),
            Err(_) => None,
        },
    }
}
