//! Elements that stand where they cannot because another one is closed too late or too early: one mistake, told once.

use super::Loader;
use super::vocabulary::{self, COMPONENT, COMPONENT_REFERENCE, COMPONENT_SERVICE, COMPOSITE, Kind};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::{Location, Span};
use crate::xml::{Document, Element, ElementId, Tangle};

/// The first element that is in another one only because that one is not closed before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swallowed {
    outer: ElementId,
    inner: ElementId,
}

impl Loader<'_> {
    /// Whether an element stands where it cannot because start tags and end tags do not fit, which is told.
    pub(super) fn is_swallowed(&mut self, element: Element<'_>) -> bool {
        let Some(parent) = element.parent() else { return false };
        match self.tangle {
            None => false,
            Some(Tangle::ClosedEarly(early)) => element.id() > early && self.is_closed_early(parent),
            Some(Tangle::LeftOpen) => {
                if parent.is_closed() || self.swallowed.is_some() {
                    return !parent.is_closed();
                }
                let outer = parent.parent().and_then(kind);
                let belongs_outside = outer.is_some_and(|outer| {
                    vocabulary::children(outer).any(|name| name == element.local_name())
                });
                if belongs_outside {
                    self.swallowed = Some(Swallowed { outer: parent.id(), inner: element.id() });
                }
                belongs_outside
            }
        }
    }

    /// Whether what is meant to be inside of an element that ends in its start tag is in this one.
    pub(super) fn is_closed_early(&self, parent: Element<'_>) -> bool {
        let Some(Tangle::ClosedEarly(early)) = self.tangle else { return false };
        parent.document().element(early).parent().is_some_and(|outer| outer.id() == parent.id())
    }
}

/// What is known of an element that holds others which are not its own alone.
fn kind(element: Element<'_>) -> Option<&'static Kind> {
    Some(match element.local_name() {
        "composite" => &COMPOSITE,
        "component" => &COMPONENT,
        "service" => &COMPONENT_SERVICE,
        "reference" => &COMPONENT_REFERENCE,
        _ => return None,
    })
}

impl Swallowed {
    /// What is wrong with the tags, where they are wrong: `fault` is where that is seen at last.
    pub(super) fn fault(self, document: &Document, fault: &Diagnostic) -> Diagnostic {
        let (outer, inner) = (document.element(self.outer), document.element(self.inner));
        let (file, name) = (document.file(), quoted(outer.name()));
        let close = format!("</{}>", outer.name());
        if outer.name() == inner.name() && inner.written_attributes().next().is_none() {
            let tag = inner.start_tag_span().in_file(file);
            let found = quoted(&format!("<{}>", inner.name()));
            let message = format!("{found} found where {} is expected", quoted(&close));
            let one = Diagnostic::new(&codes::XML_TAG_MISMATCH, tag, message);
            let one = one.label(outer.name_location(), format!("{name} is open"));
            return one.suggest(format!("replace it with {}", quoted(&close)), tag, close);
        }
        let message = format!("{name} is not closed before {}", quoted(inner.name()));
        let one = Diagnostic::new(&codes::XML_UNCLOSED, outer.name_location(), message);
        let one = one.label(inner.name_location(), "this stands beside it, and not in it");
        let one = match fault.code == &codes::XML_TAG_MISMATCH {
            true => one.label(fault.location, format!("found where {} is expected", quoted(&close))),
            false => one,
        };
        let text = document.text().as_str();
        let start_tag = outer.start_tag_span();
        let inside = &text[start_tag.end as usize..inner.span().start as usize];
        if inside.trim().is_empty() {
            let slash = Span::empty(start_tag.end - 1).in_file(file);
            return one.suggest(format!("end {name} with `/>`"), slash, "/");
        }
        let end = start_tag.end + inside.trim_end().len() as u32;
        let line = text[..start_tag.start as usize].rfind('\n').map_or(0, |at| at + 1);
        let indent = &text[line..start_tag.start as usize];
        let is_long = inside.trim_end().contains('\n') && indent.trim().is_empty();
        let close = if is_long { format!("\n{indent}{close}") } else { close };
        one.suggest(format!("close {name}"), Location { file, span: Span::empty(end) }, close)
    }
}
