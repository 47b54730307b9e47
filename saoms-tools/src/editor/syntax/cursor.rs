//! The part at a byte of a text.

use std::ops::Range;

use saoms_lang::syntax::{Attribute, Document, Element, TokenKind};

use super::{Places, bytes, is_opaque, value_of};

/// The part at a byte, and its element.
#[derive(Clone, Debug)]
pub(crate) enum Cursor<'t> {
    /// The name of an element; behind a `<` that nothing follows there is no element yet.
    ElementName { parent: Option<Element<'t>>, element: Option<Element<'t>>, name: Range<usize> },
    /// The name in an end tag; the element is the one that it should end.
    EndTag { element: Option<Element<'t>>, name: Range<usize> },
    /// The name of an attribute, or the place of one.
    AttributeName { element: Element<'t>, name: Range<usize> },
    /// The value of an attribute.
    AttributeValue { element: Element<'t>, attribute: Attribute<'t>, value: Range<usize> },
    /// Text in an element, or beside the root.
    Text { parent: Option<Element<'t>> },
    /// In a comment or the like.
    Opaque,
}

impl<'t> Cursor<'t> {
    /// The part at a byte of a tree.
    pub(crate) fn at(document: &'t Document, at: usize) -> Self {
        let text = document.text();
        let here = document.innermost(at as u32);
        let before = at.checked_sub(1).and_then(|before| document.token_at(before as u32));
        let Some((kind, token)) = before.map(|(kind, span)| (kind, bytes(span))) else {
            return Self::Text { parent: here };
        };
        if is_opaque(kind) && (at < token.end || !text[token.clone()].ends_with('>')) {
            return Self::Opaque;
        }
        if let Some(element) = here
            && element.tag() == token
            && (at < token.end || !element.has_whole_start_tag())
        {
            return Self::in_tag(element, at);
        }
        if kind == TokenKind::Error && text[token.clone()] == *"<" {
            return Self::ElementName { parent: here, element: None, name: at..at };
        }
        if text[token.clone()].starts_with("</") && token.start + 2 <= at {
            let element = document.innermost(token.start as u32 + 1);
            let name = token.start + 2..token.start + 2 + name_length(&text[token.start + 2..token.end]);
            if at <= name.end {
                return Self::EndTag { element, name };
            }
        }
        Self::Text { parent: here }
    }

    fn in_tag(element: Element<'t>, at: usize) -> Self {
        let name = bytes(element.name_span());
        if at <= name.end {
            if at < name.start {
                return Self::Opaque;
            }
            return Self::ElementName { parent: element.parent(), element: Some(element), name };
        }
        for attribute in element.written_attributes() {
            let name = bytes(attribute.name_span());
            if name.start <= at && at <= name.end {
                return Self::AttributeName { element, name };
            }
            if let Some(value) = value_of(attribute)
                && value.start <= at
                && at <= value.end
            {
                return Self::AttributeValue { element, attribute, value };
            }
        }
        // Between a quote and what follows, an attribute would need a blank first.
        let is_behind_blank = element.document().text()[..at].ends_with(|c: char| c.is_ascii_whitespace());
        if is_behind_blank { Self::AttributeName { element, name: at..at } } else { Self::Opaque }
    }
}

/// The length of the name that a text starts with.
fn name_length(text: &str) -> usize {
    text.find(|c: char| c.is_whitespace() || "<>/='\"&".contains(c)).unwrap_or(text.len())
}
