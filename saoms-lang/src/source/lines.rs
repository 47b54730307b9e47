//! Lines and columns of byte offsets.

/// A line and a column, both from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LineColumn {
    /// The line, from 1.
    pub line: u32,
    /// The column, from 1: in Unicode scalars, but for an index of other units.
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

/// The unit of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnUnit {
    /// A Unicode scalar: what users count.
    Scalar,
    /// A UTF-16 code unit: what editors count.
    Utf16,
}

/// Distance in bytes of the places whose columns are known: a line may be as long as its file.
const BLOCK: usize = 1024;

/// Index of the lines and columns of a text. A line ends with LF, CR LF, or a CR alone, as in XML.
#[derive(Clone, Debug)]
pub struct LineIndex {
    starts: Vec<usize>,
    unit: ColumnUnit,
    /// The units of the text before each block; empty if each character is one byte.
    blocks: Vec<u32>,
}

impl LineIndex {
    /// The index of a text below 4 GiB.
    pub fn new(text: &str, unit: ColumnUnit) -> Self {
        let bytes = text.as_bytes();
        let ends = memchr::memchr2_iter(b'\n', b'\r', bytes)
            .filter(|&at| bytes[at] == b'\n' || bytes.get(at + 1) != Some(&b'\n'));
        let starts = std::iter::once(0).chain(ends.map(|at| at + 1)).collect();
        let mut blocks = Vec::new();
        if !text.is_ascii() {
            let mut units = 0;
            blocks.push(units);
            for block in bytes.chunks(BLOCK) {
                units += count(block, unit) as u32;
                blocks.push(units);
            }
        }
        Self { starts, unit, blocks }
    }

    /// The number of lines, at least 1.
    pub fn line_count(&self) -> usize {
        self.starts.len()
    }

    /// The number of the line that holds a byte, from 1.
    pub fn line(&self, at: usize) -> usize {
        self.starts.partition_point(|&start| start <= at)
    }

    /// The line and column of byte `at` of the text; a place past the end counts as the end.
    pub fn line_column(&self, text: &str, at: usize) -> LineColumn {
        let at = text.floor_char_boundary(at);
        let line = self.line(at);
        let start = self.starts[line - 1];
        let start = if start == 0 { mark(text).min(at) } else { start };
        let column = self.units(text, at) - self.units(text, start);
        LineColumn { line: line as u32, column: column as u32 + 1 }
    }

    /// The byte of the text at a line and column, the nearest one when the text has no such place. A column within a
    /// character is before it.
    pub fn offset(&self, text: &str, place: LineColumn) -> usize {
        let line = (place.line.max(1) as usize).min(self.starts.len());
        let start = self.starts[line - 1];
        let end = self.starts.get(line).copied().unwrap_or(text.len());
        let start = if start == 0 { mark(text).min(end) } else { start };
        let end = start + text[start..end].trim_end_matches(['\r', '\n']).len();
        let wanted = self.units(text, start) + place.column.max(1) as usize - 1;
        if self.blocks.is_empty() {
            return wanted.min(end);
        }
        let block = self.blocks.partition_point(|&before| before as usize <= wanted) - 1;
        let from = text.ceil_char_boundary(block * BLOCK).clamp(start, end);
        let mut units = self.units(text, from);
        let mut characters = text[from..end].char_indices();
        let found = characters.find(|(_, character)| {
            units += match self.unit {
                ColumnUnit::Scalar => 1,
                ColumnUnit::Utf16 => character.len_utf16(),
            };
            units > wanted
        });
        found.map_or(end, |(at, _)| from + at)
    }

    /// The units of the text before byte `at`, which starts a character.
    fn units(&self, text: &str, at: usize) -> usize {
        let behind_block = |&before: &u32| before as usize + count(&text.as_bytes()[at / BLOCK * BLOCK..at], self.unit);
        self.blocks.get(at / BLOCK).map_or(at, behind_block)
    }
}

/// The units of the characters that start in a part of a text.
fn count(bytes: &[u8], unit: ColumnUnit) -> usize {
    let characters = bytes.iter().filter(|&&byte| byte & 0xc0 != 0x80).count();
    match unit {
        ColumnUnit::Scalar => characters,
        // Characters of four bytes have two units.
        ColumnUnit::Utf16 => characters + bytes.iter().filter(|&&byte| byte >= 0xf0).count(),
    }
}

/// The length of the byte order mark that a text starts with. It is no character of the first line: editors do not show
/// it. Elsewhere it is a character like others.
fn mark(text: &str) -> usize {
    if text.starts_with('\u{feff}') { 3 } else { 0 }
}
