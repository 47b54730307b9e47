//! Characters: what XML forbids, and white space.

use super::fault::Input;
use crate::diagnostic::{Diagnostic, codes};

/// Bytes that are looked at together.
const CHUNK: usize = 128;

/// What one look at all bytes of a text tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Survey {
    /// Where the first character is that XML 1.0 does not allow: controls but tab, line feed and carriage return, and U+FFFE and U+FFFF.
    /// Surrogates cannot be in a Rust text.
    pub(super) forbidden: Option<usize>,
    /// How many `<` there are without a `/` behind.
    pub(super) starts: usize,
    /// How many `=` there are.
    pub(super) equals: usize,
}

/// Looks at a whole text, with the widest vectors that the processor has.
pub(super) fn survey(text: &[u8]) -> Survey {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has what the function is compiled for.
        return unsafe { survey_wide(text) };
    }
    survey_plain(text)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn survey_wide(text: &[u8]) -> Survey {
    survey_plain(text)
}

#[inline(always)]
fn survey_plain(text: &[u8]) -> Survey {
    let mut survey = Survey { forbidden: None, starts: 0, equals: 0 };
    let behind = text.get(1..).unwrap_or_default();
    for (index, (chunk, behind)) in text.chunks(CHUNK).zip(behind.chunks(CHUNK)).enumerate() {
        // The whole chunk without a branch first: the compiler makes vector instructions of it. 0xEF starts U+FFFE.
        let (mut suspect, mut starts, mut equals) = (0, 0_u8, 0_u8);
        for (&byte, &next) in chunk.iter().zip(behind) {
            suspect |= u8::from(is_control(byte)) | u8::from(byte == 0xef);
            starts += u8::from((byte == b'<') & (next != b'/'));
            equals += u8::from(byte == b'=');
        }
        survey.starts += usize::from(starts);
        survey.equals += usize::from(equals);
        if suspect != 0 && survey.forbidden.is_none() {
            let start = index * CHUNK;
            survey.forbidden = (start..start + chunk.len())
                .find(|&at| is_control(text[at]) || matches!(text[at..], [0xef, 0xbf, 0xbe | 0xbf, ..]));
        }
    }
    // The last byte has none behind it.
    if let Some((&byte, before)) = text.split_last() {
        survey.equals += usize::from(byte == b'=');
        if is_control(byte) {
            survey.forbidden.get_or_insert(before.len());
        }
    }
    survey
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
