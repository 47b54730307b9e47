//! The values of properties, as they are written.

use super::{Expanding, copied, started};
use crate::assembly::text_of;
use crate::check::parameters::{Parameters, Place};
use crate::check::raw::{Piece, Raw, raw};
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes};
use crate::model::{Property, SAOMS_NAMESPACE};
use crate::xml::Node;

impl<'a> Expanding<'_, 'a> {
    /// A property with what it comes to. `None` for one that takes its value from something without a value.
    pub(super) fn property(
        &self,
        place: Place<'a>,
        property: &'a Property,
        parameters: &mut Parameters<'a>,
        report: &mut Report<'_>,
    ) -> Option<Node> {
        let document = &place.composite.document;
        let element = property.origin.element(document);
        // A table gives values that no element does.
        let is_written = element.local_name() == "property" && element.namespace() != SAOMS_NAMESPACE;
        let mut node = match is_written {
            true => started(element, &["source", "file", "value"], place.instance),
            false => Node::new("property"),
        };
        node.set("name", property.name.as_str());
        let own = |node: Node, report: &mut Report<'_>| match raw(property, document, place.instance, report)
        {
            Ok(own) => valued(node, property, own),
            Err(()) => match property.file() {
                Some(file) => node.with("file", file.as_str()),
                None => node,
            },
        };
        let Some(source) = property.source() else { return Some(own(node, report)) };
        match parameters.values(place, property, report) {
            Ok(found) if found.raw.0.is_empty() => None,
            Ok(found) => {
                if let Some((of, at)) = parameters.element_of(place.unit, source)
                    && property.element().is_none()
                    && property.r#type().is_none()
                {
                    node = node.with("element", of.as_str()).with_prefixes_in(at, of);
                }
                Some(valued(node, property, found.raw))
            }
            Err(()) => {
                let Some((open, names)) = parameters.open(place.unit, source) else {
                    let message =
                        "nobody knows what this comes to, and it is in a composite inside another one";
                    let one = Diagnostic::new(&codes::SOURCE_MALFORMED, source.location, message);
                    self.faults.borrow_mut().push(one.help("write an XPath 1.0, or give the value itself"));
                    return None;
                };
                self.open.borrow_mut().extend(names);
                Some(own(node.with("source", open), report))
            }
        }
    }
}

/// With values inside.
fn valued(node: Node, property: &Property, Raw(pieces): Raw<'_>) -> Node {
    let is_one = pieces.len() == 1;
    pieces.into_iter().fold(node, |node, piece| {
        let inner = match piece {
            Piece::Text(text) if is_one => return text_of(node, &text),
            Piece::Text(text) if text.is_empty() => Node::new("value"),
            Piece::Text(text) => Node::new("value").text(&text),
            Piece::Elements(elements, instance) => {
                let all = elements.iter().map(|one| copied(*one, instance));
                if is_one {
                    return node.children(all);
                }
                Node::new("value").children(all)
            }
            Piece::Whole(_, root, instance) if property.element().is_some() => {
                return node.child(copied(root, instance));
            }
            Piece::Whole(text, root, instance) => match root.children().next() {
                Some(_) => return node.children(root.children().map(|one| copied(one, instance))),
                None => return text_of(node, &root.trimmed_text().unwrap_or_else(|| text.clone())),
            },
        };
        node.child(inner)
    })
}
