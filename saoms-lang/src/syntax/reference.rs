//! References to characters and entities: `&lt;`, `&#60;`.

use super::fault::Input;
use super::value::resolve;
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::limits::REFERENCE_BYTES;
use crate::source::Span;

const PREDEFINED: [&str; 5] = ["lt", "gt", "amp", "apos", "quot"];
/// A reference that is none.
#[derive(Clone, Copy, Debug)]
pub(super) enum BadReference {
    /// A `&` by itself.
    Ampersand(u32),
    /// A reference to nothing that is known.
    Unknown(Span),
}

/// Checks the reference whose `&` is at byte `at`; gives the byte behind its `;`.
pub(super) fn check(input: Input<'_>, at: u32) -> Result<u32, BadReference> {
    let after = &input.text[at as usize + 1..];
    let length = after.bytes().take_while(|&byte| byte.is_ascii_alphanumeric() || b"#_-.:".contains(&byte)).count();
    if after.as_bytes().get(length) != Some(&b';') || length == 0 {
        return Err(BadReference::Ampersand(at));
    }
    let end = at + length as u32 + 2;
    let inside = &after[..length];
    match length <= REFERENCE_BYTES && resolve(inside).is_some() || long_number(inside) {
        true => Ok(end),
        false => Err(BadReference::Unknown(Span::new(at, end))),
    }
}

impl BadReference {
    /// True if nobody knows which character is meant.
    pub(super) fn is_unknown(self) -> bool {
        matches!(self, Self::Unknown(_))
    }

    pub(super) fn diagnostic(self, input: Input<'_>) -> Diagnostic {
        let span = match self {
            Self::Ampersand(at) => {
                let place = Span::new(at, at + 1).in_file(input.file);
                let message = "`&` starts a reference and none follows";
                return input
                    .fault(&codes::XML_ENTITY, at, at + 1, message)
                    .help("write `&amp;` for the character itself")
                    .suggest("replace `&` with `&amp;`", place, "&amp;");
            }
            Self::Unknown(span) => span,
        };
        let written = input.slice(span.start, span.end);
        let (whole, inside) = (quoted(written), &written[1..written.len() - 1]);
        if inside.starts_with('#') {
            let message = format!("{whole} is no character that XML allows");
            let help = "a character reference is `&#` and a decimal, or `&#x` and a hexadecimal number, then `;`";
            return input.fault(&codes::XML_ENTITY, span.start, span.end, message).help(help);
        }
        let message = format!("{whole} is no entity that is known here");
        let one = input.fault(&codes::XML_ENTITY, span.start, span.end, message).help(
            "known are `&lt;`, `&gt;`, `&amp;`, `&apos;` and `&quot;`; others are refused, as are declarations of them",
        );
        match nearest(inside, PREDEFINED) {
            Some(meant) => {
                let description = format!("replace {whole} with `&{meant};`");
                one.suggest(description, span.in_file(input.file), format!("&{meant};"))
            }
            None => one,
        }
    }
}

/// True if the reference is a number with so many leading zeros that it is long, and still a character.
fn long_number(inside: &str) -> bool {
    let Some(number) = inside.strip_prefix('#') else { return false };
    let (start, digits) = number.strip_prefix('x').map_or(("#", number), |digits| ("#x", digits));
    let digits = digits.trim_start_matches('0');
    inside.len() > REFERENCE_BYTES && digits.len() <= 8 && resolve(&format!("{start}{digits}")).is_some()
}
