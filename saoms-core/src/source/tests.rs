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
