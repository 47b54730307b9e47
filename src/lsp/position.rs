//! Positions as editors name them: lines from 0, columns in UTF-16 units.

use std::ops::Range;

use lsp_types::Position;
use saoms_lang::source::{ColumnUnit, LineColumn, LineIndex, LineRange};
use saoms_tools::editor::File;

/// The lines of a text with columns as editors count them.
pub(super) fn lines(text: &str) -> LineIndex {
    LineIndex::new(text, ColumnUnit::Utf16)
}

/// The byte at a position: the end of the line for one behind it, the end of the text for a line that is not there.
pub(super) fn offset(lines: &LineIndex, text: &str, position: Position) -> usize {
    if position.line as usize >= lines.line_count() {
        return text.len();
    }
    let place = LineColumn { line: position.line + 1, column: position.character.saturating_add(1) };
    lines.offset(text, place)
}

/// The position of a byte; one behind the text counts as its end.
pub(super) fn position(lines: &LineIndex, text: &str, at: usize) -> Position {
    let LineColumn { line, column } = lines.line_column(text, at);
    Position::new(line - 1, column - 1)
}

/// The positions of both ends of a range of bytes.
pub(super) fn range(lines: &LineIndex, text: &str, range: Range<usize>) -> lsp_types::Range {
    lsp_types::Range::new(position(lines, text, range.start), position(lines, text, range.end))
}

/// The same of a range of bytes of a file.
pub(super) fn range_in(file: &File, at: Range<usize>) -> lsp_types::Range {
    range(&file.lines, &file.text, at)
}

/// The range of a diagnostic, whose columns are counted in UTF-16.
pub(super) fn range_of(LineRange { start, end }: LineRange) -> lsp_types::Range {
    let position = |LineColumn { line, column }: LineColumn| Position::new(line - 1, column - 1);
    lsp_types::Range::new(position(start), position(end))
}

/// The same the other way round.
pub(super) fn line_range(range: lsp_types::Range) -> LineRange {
    let place = |at: Position| LineColumn { line: at.line.saturating_add(1), column: at.character.saturating_add(1) };
    LineRange { start: place(range.start), end: place(range.end) }
}

/// The byte of a file at a position.
pub(super) fn offset_in(file: &File, at: Position) -> usize {
    offset(&file.lines, &file.text, at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_utf_16_units_there_and_back() {
        let text = "aä\r\n🤖x\rü\n\nz";
        let lines = super::lines(text);
        for (at, place) in [(0, (0, 0)), (3, (0, 2)), (5, (1, 0)), (9, (1, 2)), (10, (1, 3))].into_iter().chain([
            (11, (2, 0)),
            (13, (2, 1)),
            (14, (3, 0)),
            (15, (4, 0)),
            (16, (4, 1)),
        ]) {
            assert_eq!(position(&lines, text, at), Position::new(place.0, place.1), "{at}");
            assert_eq!(super::offset(&lines, text, Position::new(place.0, place.1)), at, "{place:?}");
        }
    }

    #[test]
    fn places_that_do_not_exist_become_the_nearest() {
        let text = "ä\n🤖\n";
        let lines = super::lines(text);
        let offset = |line, character| super::offset(&lines, text, Position::new(line, character));
        assert_eq!(offset(0, 99), 2);
        assert_eq!(offset(1, 1), 3, "within the robot");
        assert_eq!(offset(9, 0), text.len());
        assert_eq!(offset(u32::MAX, u32::MAX), text.len());
        assert_eq!(position(&lines, text, 999), Position::new(2, 0));
        assert_eq!(position(&lines, text, 5), Position::new(1, 0));
    }

    #[test]
    fn a_byte_order_mark_is_not_there() {
        let text = "\u{feff}<a/>";
        let lines = super::lines(text);
        assert_eq!(position(&lines, text, 4), Position::new(0, 1));
        assert_eq!(position(&lines, text, 0), Position::new(0, 0));
        assert_eq!(super::offset(&lines, text, Position::new(0, 1)), 4);
    }
}
