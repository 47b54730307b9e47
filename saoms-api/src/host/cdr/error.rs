use std::borrow::Cow;
use std::fmt;

/// A fault of bytes that are not such a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodeError(Box<Fault>);

/// The content of an error, boxed because every field that is read returns a result, and large results are slow.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Fault {
    what: Cow<'static, str>,
    offset: usize,
}

impl DecodeError {
    /// Something wrong at this byte of the message.
    #[cold]
    pub fn new(what: impl Into<Cow<'static, str>>, offset: usize) -> DecodeError {
        DecodeError(Box::new(Fault { what: what.into(), offset }))
    }

    /// Found and expected content.
    pub fn what(&self) -> &str {
        &self.0.what
    }

    /// Index of the byte, from 0, the header included.
    pub fn offset(&self) -> usize {
        self.0.offset
    }
}

impl fmt::Display for DecodeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "byte {}: {}", self.0.offset, self.0.what)
    }
}

impl std::error::Error for DecodeError {}
