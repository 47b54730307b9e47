//! What attribute values and character data mean once references and line ends are resolved.
//!
//! All of it works on text that was found well-formed; on other text it gives something, and does not panic.

use std::borrow::Cow;
use std::ops::Range;

/// The value of an attribute (XML 1.0, 3.3.3): each white space character a blank, references resolved.
pub(super) fn attribute_value(raw: &str) -> Cow<'_, str> {
    if raw.bytes().fold(true, |literal, byte| literal & (byte != b'&') & (byte >= b' ')) {
        return Cow::Borrowed(raw);
    }
    let mut value = String::with_capacity(raw.len());
    let mut rest = raw;
    while let Some(character) = rest.chars().next() {
        rest = match character {
            '&' => reference(rest, &mut value),
            '\r' if rest.starts_with("\r\n") => {
                value.push(' ');
                &rest[2..]
            }
            '\t' | '\n' | '\r' => {
                value.push(' ');
                &rest[1..]
            }
            _ => {
                value.push(character);
                &rest[character.len_utf8()..]
            }
        };
    }
    Cow::Owned(value)
}

/// Whether character data means itself: no markup, references or line ends to resolve.
pub(super) fn is_literal(text: &str) -> bool {
    // Without a branch, so that the compiler makes vector instructions of it; texts are short.
    text.bytes().fold(true, |literal, byte| literal & (byte != b'<') & (byte != b'&') & (byte != b'\r'))
}

/// The text of a stretch without elements: comments and instructions out, CDATA and references resolved.
pub(super) fn character_data(stretch: &str) -> Cow<'_, str> {
    if is_literal(stretch) {
        return Cow::Borrowed(stretch);
    }
    let mut text = String::with_capacity(stretch.len());
    for (piece, literal) in pieces(stretch) {
        let mut rest = &stretch[piece];
        while let Some(character) = rest.chars().next() {
            rest = match character {
                '&' if !literal => reference(rest, &mut text),
                '\r' => {
                    text.push('\n');
                    rest.strip_prefix("\r\n").unwrap_or(&rest[1..])
                }
                _ => {
                    text.push(character);
                    &rest[character.len_utf8()..]
                }
            };
        }
    }
    Cow::Owned(text)
}

/// Where a stretch without elements holds text, white space at the ends of each piece left out.
pub(super) fn text_pieces(stretch: &str) -> impl Iterator<Item = Range<u32>> {
    pieces(stretch).filter_map(|(piece, _)| {
        let text = stretch[piece.clone()].trim_end_matches(is_space);
        let start = piece.end.min(piece.start + text.len() - text.trim_start_matches(is_space).len());
        (!text.trim_start_matches(is_space).is_empty())
            .then_some(start as u32..(piece.start + text.len()) as u32)
    })
}

/// Whether XML counts it as white space.
pub(super) fn is_space(character: char) -> bool {
    matches!(character, ' ' | '\t' | '\r' | '\n')
}

/// Without XML's white space at both ends.
pub(super) fn trim(text: &str) -> &str {
    text.trim_matches(is_space)
}

/// The pieces of text between comments and instructions; the flag says that a piece is a CDATA section's inside.
fn pieces(stretch: &str) -> impl Iterator<Item = (Range<usize>, bool)> {
    const MARKUP: [(&str, &str, bool); 3] =
        [("<![CDATA[", "]]>", true), ("<!--", "-->", false), ("<?", "?>", false)];
    let mut at = 0;
    std::iter::from_fn(move || {
        while at < stretch.len() {
            let rest = &stretch[at..];
            let Some((open, close, keep)) = MARKUP.into_iter().find(|(open, ..)| rest.starts_with(open))
            else {
                let next = rest.bytes().skip(1).position(|byte| byte == b'<');
                let length = next.map_or(rest.len(), |length| length + 1);
                at += length;
                return Some((at - length..at, false));
            };
            let start = at + open.len();
            let end = stretch[start..].find(close).map_or(stretch.len(), |length| start + length);
            at = (end + close.len()).min(stretch.len());
            if keep {
                return Some((start..end, true));
            }
        }
        None
    })
}

/// Appends what the reference at the start of `text` stands for, and gives what follows it.
fn reference<'a>(text: &'a str, out: &mut String) -> &'a str {
    let Some((inside, rest)) = text[1..].split_once(';') else {
        out.push('&');
        return &text[1..];
    };
    out.push(resolve(inside).unwrap_or('\u{fffd}'));
    rest
}

/// The character that a reference names (`lt`, `#60`, `#x3C`), when it is one that XML allows.
pub(super) fn resolve(inside: &str) -> Option<char> {
    match inside {
        "lt" => Some('<'),
        "gt" => Some('>'),
        "amp" => Some('&'),
        "apos" => Some('\''),
        "quot" => Some('"'),
        _ => {
            let number = inside.strip_prefix('#')?;
            let (digits, radix) = number.strip_prefix('x').map_or((number, 10), |digits| (digits, 16));
            // `from_str_radix` takes a sign, XML does not.
            if !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
                return None;
            }
            char::from_u32(u32::from_str_radix(digits, radix).ok()?).filter(|&found| is_char(found))
        }
    }
}

/// Whether XML 1.0 allows the character.
pub(super) fn is_char(character: char) -> bool {
    matches!(character, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..)
}
