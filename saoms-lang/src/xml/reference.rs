//! References to characters and entities: `&lt;`, `&#60;`.

use super::fault::{Checked, Input};
use super::value::resolve;
use crate::diagnostic::{codes, nearest, quoted};

const PREDEFINED: [&str; 5] = ["lt", "gt", "amp", "apos", "quot"];
/// The longest reference that is looked at: no valid one is longer, leading zeros aside.
const LONGEST: usize = 64;

/// Checks the reference whose `&` is at byte `at`; gives the byte behind its `;`.
pub(super) fn check(input: Input<'_>, at: u32) -> Checked<u32> {
    let after = &input.text[at as usize + 1..];
    let length =
        after.bytes().take_while(|&byte| byte.is_ascii_alphanumeric() || b"#_-.:".contains(&byte)).count();
    if after.as_bytes().get(length) != Some(&b';') || length == 0 {
        return Err(input
            .fault(&codes::XML_ENTITY, at, at + 1, "`&` starts a reference and none follows")
            .help("write `&amp;` for the character itself")
            .suggest(
                "replace `&` with `&amp;`",
                crate::source::Span::new(at, at + 1).in_file(input.file),
                "&amp;",
            )
            .into());
    }
    let end = at + length as u32 + 2;
    let inside = &after[..length];
    if length <= LONGEST && resolve(inside).is_some() || long_number(inside) {
        return Ok(end);
    }
    let whole = quoted(input.slice(at, end));
    if inside.starts_with('#') {
        let message = format!("{whole} is no character that XML allows");
        let help = "a character reference is `&#` and a decimal, or `&#x` and a hexadecimal number, then `;`";
        return Err(input.fault(&codes::XML_ENTITY, at, end, message).help(help).into());
    }
    let message = format!("{whole} is no entity that is known here");
    let mut one = input
        .fault(&codes::XML_ENTITY, at, end, message)
        .help("known are `&lt;`, `&gt;`, `&amp;`, `&apos;` and `&quot;`; others are refused, as are declarations of them");
    if let Some(meant) = nearest(inside, PREDEFINED) {
        let location = crate::source::Span::new(at, end).in_file(input.file);
        one = one.suggest(format!("replace {whole} with `&{meant};`"), location, format!("&{meant};"));
    }
    Err(one.into())
}

/// A number with so many leading zeros that it is long, and still a character.
fn long_number(inside: &str) -> bool {
    let Some(number) = inside.strip_prefix('#') else { return false };
    let (start, digits) = number.strip_prefix('x').map_or(("#", number), |digits| ("#x", digits));
    let digits = digits.trim_start_matches('0');
    inside.len() > LONGEST && digits.len() <= 8 && resolve(&format!("{start}{digits}")).is_some()
}
