//! Meaning of attribute values and character data: references and line ends resolved.

use std::borrow::Cow;
use std::ops::Range;

/// The surroundings of a text, which decide what its characters mean.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// In an attribute, where each white space character is a blank (XML 1.0, 3.3.3).
    Attribute,
    /// Between tags.
    Content,
    /// In a CDATA section, where only line ends mean something else.
    Section,
}

/// The text that is meant: references and line ends resolved.
pub(super) fn meant(written: &str, place: Place) -> Cow<'_, str> {
    if !written.bytes().any(|byte| matches!(byte, b'&' | b'\t' | b'\n' | b'\r')) {
        return Cow::Borrowed(written);
    }
    let mut text = String::with_capacity(written.len());
    characters(written, place, |character, _| text.push(character));
    Cow::Owned(text)
}

/// Each character that is meant, with the bytes that it is written with.
fn characters(written: &str, place: Place, mut each: impl FnMut(char, Range<usize>)) {
    let line_end = if place == Place::Attribute { ' ' } else { '\n' };
    let mut at = 0;
    while let Some(character) = written[at..].chars().next() {
        let rest = &written[at..];
        let (character, length) = match character {
            '&' if place != Place::Section => reference(rest),
            '\r' if rest.starts_with("\r\n") => (line_end, 2),
            '\r' | '\n' => (line_end, 1),
            '\t' if place == Place::Attribute => (' ', 1),
            _ => (character, character.len_utf8()),
        };
        each(character, at..at + length);
        at += length;
    }
}

/// The inside of a CDATA section, which may lack its end.
pub(super) fn section(written: &str) -> &str {
    let inside = written.get("<![CDATA[".len()..).unwrap_or(&written[written.len()..]);
    inside.strip_suffix("]]>").unwrap_or(inside)
}

/// Each character that a stretch without elements means, with the bytes that it is written with.
fn content_characters(stretch: &str, mut each: impl FnMut(char, Range<usize>)) {
    for (piece, place) in pieces(stretch) {
        let start = piece.start;
        characters(&stretch[piece], place, |character, bytes| each(character, bytes.start + start..bytes.end + start));
    }
}

/// The bytes of the parts of a value in the text.
pub(crate) struct SourceMap(Option<Characters>);

impl SourceMap {
    /// `written` is the stretch, or the attribute, that the value was read from, and may have white space at its ends
    /// that the value has not; `None` when it is another one.
    pub(crate) fn of(written: &str, value: &str) -> Option<Self> {
        if written == value {
            return Some(Self(None));
        }
        let content = Characters::of(value, |each| content_characters(written, each));
        let found = content.or_else(|| Characters::of(value, |each| characters(written, Place::Attribute, each)));
        found.map(|characters| Self(Some(characters)))
    }

    /// The bytes that a part of the value is written with.
    pub(crate) fn part(&self, part: Range<usize>) -> Option<Range<usize>> {
        match &self.0 {
            Some(characters) => characters.part(part),
            None => Some(part),
        }
    }
}

/// The places of the characters of a value, in the value and in the text.
struct Characters {
    all: Vec<(u32, Range<u32>)>,
    /// The length of the value.
    length: usize,
}

impl Characters {
    /// `None` when what is written is another value.
    fn of(value: &str, characters: impl FnOnce(&mut dyn FnMut(char, Range<usize>))) -> Option<Self> {
        let mut text = String::new();
        let mut all = Vec::new();
        characters(&mut |character, bytes| {
            all.push((text.len() as u32, bytes.start as u32..bytes.end as u32));
            text.push(character);
        });
        if trim(&text) != value {
            return None;
        }
        let start = (text.len() - text.trim_start_matches(is_space).len()) as u32;
        all.retain(|(at, _)| *at >= start);
        all.iter_mut().for_each(|(at, _)| *at -= start);
        Some(Self { all, length: value.len() })
    }

    fn part(&self, part: Range<usize>) -> Option<Range<usize>> {
        let bytes = |at: usize| {
            let place = self.all.partition_point(|(first, _)| *first as usize <= at);
            let (_, bytes) = self.all.get(place.checked_sub(1)?)?;
            Some(bytes.start as usize..bytes.end as usize)
        };
        if part.is_empty() {
            let at = if part.start >= self.length {
                bytes(part.start.checked_sub(1)?)?.end
            } else {
                bytes(part.start)?.start
            };
            return Some(at..at);
        }
        Some(bytes(part.start)?.start..bytes(part.end - 1)?.end)
    }
}

/// True if XML counts it as white space.
pub(super) fn is_space(character: char) -> bool {
    matches!(character, ' ' | '\t' | '\r' | '\n')
}

/// Without XML's white space at both ends.
pub(super) fn trim(text: &str) -> &str {
    text.trim_matches(is_space)
}

/// The pieces of text between comments and instructions.
fn pieces(stretch: &str) -> impl Iterator<Item = (Range<usize>, Place)> {
    const MARKUP: [(&str, &str, bool); 3] = [("<![CDATA[", "]]>", true), ("<!--", "-->", false), ("<?", "?>", false)];
    let mut at = 0;
    std::iter::from_fn(move || {
        while at < stretch.len() {
            let rest = &stretch[at..];
            let Some((open, close, keep)) = MARKUP.into_iter().find(|(open, ..)| rest.starts_with(open)) else {
                let next = rest.bytes().skip(1).position(|byte| byte == b'<');
                let length = next.map_or(rest.len(), |length| length + 1);
                at += length;
                return Some((at - length..at, Place::Content));
            };
            let start = at + open.len();
            let end = stretch[start..].find(close).map_or(stretch.len(), |length| start + length);
            at = (end + close.len()).min(stretch.len());
            if keep {
                return Some((start..end, Place::Section));
            }
        }
        None
    })
}

/// The character that the reference at the start of `text` means, and its length in bytes. A `&` by itself is a
/// character.
fn reference(text: &str) -> (char, usize) {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"#_-.:".contains(byte);
    let length = text.bytes().skip(1).take_while(is_part).count();
    match text.as_bytes().get(1 + length) {
        Some(b';') if length > 0 => (resolve(&text[1..1 + length]).unwrap_or('\u{fffd}'), length + 2),
        _ => ('&', 1),
    }
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

/// True if XML 1.0 allows the character.
pub(super) fn is_char(character: char) -> bool {
    matches!(character, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..)
}
