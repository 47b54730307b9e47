//! XML names.

/// Whether a byte can stand in a name; all of a longer character do until [`is_name`] has looked.
const NAME_BYTE: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0;
    while byte < 256 {
        let b = byte as u8;
        table[byte] = b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'.' | b':') || b >= 0x80;
        byte += 1;
    }
    table
};

/// How many bytes at the start of `bytes` look like a name.
pub(super) fn name_length(bytes: &[u8]) -> usize {
    bytes.iter().position(|&byte| !NAME_BYTE[byte as usize]).unwrap_or(bytes.len())
}

/// Whether it is a Name without a colon (NCName of Namespaces in XML 1.0).
pub(super) fn is_local_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(starts_name) && characters.all(continues_name)
}

/// Whether it is a Name with at most one colon, both sides a name of their own (QName).
pub(super) fn is_qualified_name(name: &str) -> bool {
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
