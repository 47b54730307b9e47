//! One start tag.

use std::ops::Range;

use super::Attribute;

/// What a start tag holds.
pub(crate) struct Tag {
    pub(crate) name: Range<usize>,
    pub(crate) attributes: Vec<Attribute>,
    /// Behind its `>`, or where it breaks off: before the next `<`, or at the end.
    pub(crate) end: usize,
    pub(crate) is_complete: bool,
    pub(crate) is_empty: bool,
}

/// Whether a byte can be part of a name; all beyond ASCII can.
pub(crate) fn is_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b":_-.".contains(&byte) || byte >= 0x80
}

/// Reads the tag whose `<` is at `start`.
pub(crate) fn read(text: &str, start: usize) -> Tag {
    let bytes = text.as_bytes();
    let name = name(bytes, start + 1);
    let mut at = name.end;
    let mut tag = Tag { name, attributes: Vec::new(), end: at, is_complete: false, is_empty: false };
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'<' => break,
            b'>' => {
                tag.is_complete = true;
                tag.end = at + 1;
                return tag;
            }
            b'/' if bytes.get(at + 1) == Some(&b'>') => {
                (tag.is_complete, tag.is_empty) = (true, true);
                tag.end = at + 2;
                return tag;
            }
            byte if is_name(byte) => {
                let attribute = attribute(text, at);
                at = match &attribute.value {
                    Some(value) => value.end + usize::from(attribute.is_closed),
                    None => attribute.name.end,
                };
                tag.attributes.push(attribute);
            }
            _ => at += 1,
        }
    }
    tag.end = at;
    tag
}

/// The name at a place; empty where there is none.
pub(crate) fn name(bytes: &[u8], at: usize) -> Range<usize> {
    let start = at.min(bytes.len());
    let length = bytes[start..].iter().take_while(|byte| is_name(**byte)).count();
    start..start + length
}

fn attribute(text: &str, start: usize) -> Attribute {
    let bytes = text.as_bytes();
    let name = name(bytes, start);
    let skip =
        |from: usize| from + bytes[from..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    let equals = skip(name.end);
    if bytes.get(equals) != Some(&b'=') {
        return Attribute { name, value: None, is_closed: false };
    }
    let at = skip(equals + 1);
    match bytes.get(at) {
        Some(&quote @ (b'"' | b'\'')) => {
            let (value, is_closed) = quoted(text, at + 1, quote);
            Attribute { name, value: Some(value), is_closed }
        }
        // A value without quotes ends where a tag could go on.
        Some(byte) if !b"<>/".contains(byte) && at == equals + 1 => {
            let length = bytes[at..].iter().take_while(|byte| !b"<>/ \t\r\n".contains(byte)).count();
            Attribute { name, value: Some(at..at + length), is_closed: false }
        }
        _ => Attribute { name, value: Some(equals + 1..equals + 1), is_closed: false },
    }
}

/// A value behind its first quote, and whether the other one is there.
fn quoted(text: &str, start: usize, quote: u8) -> (Range<usize>, bool) {
    let rest = &text.as_bytes()[start..];
    let end = rest.iter().position(|&byte| byte == quote || byte == b'<').unwrap_or(rest.len());
    if rest.get(end) == Some(&quote) {
        let value = &text[start..start + end];
        // `name="per value="3"`: the quote found is that of the next attribute.
        match next_attribute(value) {
            Some(at) => return (start..start + at, false),
            None => return (start..start + end, true),
        }
    }
    // It ends with its line, before what closes the tag there.
    let line = text[start..start + end].split(['\n', '\r']).next().unwrap_or_default().trim_end();
    let line = line.strip_suffix('>').map_or(line, |line| line.strip_suffix('/').unwrap_or(line));
    (start..start + line.trim_end().len(), false)
}

/// Where, in a value that ends with `name=` behind white space, that begins.
fn next_attribute(value: &str) -> Option<usize> {
    let before = value.trim_end().strip_suffix('=')?.trim_end();
    let name = before.bytes().rev().take_while(|byte| is_name(*byte)).count();
    let rest = &before[..before.len() - name];
    let is_alone = name > 0 && rest.ends_with(|c: char| c.is_ascii_whitespace());
    is_alone.then(|| rest.trim_end().len())
}
