//! The lines of a text, by bytes.

use std::ops::Range;

/// The byte where each line of a text starts. A line ends with LF, CR LF or a CR alone, as in the Language Server
/// Protocol.
#[derive(Clone, Debug)]
pub struct LineIndex {
    starts: Vec<usize>,
}

/// The byte order mark, which editors do not show.
const MARK: char = '\u{feff}';

impl LineIndex {
    /// The index of a text.
    pub fn new(text: &str) -> Self {
        let bytes = text.as_bytes();
        let mut starts = vec![if text.starts_with(MARK) { MARK.len_utf8() } else { 0 }];
        for (at, &byte) in bytes.iter().enumerate() {
            if byte == b'\n' || (byte == b'\r' && bytes.get(at + 1) != Some(&b'\n')) {
                starts.push(at + 1);
            }
        }
        Self { starts }
    }

    /// The number of the line that holds a byte, from 0. A byte order mark is part of the first line.
    pub fn line(&self, at: usize) -> usize {
        self.starts.partition_point(|&start| start <= at).max(1) - 1
    }

    /// The byte where a line starts; `None` for a line that is not there.
    pub fn start(&self, line: usize) -> Option<usize> {
        self.starts.get(line).copied()
    }

    /// The bytes of a line of the text without its end; `None` for a line that is not there.
    pub fn range(&self, text: &str, line: usize) -> Option<Range<usize>> {
        let start = self.start(line)?;
        let end = self.start(line + 1).unwrap_or(text.len());
        Some(start..start + text[start..end].trim_end_matches(['\r', '\n']).len())
    }
}
