use super::*;

fn place(text: &str, at: u32) -> (u32, u32) {
    let mut sources = Sources::new();
    let file = sources.add("t", text);
    let place = sources.get(file).line_column(at);
    assert_eq!(sources.get(file).offset(place), at, "there and back in {text:?}");
    (place.line, place.column)
}

#[test]
fn columns_count_scalars_and_lines_end_as_in_xml() {
    assert_eq!(place("", 0), (1, 1));
    assert_eq!(place("ab", 2), (1, 3));
    assert_eq!(place("a\nb", 2), (2, 1));
    assert_eq!(place("a\r\nb", 3), (2, 1));
    assert_eq!(place("a\rb", 2), (2, 1));
    assert_eq!(place("é😀x", 6), (1, 3));
    assert_eq!(place("\u{feff}ab", 4), (1, 2));
    assert_eq!(place("a\n\u{feff}b", 2), (2, 1), "a mark is one at the start of a text alone");
    assert_eq!(place("a\n\u{feff}b", 5), (2, 2));
    assert_eq!(place("a\n", 2), (2, 1));
}

#[test]
fn places_that_do_not_exist_become_the_nearest() {
    let mut sources = Sources::new();
    let file = sources.add("t", "ab\néf");
    let file = sources.get(file);
    assert_eq!(file.line_column(99), LineColumn { line: 2, column: 3 });
    assert_eq!(file.line_column(4), LineColumn { line: 2, column: 1 }, "inside a character");
    assert_eq!(file.offset(LineColumn { line: 9, column: 9 }), 6);
    assert_eq!(file.offset(LineColumn { line: 1, column: 9 }), 2);
    assert_eq!(file.offset(LineColumn { line: 0, column: 0 }), 0);
}

#[test]
fn places_in_endless_lines_are_those_that_counting_gives() {
    // Characters of one to four bytes, so that blocks begin within some of them, and lines of very different lengths.
    let mut text = "\u{feff}".to_owned();
    for number in 0..6000_u32 {
        text.push(['a', 'é', '\u{20ac}', '😀'][(number.wrapping_mul(2_654_435_761) >> 9) as usize % 4]);
        if [10, 2500, 2501].contains(&number) {
            text.push('\n');
        }
    }
    for unit in [ColumnUnit::Scalar, ColumnUnit::Utf16] {
        let index = LineIndex::new(&text, unit);
        let (mut line, mut column) = (1, 1);
        for (at, letter) in text.char_indices().skip(1) {
            let place = LineColumn { line, column };
            assert_eq!(index.line_column(&text, at), place, "byte {at}");
            assert_eq!(index.offset(&text, place), at, "{place:?}");
            let width = if unit == ColumnUnit::Scalar { 1 } else { letter.len_utf16() as u32 };
            let inside = LineColumn { column: column + width - 1, ..place };
            assert_eq!(index.offset(&text, inside), at, "within a character is before it");
            (line, column) = if letter == '\n' { (line + 1, 1) } else { (line, column + width) };
        }
        assert_eq!(index.line_column(&text, usize::MAX), LineColumn { line, column });
        assert_eq!(index.offset(&text, LineColumn { line, column: u32::MAX }), text.len());
        let end = text.find('\n').unwrap();
        assert_eq!(index.offset(&text, LineColumn { line: 1, column: u32::MAX }), end);
    }
}
