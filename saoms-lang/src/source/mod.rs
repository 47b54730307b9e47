//! Source texts and places in them.
//!
//! [`Sources`] holds every text that was read, each under a [`FileId`]. A [`Span`] is a range of bytes of one text, a
//! [`Location`] a span together with its file. Users see lines and columns ([`LineColumn`]): both from 1, columns
//! in Unicode scalars, ends exclusive.

mod lines;
mod located;
mod open;
#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

pub use lines::{ColumnUnit, LineColumn, LineIndex, LineRange};
pub use located::{Located, Text};
pub use open::{OpenTexts, identity};

/// A file of a [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(pub u32);

/// A range of bytes of one text; `end` is exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span {
    /// The first byte.
    pub start: u32,
    /// The byte after the last.
    pub end: u32,
}

impl Span {
    /// The bytes from `start` up to, and without, `end`.
    pub const fn new(start: u32, end: u32) -> Self {
        Self { start, end }
    }

    /// The place before byte `at`, nothing long.
    pub const fn empty(at: u32) -> Self {
        Self { start: at, end: at }
    }

    /// The number of bytes.
    pub const fn len(self) -> u32 {
        self.end.saturating_sub(self.start)
    }

    /// True if it holds no byte.
    pub const fn is_empty(self) -> bool {
        self.end <= self.start
    }

    /// True if byte `at` is inside, or right behind: where an editor's cursor touches it.
    pub const fn touches(self, at: u32) -> bool {
        self.start <= at && at <= self.end
    }

    /// True if `other` lies inside.
    pub const fn contains(self, other: Self) -> bool {
        self.start <= other.start && other.end <= self.end
    }

    /// The same place in file `file`.
    pub const fn in_file(self, file: FileId) -> Location {
        Location { file, span: self }
    }
}

/// A range of bytes of one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Location {
    /// The file.
    pub file: FileId,
    /// The bytes in it.
    pub span: Span,
}

/// One text and the name under which users know it.
#[derive(Debug)]
pub struct SourceFile {
    path: Arc<str>,
    // A text as it was read: it may be as large as the rest of the program, and is never copied.
    text: Arc<String>,
    lines: Arc<OnceLock<LineIndex>>,
    /// The parts that nobody shows.
    secrets: Mutex<Vec<Span>>,
}

impl SourceFile {
    /// The name that users know: the path as they gave it.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The whole text, a byte order mark included.
    pub fn text(&self) -> &Arc<String> {
        &self.text
    }

    /// A part of the text for people: secrets are stars.
    pub fn shown(&self, part: Span) -> Cow<'_, str> {
        let text = self.text.get(part.start as usize..part.end as usize).unwrap_or_default();
        let secrets = self.secrets.lock().unwrap_or_else(PoisonError::into_inner);
        let meets = |secret: &Span| secret.start < part.end && part.start < secret.end;
        if !secrets.iter().any(meets) {
            return text.into();
        }
        let shown = text.char_indices().map(|(at, character)| {
            let at = part.start + at as u32;
            if secrets.iter().any(|secret| secret.start <= at && at < secret.end) { '*' } else { character }
        });
        shown.collect()
    }

    /// The line and column of byte `at`; a place past the end counts as the end.
    pub fn line_column(&self, at: u32) -> LineColumn {
        self.index().line_column(&self.text, at as usize)
    }

    /// Lines and columns of both ends of `span`.
    pub fn range(&self, span: Span) -> LineRange {
        LineRange { start: self.line_column(span.start), end: self.line_column(span.end.max(span.start)) }
    }

    /// The byte at a line and column, the nearest one when the text has no such place.
    pub fn offset(&self, place: LineColumn) -> u32 {
        self.index().offset(&self.text, place) as u32
    }

    fn index(&self) -> &LineIndex {
        self.lines.get_or_init(|| LineIndex::new(&self.text, ColumnUnit::Scalar))
    }
}

/// Every text that was read.
///
/// ```
/// use saoms_lang::source::{Sources, Span};
///
/// let mut sources = Sources::new();
/// let file = sources.add("fleet.composite", "<composite\n  name='fleet'/>");
/// let place = sources.get(file).line_column(13);
/// assert_eq!((place.line, place.column), (2, 3));
/// assert_eq!(sources.snippet(Span::new(13, 17).in_file(file)), "name");
/// ```
#[derive(Debug, Default)]
pub struct Sources {
    files: Vec<SourceFile>,
    /// The last file of each name.
    named: HashMap<Arc<str>, FileId>,
    open: OpenTexts,
}

impl Sources {
    /// No texts yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// No texts yet; those that an editor holds will be read in place of their files.
    pub fn with_open(open: OpenTexts) -> Self {
        Self { open, ..Self::default() }
    }

    /// The texts that are read in place of files.
    pub fn open(&self) -> &OpenTexts {
        &self.open
    }

    /// Adds a text under the name that users know it by. One that is read anew for another fleet, and is still the
    /// same, takes no memory again.
    ///
    /// # Panics
    /// When `text` has 4 GiB or more (a span could not name its bytes), or after 2^32 files.
    pub fn add(&mut self, path: impl Into<Arc<str>>, text: impl Into<String>) -> FileId {
        let text: String = text.into();
        assert!(u32::try_from(text.len()).is_ok(), "a source text is below 4 GiB");
        let id = FileId(u32::try_from(self.files.len()).unwrap_or(u32::MAX));
        let path = path.into();
        let earlier = self.named.insert(Arc::clone(&path), id).map(|earlier| self.get(earlier));
        let (text, lines) = match earlier.filter(|earlier| *earlier.text == text) {
            Some(earlier) => (Arc::clone(&earlier.text), Arc::clone(&earlier.lines)),
            None => (Arc::new(text), Arc::default()),
        };
        self.files.push(SourceFile { path, text, lines, secrets: Mutex::default() });
        id
    }

    /// The file of an identifier that [`Sources::add`] gave.
    ///
    /// # Panics
    /// When the identifier is of another `Sources`.
    pub fn get(&self, file: FileId) -> &SourceFile {
        &self.files[file.0 as usize]
    }

    /// The text at a place; empty when the place is not in the text.
    pub fn snippet(&self, at: Location) -> &str {
        self.get(at.file).text.get(at.span.start as usize..at.span.end as usize).unwrap_or_default()
    }

    /// Notes that what is at a place is a secret, which nobody shows.
    pub fn hide(&self, at: Location) {
        let mut secrets = self.get(at.file).secrets.lock().unwrap_or_else(PoisonError::into_inner);
        if !secrets.contains(&at.span) {
            secrets.push(at.span);
        }
    }

    /// The places of secrets.
    pub fn secrets(&self) -> impl Iterator<Item = Location> {
        self.iter().flat_map(|(id, file)| {
            let secrets = file.secrets.lock().unwrap_or_else(PoisonError::into_inner).clone();
            secrets.into_iter().map(move |span| span.in_file(id))
        })
    }

    /// All files in the order in which they were added.
    pub fn iter(&self) -> impl Iterator<Item = (FileId, &SourceFile)> {
        self.files.iter().enumerate().map(|(index, file)| (FileId(index as u32), file))
    }
}
