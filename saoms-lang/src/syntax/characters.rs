//! Names, and characters that XML forbids.

use super::document::TokenKind;
use super::lexer::Lexer;
use super::value::is_char;
use crate::diagnostic::codes;

/// Reports the characters that XML does not allow, and marks what they stand in.
pub(super) fn report_forbidden(lexer: &mut Lexer<'_>) {
    let input = lexer.input;
    // Nearly all texts have none; without a branch, the compiler makes vector instructions of this.
    let is_suspect = |byte: u8| (byte < b' ') & !matches!(byte, b'\t' | b'\n' | b'\r') | (byte == 0xef);
    if !input.text.bytes().fold(false, |found, byte| found | is_suspect(byte)) {
        return;
    }
    for (at, character) in input.text.char_indices().filter(|(_, character)| !is_char(*character)) {
        let (start, end) = (at as u32, (at + character.len_utf8()) as u32);
        lexer.faults.add(|| {
            let message = format!("the character U+{:04X} is not allowed in XML", u32::from(character));
            let one = input.fault(&codes::XML_CHARACTER, start, end, message);
            one.mend("remove it", "")
        });
        mark(lexer, start);
    }
}

fn mark(lexer: &mut Lexer<'_>, at: u32) {
    let place = lexer.tokens.partition_point(|token| token.start <= at).saturating_sub(1);
    let token = &mut lexer.tokens[place];
    match token.kind {
        TokenKind::Text | TokenKind::Section => token.is_damaged = true,
        TokenKind::StartTag | TokenKind::EmptyTag => {
            token.is_damaged = true;
            let next = lexer.attributes.partition_point(|one| one.start <= at);
            if let Some(one) = next.checked_sub(1).map(|place| &mut lexer.attributes[place])
                && one.end() > at
            {
                one.is_unsure = true;
            }
        }
        _ => {}
    }
}

/// The number of bytes at the start of `bytes` that look like a name: all bytes of a character beyond ASCII do, until
/// [`is_qualified_name`] has looked.
pub(super) fn name_length(bytes: &[u8]) -> usize {
    let is_part = |byte: &&u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.' | b':' | 0x80..);
    bytes.iter().take_while(is_part).count()
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
    starts_name(character)
        || matches!(character,
            '0'..='9' | '-' | '.' | '\u{b7}' | '\u{300}'..='\u{36f}' | '\u{203f}'..='\u{2040}')
}
