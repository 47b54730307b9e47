//! Characters: what XML forbids, and white space.

use super::fault::Input;
use crate::diagnostic::{Diagnostic, codes};

/// Bytes that are looked at together, as many as the widest vectors hold.
const LANES: usize = 32;
/// Rows of as many that are counted before the counts of the lanes are added up: they fit into a byte each.
const ROWS: usize = 128;

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
    let before = &text[..behind.len()];
    let mut start = 0;
    for (block, behind) in before.chunks(ROWS * LANES).zip(behind.chunks(ROWS * LANES)) {
        // Each lane by itself and without a branch: the compiler makes vector instructions of it.
        let (mut suspect, mut starts, mut equals) = ([0_u8; LANES], [0_u8; LANES], [0_u8; LANES]);
        let ((rows, rest), (behind, rest_behind)) = (block.as_chunks::<LANES>(), behind.as_chunks::<LANES>());
        for (row, behind) in rows.iter().zip(behind) {
            for lane in 0..LANES {
                suspect[lane] |= is_suspect(row[lane]);
                starts[lane] += is_start(row[lane], behind[lane]);
                equals[lane] += u8::from(row[lane] == b'=');
            }
        }
        for (lane, (&byte, &next)) in rest.iter().zip(rest_behind).enumerate() {
            suspect[lane] |= is_suspect(byte);
            starts[lane] += is_start(byte, next);
            equals[lane] += u8::from(byte == b'=');
        }
        survey.starts += starts.iter().map(|count| usize::from(*count)).sum::<usize>();
        survey.equals += equals.iter().map(|count| usize::from(*count)).sum::<usize>();
        if suspect != [0; LANES] && survey.forbidden.is_none() {
            survey.forbidden = first_forbidden(text, start..start + block.len());
        }
        start += block.len();
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

/// Whether a byte is a control, or may start U+FFFE or U+FFFF.
#[inline(always)]
fn is_suspect(byte: u8) -> u8 {
    u8::from(is_control(byte)) | u8::from(byte == 0xef)
}

#[inline(always)]
fn is_start(byte: u8, next: u8) -> u8 {
    u8::from((byte == b'<') & (next != b'/'))
}

/// The first place of these that has a forbidden character.
fn first_forbidden(text: &[u8], range: std::ops::Range<usize>) -> Option<usize> {
    let is_forbidden =
        |at: &usize| is_control(text[*at]) || matches!(text[*at..], [0xef, 0xbf, 0xbe | 0xbf, ..]);
    // Of a language that has many characters that start as those do, most rows have none.
    let rows = range.clone().step_by(LANES).map(|start| start..range.end.min(start + LANES));
    let suspects =
        rows.filter(|row| text[row.clone()].iter().fold(0, |all, byte| all | is_suspect(*byte)) != 0);
    suspects.flatten().find(is_forbidden)
}

#[inline(always)]
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
