//! XML names.

/// The byte can stand in a name; all bytes of a longer character do until [`is_qualified_name`] has looked.
const NAME: u8 = 1;
/// The byte is a colon, or part of a character beyond ASCII: the name needs a closer look.
const ODD: u8 = 2;
/// The byte cannot start a name.
const INNER: u8 = 4;

const CLASS: [u8; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        table[byte] = match byte as u8 {
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => NAME,
            b'0'..=b'9' | b'-' | b'.' => NAME | INNER,
            b':' | 0x80.. => NAME | ODD,
            _ => 0,
        };
        byte += 1;
    }
    table
};

/// Bytes that look like a name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Name {
    /// The number of names.
    pub(super) len: u32,
    /// True if they certainly are a name without a colon; most are.
    pub(super) is_plain: bool,
}

/// The name at the start of `bytes`.
pub(super) fn scan(bytes: &[u8]) -> Name {
    let mut seen = bytes.first().map_or(0, |&first| CLASS[first as usize] & INNER);
    let mut len = 0;
    for &byte in bytes {
        let class = CLASS[byte as usize];
        if class & NAME == 0 {
            break;
        }
        seen |= class & ODD;
        len += 1;
    }
    Name { len, is_plain: seen == 0 && len > 0 }
}

/// The number of bytes at the start of `bytes` that look like a name.
pub(super) fn name_length(bytes: &[u8]) -> usize {
    scan(bytes).len as usize
}

/// True if it is a Name without a colon (NCName of Namespaces in XML 1.0).
pub(crate) fn is_local_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(starts_name) && characters.all(continues_name)
}

/// True if it is a Name with at most one colon, both sides a name of their own (QName).
pub(crate) fn is_qualified_name(name: &str) -> bool {
    match name.split_once(':') {
        Some((prefix, local)) => is_local_name(prefix) && is_local_name(local),
        None => is_local_name(name),
    }
}

/// NameStartChar of XML 1.0, 5th edition, without the colon.
fn starts_name(character: char) -> bool {
    match character {
        'a'..='z' | 'A'..='Z' | '_' => true,
        _ if character.is_ascii() => false,
        _ => matches!(character,
            '\u{c0}'..='\u{d6}' | '\u{d8}'..='\u{f6}' | '\u{f8}'..='\u{2ff}' | '\u{370}'..='\u{37d}'
            | '\u{37f}'..='\u{1fff}' | '\u{200c}'..='\u{200d}' | '\u{2070}'..='\u{218f}'
            | '\u{2c00}'..='\u{2fef}' | '\u{3001}'..='\u{d7ff}' | '\u{f900}'..='\u{fdcf}'
            | '\u{fdf0}'..='\u{fffd}' | '\u{10000}'..='\u{effff}'),
    }
}

/// NameChar of XML 1.0, 5th edition, without the colon.
fn continues_name(character: char) -> bool {
    match character {
        '0'..='9' | '-' | '.' => true,
        '\u{b7}' | '\u{300}'..='\u{36f}' | '\u{203f}'..='\u{2040}' => true,
        _ => starts_name(character),
    }
}
