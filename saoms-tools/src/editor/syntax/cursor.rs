//! What stands at a place of a text.

use std::ops::Range;

use super::{Tree, tag};

/// What stands at a place, and the element that it is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Cursor {
    /// The name of an element, or the place of one behind a `<`; the element is that around it.
    ElementName { parent: Option<usize>, element: usize, name: Range<usize> },
    /// The name in an end tag; the element is the one that it should end.
    EndTag { element: Option<usize>, name: Range<usize> },
    /// The name of an attribute, or the place of one.
    AttributeName { element: usize, name: Range<usize> },
    /// The value of an attribute.
    AttributeValue { element: usize, attribute: usize, value: Range<usize> },
    /// Text in an element, or beside the root.
    Text { parent: Option<usize> },
    /// In a comment or the like.
    Opaque,
}

impl Tree {
    /// What stands at a byte.
    pub(crate) fn cursor(&self, text: &str, at: usize) -> Cursor {
        if self.opaque.iter().any(|part| part.start < at && at < part.end) {
            return Cursor::Opaque;
        }
        let here = self.innermost(at);
        if let Some(element) = here {
            let one = &self.elements[element];
            let is_inside = at < one.tag.end || (at == one.tag.end && !one.is_complete);
            if one.tag.start < at && is_inside {
                return self.in_tag(text, element, at);
            }
            if let Some(tag) = &one.end_tag
                && tag.start + 2 <= at
                && at <= tag::name(text.as_bytes(), tag.start + 2).end
            {
                let name = tag::name(text.as_bytes(), tag.start + 2);
                return Cursor::EndTag { element: Some(element), name };
            }
        }
        // An end tag without an element is no part of the tree.
        let start = text[..at].rfind(['<', '>']).filter(|&start| text[start..].starts_with("</"));
        if let Some(start) = start {
            let name = tag::name(text.as_bytes(), start + 2);
            if start + 2 <= at && at <= name.end {
                return Cursor::EndTag { element: here, name };
            }
        }
        Cursor::Text { parent: here }
    }

    fn in_tag(&self, text: &str, element: usize, at: usize) -> Cursor {
        let one = &self.elements[element];
        if at <= one.name.end {
            return Cursor::ElementName { parent: one.parent, element, name: one.name.clone() };
        }
        for (place, attribute) in one.attributes.iter().enumerate() {
            if attribute.name.start <= at && at <= attribute.name.end {
                return Cursor::AttributeName { element, name: attribute.name.clone() };
            }
            if let Some(value) = &attribute.value
                && value.start <= at
                && at <= value.end
            {
                return Cursor::AttributeValue { element, attribute: place, value: value.clone() };
            }
        }
        let is_name = text[..at].ends_with(|c: char| c.is_ascii_whitespace());
        // Between a quote and what follows, an attribute would need a blank first.
        if is_name { Cursor::AttributeName { element, name: at..at } } else { Cursor::Opaque }
    }
}
