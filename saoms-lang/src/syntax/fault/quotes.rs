//! Quotes of word processors and web pages around values.

use super::Input;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::Span;

/// The quotes of word processors and web pages.
const CURLY: [char; 9] =
    ['\u{201c}', '\u{201d}', '\u{201e}', '\u{201f}', '\u{2018}', '\u{2019}', '\u{201a}', '\u{ab}', '\u{bb}'];

/// The fault of a value at `at` in the quotes of a word processor; also the value inside, and where it ends.
pub(in crate::syntax) fn around(input: Input<'_>, at: u32) -> Option<(Diagnostic, Span, u32)> {
    let text = &input.text[at as usize..];
    let first = text.chars().next().filter(|first| CURLY.contains(first))?;
    let inside = &text[first.len_utf8()..];
    let length = inside.find([CURLY.as_slice(), &['"', '\'', '<', '>', '\n']].concat().as_slice())?;
    let last = inside[length..].chars().next()?;
    let is_closed = CURLY.contains(&last) || matches!(last, '"' | '\'');
    let end = at + (first.len_utf8() + length + if is_closed { last.len_utf8() } else { 0 }) as u32;
    let shown = quoted(first.encode_utf8(&mut [0; 4]));
    let message = format!("{shown} is no quote of XML: values stand between two `\"`");
    let one = input.fault(&codes::XML_ATTRIBUTE, at, end, message);
    let place = Span::new(at, end).in_file(input.file);
    let straight = format!("\"{}\"", &inside[..length]);
    let start = at + first.len_utf8() as u32;
    let value = Span::new(start, start + length as u32);
    Some((one.suggest(format!("replace it with {}", quoted(&straight)), place, straight), value, end))
}

/// The fault of a value that starts with a straight quote and is closed by one of a word processor before `end`; also
/// where that is.
pub(in crate::syntax) fn closing(input: Input<'_>, quote_at: u32, end: u32) -> Option<(Diagnostic, Span)> {
    let value = input.slice(quote_at + 1, end);
    let (length, found) = value.char_indices().find(|(_, c)| CURLY.contains(c))?;
    let at = quote_at + 1 + length as u32;
    let place = Span::new(at, at + found.len_utf8() as u32);
    let shown = quoted(found.encode_utf8(&mut [0; 4]));
    let straight = input.slice(quote_at, quote_at + 1);
    let message = format!("{shown} does not close a value that starts with {}", quoted(straight));
    let one = input.fault(&codes::XML_ATTRIBUTE, place.start, place.end, message);
    let one = one.label(Span::new(quote_at, quote_at + 1).in_file(input.file), "the value starts here");
    let description = format!("replace {shown} with {}", quoted(straight));
    Some((one.suggest(description, place.in_file(input.file), straight), place))
}
