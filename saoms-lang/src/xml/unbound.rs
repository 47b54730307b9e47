//! The diagnostic for a prefix that stands for nothing.

use super::fault::Input;
use super::names::name_length;
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::source::Span;

/// Prefixes that everybody writes for the same namespace.
const USUAL: [(&str, &str); 5] = [
    ("xsi", "http://www.w3.org/2001/XMLSchema-instance"),
    ("xsd", "http://www.w3.org/2001/XMLSchema"),
    ("xs", "http://www.w3.org/2001/XMLSchema"),
    ("saoms", "urn:saoms:1"),
    ("tuscany", "http://tuscany.apache.org/xmlns/sca/1.1"),
];

/// `prefix`, written at byte `start`, is none of `bound`; the root element starts at byte `root`.
pub(super) fn prefix(input: Input<'_>, prefix: &str, start: u32, bound: &[&str], root: u32) -> Diagnostic {
    let end = start + prefix.len() as u32;
    let message = format!("the prefix {} is bound to no namespace", quoted(prefix));
    let one = input.fault(&codes::XML_PREFIX, start, end, message);
    if let Some((_, uri)) = USUAL.iter().find(|(usual, _)| *usual == prefix) {
        let declaration = format!("xmlns:{prefix}=\"{uri}\"");
        let name_end = root + 1 + name_length(&input.bytes()[root as usize + 1..]) as u32;
        return one.suggest(
            format!("declare it in the root element: {}", quoted(&declaration)),
            Span::empty(name_end).in_file(input.file),
            format!(" {declaration}"),
        );
    }
    let one =
        one.help(format!("declare it, as `xmlns:{prefix}=\"...\"`, in this element or in one around it"));
    match nearest(prefix, bound.iter().copied().filter(|known| *known != "xml")) {
        Some(meant) => {
            let place = Span::new(start, end).in_file(input.file);
            one.suggest(format!("replace {} with {}", quoted(prefix), quoted(meant)), place, meant)
        }
        None => one,
    }
}
