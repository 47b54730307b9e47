//! What is probably meant by tags and comments that are nearly right.

use super::fault::Input;
use crate::diagnostic::{Diagnostic, Edit, codes, quoted};
use crate::source::Span;

/// The fault of a value that is open at a `<`: its quote is missing before the end of the tag, or the character is meant.
pub(super) fn open_value(input: Input<'_>, name: &str, quote_at: u32, at: u32) -> Diagnostic {
    let name = quoted(name);
    let (quote, value) = (input.slice(quote_at, quote_at + 1), input.slice(quote_at + 1, at));
    if let Some(length) = value.find('>') {
        let inside = &value[..length];
        let inside = inside.strip_suffix('/').unwrap_or(inside).trim_end();
        let end = quote_at + 1 + inside.len() as u32;
        let message = format!("the value of {name} is not closed");
        let one = input.fault(&codes::XML_ATTRIBUTE, quote_at, end, message);
        let one = one.label(Span::new(at, at + 1).in_file(input.file), "`<` cannot stand in a value");
        let other = inside.ends_with(['"', '\'']);
        let place = Span::new(end - u32::from(other), end).in_file(input.file);
        let description = match other {
            true => format!("replace {} with {}", quoted(&inside[inside.len() - 1..]), quoted(quote)),
            false => format!("close it with {}", quoted(quote)),
        };
        return one.suggest(description, place, quote);
    }
    let message = format!("`<` in the value of {name}");
    let one = input
        .fault(&codes::XML_ATTRIBUTE, at, at + 1, message)
        .label(Span::new(quote_at, quote_at + 1).in_file(input.file), "the value starts here");
    let behind = &input.text[at as usize + 1..];
    let closed = behind.find([quote.as_bytes()[0] as char, '<', '>']);
    if closed.is_some_and(|length| behind[length..].starts_with(quote)) {
        return one.suggest("replace `<` with `&lt;`", Span::new(at, at + 1).in_file(input.file), "&lt;");
    }
    one.help("close the value before, or write `&lt;` for the character itself")
}

/// The fault of a value that is closed by the quote at `end`, with which the next attribute starts: `a="b c="d"`.
pub(super) fn open_before(input: Input<'_>, quote_at: u32, end: u32) -> Option<Diagnostic> {
    let value = input.slice(quote_at + 1, end);
    let next = value.strip_suffix('=')?;
    let (before, name) = next.rsplit_once([' ', '\t', '\r', '\n'])?;
    let before = before.trim_end();
    let end = quote_at + 1 + before.len() as u32;
    let message = format!("this value is not closed before {}", quoted(name));
    let one = input.fault(&codes::XML_ATTRIBUTE, quote_at, end, message);
    let quote = input.slice(quote_at, quote_at + 1);
    Some(one.suggest(format!("close it with {}", quoted(quote)), Span::empty(end).in_file(input.file), quote))
}

/// The fault of `name: "value"`, as other languages write it.
pub(super) fn colon(input: Input<'_>, start: u32, name_end: u32, next: u32) -> Option<Diagnostic> {
    let name = input.slice(start, name_end).strip_suffix(':').filter(|name| !name.is_empty())?;
    if !matches!(input.bytes().get(next as usize), Some(b'"' | b'\'')) {
        return None;
    }
    let message = format!("`:` stands between {} and its value, and not `=`", quoted(name));
    let one = input.fault(&codes::XML_ATTRIBUTE, name_end - 1, name_end, message);
    let place = Span::new(name_end - 1, next).in_file(input.file);
    Some(one.suggest("replace `:` with `=`", place, "="))
}

/// The fault of a name with a character in it that looks like a blank, or like nothing.
pub(super) fn odd_space(input: Input<'_>, start: u32, name: &str, what: &str) -> Option<Diagnostic> {
    let is_odd = |c: char| c.is_whitespace() || matches!(c, '\u{200b}' | '\u{2060}' | '\u{feff}');
    let (length, odd) = name.char_indices().find(|(_, c)| is_odd(*c))?;
    let at = start + length as u32;
    let end = at + odd.len_utf8() as u32;
    let code = u32::from(odd);
    let (kind, meant) = if odd.is_whitespace() { ("a blank", " ") } else { ("nothing", "") };
    let message = format!("U+{code:04X}, which looks like {kind}, in the name of an {what}");
    let one = input.fault(&codes::XML_NAME, at, end, message);
    let description = if meant.is_empty() { "remove it" } else { "replace it with a blank" };
    Some(one.suggest(description, Span::new(at, end).in_file(input.file), meant))
}

/// Edits of one comment that are suggested.
const MOST_EDITS: usize = 100;

/// One `-` in place of each `--` of a comment, unless there are very many.
pub(super) fn dashes(inside: &str, start: u32, input: Input<'_>) -> Vec<Edit> {
    let mut edits = Vec::new();
    let mut at = 0;
    while let Some(length) = inside[at..].find('-') {
        let from = at + length;
        at = from + inside[from..].bytes().take_while(|byte| *byte == b'-').count();
        let replacement = if at == inside.len() { "" } else { "-" };
        if at - from > 1 || replacement.is_empty() {
            let place = Span::new(start + from as u32, start + at as u32).in_file(input.file);
            edits.push(Edit { location: place, replacement: replacement.to_owned() });
            if edits.len() > MOST_EDITS {
                return Vec::new();
            }
        }
    }
    edits
}
