//! Lines and columns of byte offsets.

/// A line and a column, both from 1; the column counts Unicode scalars.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LineColumn {
    /// The line, from 1.
    pub line: u32,
    /// The column in Unicode scalars, from 1.
    pub column: u32,
}

/// From one line and column to another; the end is exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LineRange {
    /// Where it starts.
    pub start: LineColumn,
    /// The place behind its last character.
    pub end: LineColumn,
}

/// Where each line of a text starts. A line ends with LF, CR LF, or a CR alone, as in XML.
#[derive(Debug)]
pub(super) struct LineIndex {
    starts: Vec<u32>,
}

impl LineIndex {
    pub(super) fn new(text: &str) -> Self {
        let bytes = text.as_bytes();
        let mut starts = vec![0];
        for (at, &byte) in bytes.iter().enumerate() {
            if byte == b'\n' || (byte == b'\r' && bytes.get(at + 1) != Some(&b'\n')) {
                starts.push(at as u32 + 1);
            }
        }
        Self { starts }
    }

    pub(super) fn line_column(&self, text: &str, at: u32) -> LineColumn {
        let at = text.floor_char_boundary(at as usize);
        let line = self.starts.partition_point(|&start| start as usize <= at);
        let start = self.starts[line - 1] as usize;
        // The byte order mark is no character of the first line: editors do not show it.
        let before = text[start..at].trim_start_matches('\u{feff}');
        LineColumn { line: line as u32, column: before.chars().count() as u32 + 1 }
    }

    pub(super) fn offset(&self, text: &str, place: LineColumn) -> u32 {
        let line = (place.line.max(1) as usize).min(self.starts.len());
        let start = self.starts[line - 1] as usize;
        let end = self.starts.get(line).map_or(text.len(), |&next| next as usize);
        let content = text[start..end].trim_end_matches(['\r', '\n']);
        let mark = if content.starts_with('\u{feff}') { 3 } else { 0 };
        let column = place.column.max(1) as usize - 1;
        let inside = content[mark..].char_indices().nth(column).map_or(content.len() - mark, |(at, _)| at);
        (start + mark + inside) as u32
    }
}
