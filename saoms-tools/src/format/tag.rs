//! Start and end tags.

use super::lines::Lines;
use saoms_lang::syntax::{Attribute, Element};

/// Columns that attributes on lines of their own stand to the right of their element.
const HANG: usize = 4;

/// Writes a start tag, or the whole of an empty element: on one line when it fits.
pub(super) fn start(element: Element<'_>, is_empty: bool, width: usize, depth: usize, lines: &mut Lines<'_>) {
    let close = if is_empty { "/>" } else { ">" };
    let columns = Lines::columns(depth);
    // A line end counts once, however it is written: it may become another one.
    let length = |text: &str| text.chars().count() - text.matches("\r\n").count();
    let attributes: usize =
        element.written_attributes().map(|one| " =\"\"".len() + length(one.name()) + length(one.raw_value())).sum();
    let fits = columns + 1 + length(element.name()) + attributes + close.len() <= width;
    lines.push("<");
    lines.push(element.name());
    for (index, one) in element.written_attributes().enumerate() {
        // The first stays beside the name: most often it is the name of the part.
        if fits || index == 0 {
            lines.push(" ");
        } else {
            lines.next_at(columns + HANG);
        }
        attribute(one, lines);
    }
    lines.push(close);
}

/// Writes an end tag.
pub(super) fn end(element: Element<'_>, lines: &mut Lines<'_>) {
    lines.push("</");
    lines.push(element.name());
    lines.push(">");
}

fn attribute(one: Attribute<'_>, lines: &mut Lines<'_>) {
    let value = one.raw_value();
    let quote = if value.contains('"') { "'" } else { "\"" };
    lines.push(one.name());
    lines.push("=");
    lines.push(quote);
    lines.verbatim(value);
    lines.push(quote);
}
