//! Characters: those that XML forbids, white space, and how much room a text needs.

use super::attribute::UNSURE;
use super::lexer::Lexer;
use super::token::{DAMAGED_TAG, TokenKind, UNSURE_TEXT};
use crate::diagnostic::codes;
use crate::source::Span;

/// Bytes that are looked at together.
const ROW: usize = 64;

/// Upper bounds of what a text holds, and whether it holds what XML forbids.
#[derive(Clone, Copy, Debug)]
pub(super) struct Survey {
    /// The place of the first character that XML 1.0 does not allow: controls but tab, line feed and carriage return,
    /// and U+FFFE and U+FFFF. Surrogates cannot be in a Rust text.
    pub(super) forbidden: Option<usize>,
    pub(super) starts: usize,
    pub(super) tokens: usize,
    pub(super) equals: usize,
}

pub(super) fn survey(text: &[u8]) -> Survey {
    let starts = memchr::memchr_iter(b'<', text).count();
    let equals = memchr::memchr_iter(b'=', text).count();
    Survey { forbidden: next_forbidden(text, 0), starts, tokens: 2 * starts, equals }
}

/// The first forbidden character at or behind `from`.
fn next_forbidden(text: &[u8], from: usize) -> Option<usize> {
    let is_forbidden = |at: &usize| is_control(text[*at]) || matches!(text[*at..], [0xef, 0xbf, 0xbe | 0xbf, ..]);
    // Without a branch for each byte, the compiler makes vector instructions of it.
    let rows = (from..text.len()).step_by(ROW).map(|start| start..text.len().min(start + ROW));
    let is_suspect = |byte: &u8| is_control(*byte) | (*byte == 0xef);
    let suspects = rows.filter(|row| text[row.clone()].iter().fold(false, |all, byte| all | is_suspect(byte)));
    suspects.flatten().find(is_forbidden)
}

fn is_control(byte: u8) -> bool {
    (byte < b' ') & (byte != b'\t') & (byte != b'\n') & (byte != b'\r')
}

/// Reports the forbidden characters from the first one on, and marks what they stand in.
pub(super) fn report(lexer: &mut Lexer<'_>, first: usize) {
    let input = lexer.input;
    let mut next = Some(first);
    while let Some(at) = next {
        let end = input.character_end(at as u32);
        lexer.faults.add(|| {
            let number = input.text[at..].chars().next().map_or(0, u32::from);
            let message = format!("the character U+{number:04X} is not allowed in XML");
            let place = Span::new(at as u32, end).in_file(input.file);
            let one = input.fault(&codes::XML_CHARACTER, at as u32, end, message);
            one.suggest("remove it", place, "")
        });
        mark(lexer, at as u32);
        next = next_forbidden(input.bytes(), end as usize);
    }
}

fn mark(lexer: &mut Lexer<'_>, at: u32) {
    let place = lexer.tokens.partition_point(|token| token.start <= at).saturating_sub(1);
    let token = &mut lexer.tokens[place];
    match token.kind {
        TokenKind::Text | TokenKind::Section => token.flags |= UNSURE_TEXT,
        TokenKind::StartTag | TokenKind::EmptyTag => {
            token.flags |= DAMAGED_TAG;
            let next = lexer.attributes.partition_point(|one| one.start <= at);
            if let Some(one) = next.checked_sub(1).map(|place| &mut lexer.attributes[place])
                && one.end() > at
            {
                one.flags |= UNSURE;
            }
        }
        _ => {}
    }
}

/// True if there is nothing but white space.
pub(super) fn is_blank(bytes: &[u8]) -> bool {
    bytes.iter().all(|byte| matches!(byte, b' ' | b'\t' | b'\r' | b'\n'))
}
