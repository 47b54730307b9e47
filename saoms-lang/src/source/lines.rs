//! Lines and columns of byte offsets.

/// A line and a column, both from 1; the column counts Unicode scalars.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LineColumn {
    /// The line, from 1.
    pub line: u32,
    /// The column in Unicode scalars, from 1.
    pub column: u32,
}

/// A range from one line and column to another; the end is exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LineRange {
    /// The start.
    pub start: LineColumn,
    /// The place behind its last character.
    pub end: LineColumn,
}

/// Starts of the lines of a text. A line ends with LF, CR LF, or a CR alone, as in XML.
#[derive(Debug)]
pub(super) struct LineIndex {
    starts: Vec<usize>,
    /// True if each character is one byte.
    is_ascii: bool,
}

impl LineIndex {
    pub(super) fn new(text: &str) -> Self {
        let bytes = text.as_bytes();
        let ends = memchr::memchr2_iter(b'\n', b'\r', bytes)
            .filter(|&at| bytes[at] == b'\n' || bytes.get(at + 1) != Some(&b'\n'));
        Self { starts: std::iter::once(0).chain(ends.map(|at| at + 1)).collect(), is_ascii: text.is_ascii() }
    }

    pub(super) fn line_column(&self, text: &str, at: u32) -> LineColumn {
        let at = text.floor_char_boundary(at as usize);
        let line = self.starts.partition_point(|&start| start <= at);
        let start = self.starts[line - 1];
        let start = if start == 0 { mark(text).min(at) } else { start };
        let characters = if self.is_ascii { at - start } else { text[start..at].chars().count() };
        LineColumn { line: line as u32, column: characters as u32 + 1 }
    }

    pub(super) fn offset(&self, text: &str, place: LineColumn) -> u32 {
        let line = (place.line.max(1) as usize).min(self.starts.len());
        let start = self.starts[line - 1];
        let end = self.starts.get(line).copied().unwrap_or(text.len());
        let start = if start == 0 { mark(text).min(end) } else { start };
        let content = text[start..end].trim_end_matches(['\r', '\n']);
        let before = place.column.max(1) as usize - 1;
        let length = match self.is_ascii {
            true => before.min(content.len()),
            false => content.char_indices().nth(before).map_or(content.len(), |(at, _)| at),
        };
        (start + length) as u32
    }
}

/// The length of the byte order mark that a text starts with. It is no character of the first line: editors do not show
/// it. Elsewhere it is a character like others.
fn mark(text: &str) -> usize {
    if text.starts_with('\u{feff}') { 3 } else { 0 }
}
