//! The first thing that is not well-formed.

use crate::diagnostic::{Code, Diagnostic};
use crate::source::{FileId, Span};

/// Why reading stops.
#[derive(Debug)]
pub(super) enum Fault {
    /// The text is wrong.
    Wrong(Box<Diagnostic>),
    /// The text ends too early; also what a text gives that is cut before a character that XML does not allow.
    Ended(Box<Diagnostic>),
}

/// A shorthand for what the parts of the parser give.
pub(super) type Checked<T> = Result<T, Fault>;

impl Fault {
    pub(super) fn into_diagnostic(self) -> Diagnostic {
        match self {
            Self::Wrong(one) | Self::Ended(one) => *one,
        }
    }
}

impl From<Diagnostic> for Fault {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Wrong(Box::new(diagnostic))
    }
}

/// What every part of the parser reads from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input<'a> {
    pub(super) file: FileId,
    pub(super) text: &'a str,
}

impl<'a> Input<'a> {
    pub(super) fn bytes(self) -> &'a [u8] {
        self.text.as_bytes()
    }

    pub(super) fn slice(self, start: u32, end: u32) -> &'a str {
        &self.text[start as usize..end as usize]
    }

    /// A diagnostic at the bytes from `start` to `end`.
    pub(super) fn fault(
        self,
        code: &'static Code,
        start: u32,
        end: u32,
        message: impl Into<String>,
    ) -> Diagnostic {
        Diagnostic::new(code, Span::new(start, end).in_file(self.file), message)
    }

    /// The diagnostic for a text that ends inside something that starts at `start`.
    pub(super) fn ended(
        self,
        code: &'static Code,
        start: u32,
        end: u32,
        message: impl Into<String>,
    ) -> Fault {
        let one = self.fault(code, start, end, message);
        let behind = Span::empty(self.text.len() as u32).in_file(self.file);
        Fault::Ended(Box::new(one.label(behind, "the file ends here")))
    }

    /// Where the character at byte `at` ends.
    pub(super) fn character_end(self, at: u32) -> u32 {
        self.text.ceil_char_boundary(at as usize + 1) as u32
    }
}
