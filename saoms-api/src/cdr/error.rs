use std::borrow::Cow;
use std::fmt;

/// Why bytes are no such message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodeError {
    what: Cow<'static, str>,
    offset: usize,
}

impl DecodeError {
    /// Something wrong at this byte of the message.
    pub fn new(what: impl Into<Cow<'static, str>>, offset: usize) -> DecodeError {
        DecodeError { what: what.into(), offset }
    }

    /// What was found and what was expected.
    pub fn what(&self) -> &str {
        &self.what
    }

    /// Where: the number of the byte, from 0, the header included.
    pub const fn offset(&self) -> usize {
        self.offset
    }
}

impl fmt::Display for DecodeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "byte {}: {}", self.offset, self.what)
    }
}

impl std::error::Error for DecodeError {}
