//! The expressions of fleets: `${2 * index + 1}` in texts of replicas, `robots > 10 and site == 'north'` in conditions.
//!
//! ```text
//! expression = conjunction { "or" conjunction }
//! conjunction = negation { "and" negation }
//! negation   = "not" negation | comparison
//! comparison = sum [ ( "==" | "!=" | "<" | "<=" | ">" | ">=" ) sum ]
//! sum        = product { ( "+" | "-" ) product }
//! product    = sign { ( "*" | "/" | "%" ) sign }
//! sign       = "-" sign | operand
//! operand    = number | "'" text "'" | "true" | "false" | name | "(" expression ")"
//! ```
//!
//! Numbers are whole, of 64 bits; what goes beyond is a fault. `/` rounds down and `%` is never negative for a positive
//! divisor, so that `index % 11` counts around also from below zero. Nothing here panics or recurses without bound,
//! whatever the text.

mod evaluate;
mod parse;
mod template;
#[cfg(test)]
mod tests;
mod token;

use std::fmt;
use std::ops::Range;

use smol_str::SmolStr;

pub use evaluate::{boolean, integer};
pub use parse::{Expression, parse};
pub use template::{has_expression, inside, names, pattern, render};
pub use token::{is_name, words};

use crate::diagnostic::quoted;

/// The name of the number of a replica.
pub const INDEX: &str = "index";

/// The value of an expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExpressionValue {
    /// A whole number.
    Integer(i64),
    /// True or false.
    Boolean(bool),
    /// A text.
    Text(SmolStr),
}

impl fmt::Display for ExpressionValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(number) => write!(out, "the number {number}"),
            Self::Boolean(value) => write!(out, "{value}"),
            Self::Text(text) => write!(out, "the text {}", quoted(text)),
        }
    }
}

/// The reason why a name or an expression has no value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExpressionError {
    /// The fault.
    pub message: String,
    /// Help: what to do.
    pub help: Option<String>,
    /// The right text for the bytes at fault, where that is plain.
    pub instead: Option<String>,
    /// True if it is the numbers that are wrong, not the expression.
    pub(crate) is_arithmetic: bool,
}

impl ExpressionError {
    /// A problem without further words.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), ..Self::default() }
    }

    /// With what to do.
    #[must_use]
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// With what should stand there.
    #[must_use]
    pub fn instead(self, instead: impl Into<String>) -> Self {
        Self { instead: Some(instead.into()), ..self }
    }

    fn at(self, at: Range<usize>) -> ExpressionFault {
        ExpressionFault { at, problem: self }
    }
}

/// A problem at bytes of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpressionFault {
    /// The bytes at fault.
    pub at: Range<usize>,
    /// The fault.
    pub problem: ExpressionError,
}

/// The lookup of a name's value.
pub type Lookup<'l> = dyn FnMut(&str) -> Result<ExpressionValue, ExpressionError> + 'l;
