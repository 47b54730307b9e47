//! References to characters and entities: `&lt;`, `&#60;`.

use super::fault::Input;
use super::lexer::Lexer;
use super::value::resolve;
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::source::Span;

const PREDEFINED: [&str; 5] = ["lt", "gt", "amp", "apos", "quot"];

impl Lexer<'_> {
    /// Checks the reference whose `&` is at byte `at`; gives the byte behind it, and true if it is known, or a `&` by
    /// itself.
    pub(super) fn reference(&mut self, at: u32) -> (u32, bool) {
        let input = self.input;
        let after = &input.text[at as usize + 1..];
        let length = after.bytes().take_while(|&byte| byte.is_ascii_alphanumeric() || b"#_-.:".contains(&byte)).count();
        if after.as_bytes().get(length) != Some(&b';') || length == 0 {
            let is_pair = after.starts_with('&');
            self.faults.add(|| {
                let message = "`&` must start a reference such as `&amp;`";
                let one = input.fault(&codes::XML_ENTITY, at, at + 1 + is_pair as u32, message);
                if is_pair {
                    let one = one.help("write `&amp;&amp;` for the characters themselves");
                    return one.mend("replace `&&` with the `and` of conditions", "and");
                }
                one.help("write `&amp;` for the character itself").mend("replace `&` with `&amp;`", "&amp;")
            });
            return (at + 1 + is_pair as u32, true);
        }
        let end = at + length as u32 + 2;
        if resolve(&after[..length]).is_some() {
            return (end, true);
        }
        if !self.faults.add_entity(input, at, end) {
            self.faults.add(|| unknown(input, Span::new(at, end)));
        }
        (at + 1, false)
    }
}

/// The fault of a reference to nothing that is known.
fn unknown(input: Input<'_>, span: Span) -> Diagnostic {
    let written = input.piece(span);
    let (whole, inside) = (quoted(written), &written[1..written.len() - 1]);
    if inside.starts_with('#') {
        let message = format!("{whole} is not a character that XML allows");
        let help = "write `&#` and a decimal number, or `&#x` and a hexadecimal number, then `;`";
        return input.fault(&codes::XML_ENTITY, span.start, span.end, message).help(help);
    }
    let message = format!("unknown entity {whole}");
    let one = input
        .fault(&codes::XML_ENTITY, span.start, span.end, message)
        .help("use only `&lt;`, `&gt;`, `&amp;`, `&apos;` and `&quot;`; other entities cannot be declared");
    match nearest(inside, PREDEFINED) {
        Some(meant) => one.mend(format!("replace {whole} with `&{meant};`"), format!("&{meant};")),
        None => one,
    }
}
