//! Parts of components that are of another kind than what is written: a property in place of a reference, and the like.

use super::{Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Edit, codes, quoted};
use crate::load::renaming;
use crate::source::{Span, Text};
use crate::syntax::{Document, Element};

/// The kinds of parts, and the attribute in which each says what it is given.
fn attribute(kind: &str) -> Option<&'static str> {
    match kind {
        "property" => Some("value"),
        "reference" => Some("target"),
        _ => None,
    }
}

/// Reports a part that is written as of one kind and is of another, for which its attributes are no further mistake.
pub(crate) fn swapped(
    (code, name): (&'static Code, &Text),
    (element, document): (Element<'_>, &Document),
    (written, right): (&'static str, &'static str),
    whose: &str,
    report: &mut Report<'_>,
) {
    let prefixed = |kind: &str| element.prefix().map_or_else(|| kind.to_owned(), |prefix| format!("{prefix}:{kind}"));
    let file = document.file();
    let mut edits = renaming(element, element.prefix(), right);
    let (from, to) = (attribute(written), attribute(right));
    for known in ["value", "target"] {
        let Some(given) = element.attribute(known) else { continue };
        report.withdraw(&codes::UNKNOWN_ATTRIBUTE, given.name_span().in_file(file));
        if let Some(to) = to.filter(|to| *to != known && element.attribute(to).is_none()) {
            edits.push(Edit { location: given.name_span().in_file(file), replacement: to.to_owned() });
        }
    }
    // What stands inside a property is the target of a reference.
    if let (Some("value"), Some("target"), Some(text)) = (from, to, element.trimmed_text()) {
        let place = Span::empty(element.name_span().end).in_file(file);
        let given =
            element.attribute("name").map_or(place, |name| Span::empty(name.value_span().end + 1).in_file(file));
        edits.push(Edit { location: given, replacement: format!(" target=\"{}\"", text.value) });
        edits.push(Edit { location: text.location, replacement: String::new() });
    }
    let message = format!("{} of {whose} is a {right}, not a {written}", quoted(name));
    let one = Diagnostic::new(code, name.location, message);
    report.push(one.suggest_edits(replacing(element.name(), &prefixed(right)), edits));
}
