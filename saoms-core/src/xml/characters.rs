//! Characters: what XML forbids, and white space.

use super::fault::Input;
use crate::diagnostic::{Diagnostic, codes};

/// Bytes that are looked at together.
const CHUNK: usize = 128;

/// Where the first character is that XML 1.0 does not allow: controls but tab, line feed and carriage return, and
/// U+FFFE and U+FFFF. Surrogates cannot be in a Rust text.
pub(super) fn first_forbidden(text: &[u8]) -> Option<usize> {
    for (index, chunk) in text.chunks(CHUNK).enumerate() {
        // The whole chunk without a branch first: the compiler makes vector instructions of it. 0xEF starts U+FFFE.
        let suspect = |byte: u8| u8::from(is_control(byte)) | u8::from(byte == 0xef);
        if chunk.iter().fold(0, |any, &byte| any | suspect(byte)) != 0 {
            let start = index * CHUNK;
            let found = (start..start + chunk.len())
                .find(|&at| is_control(text[at]) || matches!(text[at..], [0xef, 0xbf, 0xbe | 0xbf, ..]));
            if found.is_some() {
                return found;
            }
        }
    }
    None
}

fn is_control(byte: u8) -> bool {
    (byte < b' ') & (byte != b'\t') & (byte != b'\n') & (byte != b'\r')
}

/// The diagnostic for such a character at byte `at`.
pub(super) fn forbidden(input: Input<'_>, at: u32) -> Diagnostic {
    let number = input.text[at as usize..].chars().next().map_or(0, u32::from);
    let message = format!("the character U+{number:04X} is not allowed in XML");
    let end = input.character_end(at);
    let place = crate::source::Span::new(at, end).in_file(input.file);
    input.fault(&codes::XML_CHARACTER, at, end, message).suggest("remove it", place, "")
}

/// Whether there is nothing but white space.
pub(super) fn is_blank(bytes: &[u8]) -> bool {
    // Mostly it is a line end and the blanks of an indentation.
    let (chunks, rest) = bytes.as_chunks::<8>();
    let is_space = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\r' | b'\n');
    chunks.iter().all(|chunk| chunk == b"        " || chunk.iter().all(is_space)) && rest.iter().all(is_space)
}
