//! Places in a text as editors name them: lines from 0, columns in UTF-16 units.

use std::ops::Range;

use lsp_types::Position;

/// Where each line of a text starts. A line ends with LF, CR LF or a CR alone, as the protocol says.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    starts: Vec<usize>,
}

/// The byte order mark, which editors do not show.
const MARK: char = '\u{feff}';

impl Lines {
    pub(super) fn new(text: &str) -> Self {
        let bytes = text.as_bytes();
        let mut starts = vec![if text.starts_with(MARK) { MARK.len_utf8() } else { 0 }];
        for (at, &byte) in bytes.iter().enumerate() {
            if byte == b'\n' || (byte == b'\r' && bytes.get(at + 1) != Some(&b'\n')) {
                starts.push(at + 1);
            }
        }
        Self { starts }
    }

    /// The byte at a place: the end of the line for one behind it, the end of the text for a line that is not there.
    pub(super) fn offset(&self, text: &str, place: Position) -> usize {
        let Some(&start) = self.starts.get(place.line as usize) else { return text.len() };
        let end = self.starts.get(place.line as usize + 1).map_or(text.len(), |&next| next);
        let line = text[start..end].trim_end_matches(['\r', '\n']);
        let mut left = place.character as usize;
        for (at, character) in line.char_indices() {
            // A place within a character is before it.
            if left < character.len_utf16() {
                return start + at;
            }
            left -= character.len_utf16();
        }
        start + line.len()
    }

    /// The place of a byte; one behind the text counts as its end.
    pub(super) fn position(&self, text: &str, at: usize) -> Position {
        let at = text.floor_char_boundary(at);
        let line = self.starts.partition_point(|&start| start <= at).max(1) - 1;
        let before = text.get(self.starts[line]..at).unwrap_or_default();
        Position::new(line as u32, before.encode_utf16().count() as u32)
    }

    /// Both ends of a range of bytes.
    pub(super) fn range(&self, text: &str, range: Range<usize>) -> lsp_types::Range {
        lsp_types::Range::new(self.position(text, range.start), self.position(text, range.end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_utf_16_units_there_and_back() {
        let text = "aä\r\n🤖x\rü\n\nz";
        let lines = Lines::new(text);
        for (at, place) in [(0, (0, 0)), (3, (0, 2)), (5, (1, 0)), (9, (1, 2)), (10, (1, 3))]
            .into_iter()
            .chain([(11, (2, 0)), (13, (2, 1)), (14, (3, 0)), (15, (4, 0)), (16, (4, 1))])
        {
            assert_eq!(lines.position(text, at), Position::new(place.0, place.1), "{at}");
            assert_eq!(lines.offset(text, Position::new(place.0, place.1)), at, "{place:?}");
        }
    }

    #[test]
    fn places_that_do_not_exist_become_the_nearest() {
        let text = "ä\n🤖\n";
        let lines = Lines::new(text);
        let offset = |line, character| lines.offset(text, Position::new(line, character));
        assert_eq!(offset(0, 99), 2);
        assert_eq!(offset(1, 1), 3, "within the robot");
        assert_eq!(offset(9, 0), text.len());
        assert_eq!(offset(u32::MAX, u32::MAX), text.len());
        assert_eq!(lines.position(text, 999), Position::new(2, 0));
        assert_eq!(lines.position(text, 5), Position::new(1, 0));
    }

    #[test]
    fn a_byte_order_mark_is_not_there() {
        let text = "\u{feff}<a/>";
        let lines = Lines::new(text);
        assert_eq!(lines.position(text, 4), Position::new(0, 1));
        assert_eq!(lines.position(text, 0), Position::new(0, 0));
        assert_eq!(lines.offset(text, Position::new(0, 1)), 4);
    }
}
