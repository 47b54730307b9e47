//! Faults of prefixes that are bound to no namespace.

use super::Input;
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

/// The fault of a prefix that is none of `bound`, written at byte `start`; `root_end` is behind the name of the root
/// element. Also the namespace that is meant, or the prefix.
pub(in crate::syntax) fn prefix<'a>(
    input: Input<'_>,
    prefix: &str,
    start: u32,
    bound: &[&'a str],
    root_end: u32,
) -> (Diagnostic, Option<Meant<'a>>) {
    let end = start + prefix.len() as u32;
    let message = format!("the prefix {} is bound to no namespace", quoted(prefix));
    let one = input.fault(&codes::XML_PREFIX, start, end, message);
    if let Some((_, uri)) = USUAL.iter().find(|(usual, _)| *usual == prefix) {
        let declaration = format!("xmlns:{prefix}=\"{uri}\"");
        let one = one.suggest(
            format!("declare it in the root element: {}", quoted(&declaration)),
            Span::empty(root_end).in_file(input.file),
            format!(" {declaration}"),
        );
        return (one, Some(Meant::Namespace(uri)));
    }
    let one = one.help(format!("declare it, as `xmlns:{prefix}=\"...\"`, in this element or in one around it"));
    match nearest(prefix, bound.iter().copied().filter(|known| *known != "xml")) {
        Some(meant) => {
            let place = Span::new(start, end).in_file(input.file);
            let description = format!("replace {} with {}", quoted(prefix), quoted(meant));
            (one.suggest(description, place, meant), Some(Meant::Prefix(meant)))
        }
        None => (one, None),
    }
}

/// The meaning of a prefix that is bound to no namespace.
pub(in crate::syntax) enum Meant<'a> {
    Namespace(&'static str),
    Prefix(&'a str),
}
