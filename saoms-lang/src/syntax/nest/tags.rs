//! Faults of start and end tags that do not fit.

use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::source::Span;
use crate::syntax::fault::Input;

/// An element, for a message.
#[derive(Clone, Copy, Debug)]
pub(super) struct Named<'a> {
    pub(super) name: &'a str,
    /// The name in the start tag.
    pub(super) at: Span,
    pub(super) start_tag: Span,
}

/// Elements of composites and those that they stand in; looked at only where tags do not fit.
const HOLDERS: &[(&str, &[&str])] = &[
    ("component", &["composite"]),
    ("include", &["composite"]),
    ("wire", &["composite"]),
    ("property", &["component", "composite", "loop"]),
    ("service", &["component", "composite"]),
    ("reference", &["component", "composite"]),
    ("loop", &["component"]),
    ("implementation.", &["component"]),
    ("interface.", &["service", "reference"]),
    ("binding.", &["service", "reference", "callback"]),
    ("callback", &["service", "reference"]),
];

/// The elements that one of this name, without its prefix, can stand in.
pub(super) fn holders(name: &str) -> Option<&'static [&'static str]> {
    let is_meant = |known: &str| name == known || (known.ends_with('.') && name.starts_with(known));
    HOLDERS.iter().find(|(known, _)| is_meant(known)).map(|(_, holders)| *holders)
}

/// True if a name, without its prefix, is one of these or a misspelling of one.
pub(super) fn is_one_of(name: &str, holders: &[&str]) -> bool {
    holders.contains(&name)
        || self::holders(name).is_none() && !is_holder(name) && nearest(name, holders.iter().copied()).is_some()
}

/// True if others stand in an element of this name, without its prefix.
pub(super) fn is_holder(name: &str) -> bool {
    HOLDERS.iter().any(|(_, holders)| holders.contains(&name))
}

/// A name without its prefix.
pub(super) fn local(name: &str) -> &str {
    name.split_once(':').map_or(name, |(_, local)| local)
}

/// The fault of a tag where that of `open` is expected.
pub(super) fn mismatch(input: Input<'_>, tag: &str, at: Span, open: Named<'_>) -> Diagnostic {
    let expected = format!("</{}>", open.name);
    let message = format!("{} found where {} is expected", quoted(tag), quoted(&expected));
    let one = input.fault(&codes::XML_TAG_MISMATCH, at.start, at.end, message);
    one.label(open.at.in_file(input.file), format!("{} is open", quoted(open.name)))
}

/// The suggestion to write the end tag of the open element instead.
pub(super) fn replaced(one: Diagnostic, open: Named<'_>) -> Diagnostic {
    let close = format!("</{}>", open.name);
    one.mend(format!("replace it with {}", quoted(&close)), close)
}

/// The suggestion to close the open element before the end tag at `end` of one around it.
pub(super) fn closed_first(input: Input<'_>, one: Diagnostic, end: u32, open: Named<'_>, is_bare: bool) -> Diagnostic {
    if is_bare && !ends_with_slash(input, open) {
        return with_slash(input, one, open);
    }
    let place = input.at(end, end);
    one.suggest(format!("close {} first", quoted(open.name)), place, format!("</{}>", open.name))
}

/// True if a start tag ends with a `/` that is part of a fault in it.
fn ends_with_slash(input: Input<'_>, open: Named<'_>) -> bool {
    input.piece(open.start_tag).ends_with("/>")
}

/// The suggestion to make an empty element of one that is open.
fn with_slash(input: Input<'_>, one: Diagnostic, open: Named<'_>) -> Diagnostic {
    let end = open.start_tag.end - 1;
    one.suggest(format!("end {} with `/>`", quoted(open.name)), input.at(end, end), "/")
}

/// The message about an element without an end tag, with the attribute that tells it from others.
pub(super) fn without_end_tag(input: Input<'_>, open: Named<'_>) -> String {
    let mut rest = input.slice(open.at.end, open.start_tag.end.max(open.at.end));
    let attributes: Vec<(&str, &str, char)> = std::iter::from_fn(|| {
        let (name, value) = rest.split_once('=')?;
        let quote = value.trim_start().chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
        let (value, next) = value.trim_start()[1..].split_once(quote)?;
        rest = next;
        Some((name.trim(), value, quote))
    })
    .collect();
    let shown = attributes.iter().find(|(name, ..)| *name == "name");
    let shown = shown.or(attributes.first()).filter(|(name, ..)| !name.starts_with("xmlns"));
    let first = shown.map_or_else(String::new, |(name, value, quote)| format!(" {name}={quote}{value}{quote}"));
    let more = if attributes.len() > usize::from(shown.is_some()) { " ..." } else { "" };
    format!("{} has no end tag", quoted(&format!("<{}{first}{more}>", open.name)))
}

/// The fault of `outer`, which is not closed before `inner`.
pub(super) fn not_closed(input: Input<'_>, outer: Named<'_>, inner: Named<'_>) -> Diagnostic {
    let name = quoted(outer.name);
    let close = format!("</{}>", outer.name);
    let message = without_end_tag(input, outer);
    let one = input.fault(&codes::XML_UNCLOSED, outer.at.start, outer.at.end, message);
    let one = one.label(inner.at.in_file(input.file), "this element belongs after it, not inside it");
    let text = input.text;
    let inside = input.slice(outer.start_tag.end, inner.start_tag.start);
    if inside.trim().is_empty() && !ends_with_slash(input, outer) {
        return with_slash(input, one, outer);
    }
    let end = outer.start_tag.end + inside.trim_end().len() as u32;
    let line = text[..outer.start_tag.start as usize].rfind('\n').map_or(0, |at| at + 1);
    let indent = &text[line..outer.start_tag.start as usize];
    let is_long = inside.trim_end().contains('\n') && indent.trim().is_empty();
    let close = if is_long { format!("\n{indent}{close}") } else { close };
    one.suggest(format!("close {name}"), input.at(end, end), close)
}

/// The fault of text beside the root element.
pub(super) fn outside(input: Input<'_>, place: Span, root: Option<Named<'_>>) -> Diagnostic {
    let message = "text outside of the root element";
    let one = input.fault(&codes::XML_OUTSIDE_ROOT, place.start, place.end, message);
    match root {
        None => one
            .help("move it into the root element, or remove it; only comments and instructions can be outside")
            .help("a composite is an XML file; tables and other files are named inside it"),
        Some(root) => one.label(root.at.in_file(input.file), "the root element"),
    }
}

/// The fault of a second element beside the root; `is_part` if it is one of those that stand in the root.
pub(super) fn second_root(input: Input<'_>, second: Named<'_>, root: Named<'_>, is_part: bool) -> Diagnostic {
    let message = "a second root element: a file has exactly one";
    let one = input.fault(&codes::XML_OUTSIDE_ROOT, second.at.start, second.at.end, message);
    let one = one.label(root.at.in_file(input.file), "the first root element");
    if is_part { one.help(format!("move it before `</{}>`, the end of the first", root.name)) } else { one }
}

/// The fault of the end tag of the root, at `end`, which has another one behind this element.
pub(super) fn too_early(input: Input<'_>, end: Span, next: Named<'_>, root: Named<'_>) -> Diagnostic {
    let tag = quoted(input.piece(end));
    let message = format!("{tag} is too early: more elements of {} and another {tag} follow", quoted(root.name));
    let one = input.fault(&codes::XML_OUTSIDE_ROOT, end.start, end.end, message);
    one.label(next.at.in_file(input.file), "the first element that follows").mend("remove it", "")
}
