//! Widths of texts, and texts cut to a width.

use super::diagram::Diagram;
use saoms_api::host::one_line;
use saoms_lang::syntax::escaped;

/// Widths of the printable characters of ASCII in thousandths of the size, as the metrics of DejaVu Sans have them: of
/// the fonts that viewers usually take for sans-serif it is the widest, so that labels fit in all of them.
const WIDTHS: [u16; 95] = [
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337, 636, 636, 636, 636, 636, 636, 636,
    636, 636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863,
    748, 787, 603, 787, 695, 635, 611, 732, 684, 989, 685, 611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635,
    615, 352, 635, 634, 278, 278, 579, 278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636,
    337, 636, 838,
];

/// The width of a text in pixels.
pub(super) fn width(text: &str, size: i32, bold: bool) -> i32 {
    let thousandths: i64 = text.chars().map(|one| i64::from(thousandths(one))).sum();
    let bold = if bold { 115 } else { 100 };
    let width = thousandths * i64::from(size) / 1000 * bold / 100;
    i32::try_from(width.max(1) + 1).unwrap_or(i32::MAX / 4)
}

fn thousandths(character: char) -> u16 {
    let place = (character as usize).checked_sub(0x20);
    match place.and_then(|place| WIDTHS.get(place)) {
        Some(width) => *width,
        // Scripts of Asia and pictures fill a square.
        None if character as u32 >= 0x1100 => 1000,
        None => 800,
    }
}

/// The start and the end of a text, of at most so many characters with an ellipsis between them when some are missing:
/// long names differ at their ends.
pub(super) fn short(text: &str, most: usize) -> String {
    let text = one_line(text).into_owned();
    let count = text.chars().count();
    if count <= most {
        return text;
    }
    let kept = most.saturating_sub(1);
    let end = kept / 2;
    text.chars().take(kept - end).chain(['…']).chain(text.chars().skip(count - end)).collect()
}

/// The end of a text of at most so many characters: what tells classes of one package apart.
pub(super) fn end(text: &str, most: usize) -> String {
    let text = one_line(text).into_owned();
    let count = text.chars().count();
    if count <= most {
        return text;
    }
    let rest: String = text.chars().skip(count + 1 - most).collect();
    format!("…{}", rest.trim_start_matches('.'))
}

/// The note of a picture about wires that are left out.
pub(super) fn left_out(diagram: &Diagram) -> Option<String> {
    match diagram.all_left_out() {
        0 => None,
        1 => Some("1 wire is not drawn".to_owned()),
        count => Some(format!("{count} wires are not drawn")),
    }
}

/// A text inside an XML element or attribute.
pub(super) fn xml(text: &str) -> String {
    escaped(&one_line(text))
}
