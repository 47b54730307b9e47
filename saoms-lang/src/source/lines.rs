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
    /// The start.
    pub start: LineColumn,
    /// The place behind its last character.
    pub end: LineColumn,
}

/// Bytes between two places whose scalars are counted beforehand, so that a place far into an endless line costs no
/// more than another.
const BLOCK: usize = 1024;

/// Starts of the lines of a text. A line ends with LF, CR LF, or a CR alone, as in XML.
#[derive(Debug)]
pub(super) struct LineIndex {
    starts: Vec<u32>,
    /// The number of scalars before each multiple of [`BLOCK`]; `None` where all are ASCII.
    scalars: Option<Vec<u32>>,
}

impl LineIndex {
    pub(super) fn new(text: &str) -> Self {
        let bytes = text.as_bytes();
        let mut starts = vec![0];
        for at in memchr::memchr2_iter(b'\n', b'\r', bytes) {
            if bytes[at] == b'\n' || bytes.get(at + 1) != Some(&b'\n') {
                starts.push(at as u32 + 1);
            }
        }
        if text.is_ascii() {
            return Self { starts, scalars: None };
        }
        let mut scalars = Vec::with_capacity(bytes.len().div_ceil(BLOCK));
        let mut before = 0;
        for block in bytes.chunks(BLOCK) {
            scalars.push(before);
            before += counted(block);
        }
        Self { starts, scalars: Some(scalars) }
    }

    pub(super) fn line_column(&self, text: &str, at: u32) -> LineColumn {
        let at = text.floor_char_boundary(at as usize);
        let line = self.starts.partition_point(|&start| start as usize <= at);
        let start = self.starts[line - 1] as usize;
        let start = if start == 0 { mark(text).min(at) } else { start };
        let column = self.before(text, at).saturating_sub(self.before(text, start)) + 1;
        LineColumn { line: line as u32, column }
    }

    pub(super) fn offset(&self, text: &str, place: LineColumn) -> u32 {
        let line = (place.line.max(1) as usize).min(self.starts.len());
        let start = self.starts[line - 1] as usize;
        let end = self.starts.get(line).map_or(text.len(), |&next| next as usize);
        let content = text[start..end].trim_end_matches(['\r', '\n']);
        let end = start + content.len();
        let start = if start == 0 { mark(content) } else { start };
        let columns = place.column.max(1) - 1;
        let Some(scalars) = &self.scalars else {
            return start.saturating_add(columns as usize).min(end) as u32;
        };
        let wanted = self.before(text, start).saturating_add(columns);
        // The last block that begins no later; the scalar with this number begins in it.
        let block = scalars.partition_point(|&before| before <= wanted).saturating_sub(1);
        let from = (block * BLOCK).clamp(start, end);
        let mut left = wanted - self.before(text, from);
        let place = text.as_bytes()[from..end].iter().position(|&byte| {
            let is_here = is_first(byte) && left == 0;
            left -= u32::from(is_first(byte) && left > 0);
            is_here
        });
        place.map_or(end, |place| from + place) as u32
    }

    /// The number of scalars that begin before byte `at`.
    fn before(&self, text: &str, at: usize) -> u32 {
        let Some(scalars) = &self.scalars else { return at as u32 };
        let block = at / BLOCK;
        match scalars.get(block) {
            Some(before) => before + counted(&text.as_bytes()[block * BLOCK..at]),
            // Right behind the last block.
            None => match block.checked_sub(1) {
                Some(last) => scalars[last] + counted(&text.as_bytes()[last * BLOCK..at]),
                None => 0,
            },
        }
    }
}

/// The length of the byte order mark that a text starts with. It is no character of the first line: editors do not show
/// it. Elsewhere it is a character like others.
fn mark(text: &str) -> usize {
    if text.starts_with('\u{feff}') { 3 } else { 0 }
}

fn counted(bytes: &[u8]) -> u32 {
    // Added up in bytes first, so that the compiler makes vector instructions of it.
    let piece = |bytes: &[u8]| bytes.iter().fold(0_u8, |count, byte| count + u8::from(is_first(*byte)));
    bytes.chunks(128).map(|bytes| u32::from(piece(bytes))).sum()
}

/// True if a scalar begins with this byte of UTF-8.
fn is_first(byte: u8) -> bool {
    byte & 0xC0 != 0x80
}
