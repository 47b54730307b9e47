//! Values that know where they were written.

use std::fmt;
use std::ops::Deref;

use smol_str::SmolStr;

use super::{FileId, Location, Span};

/// A value and the place where it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Located<T> {
    /// The value.
    pub value: T,
    /// The place in the file: for an attribute the characters between the quotes.
    pub location: Location,
}

/// A text as the user means it (entities resolved, white space normalised) and the place where it is written. Texts up
/// to 23 bytes, as most names and values are, are stored in place; longer ones are shared by their clones.
pub type Text = Located<SmolStr>;

impl<T> Located<T> {
    /// A value at a place.
    pub const fn new(value: T, location: Location) -> Self {
        Self { value, location }
    }
}

impl Text {
    /// A part of the text of `file`, without white space at its ends, and its place.
    pub(crate) fn part_of(file: FileId, text: &str, part: &str) -> Self {
        let part = part.trim();
        let start = part.as_ptr() as usize - text.as_ptr() as usize;
        Self::new(part.into(), Span::new(start as u32, (start + part.len()) as u32).in_file(file))
    }

    /// The text itself.
    pub fn as_str(&self) -> &str {
        &self.value
    }
}

impl<T> Deref for Located<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: fmt::Display> fmt::Display for Located<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(out)
    }
}

impl PartialEq<str> for Text {
    fn eq(&self, other: &str) -> bool {
        self.value == other
    }
}

impl PartialEq<&str> for Text {
    fn eq(&self, other: &&str) -> bool {
        self.value == *other
    }
}
