//! The tree of a text.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use super::Element;
use super::attribute::RawAttribute;
use super::token::{Token, TokenKind};
use crate::source::{FileId, Span};

/// An element of a [`Document`]; the numbers rise in document order, the root is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ElementId(pub u32);

impl ElementId {
    /// The root of every document.
    pub const ROOT: Self = Self(0);
}

/// No element.
pub(super) const NONE: u32 = u32::MAX;
/// The number of "no namespace" in [`Document::namespaces`].
pub(super) const NO_NAMESPACE: u32 = 0;
/// The number of the namespace of declarations.
pub(super) const XMLNS: u32 = 2;

/// An element, as it is stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Its start tag.
    pub(super) token: u32,
    /// Its end tag; its start tag for `<a/>`; the token before which it ends where there is no end tag.
    pub(super) end: u32,
    pub(super) parent: u32,
    /// The number of the element behind it and everything inside.
    pub(super) after: u32,
    /// The first of its attributes; those of the next element start where they end.
    pub(super) attributes: u32,
    pub(super) name: u32,
    pub(super) name_len: u32,
    pub(super) namespace: u32,
}

/// The tree of a text, whatever the text is. Of a text without any element, the root has no name.
#[derive(Debug)]
pub struct Document {
    pub(super) file: FileId,
    pub(super) text: Arc<String>,
    pub(super) tokens: Vec<Token>,
    pub(super) elements: Vec<Node>,
    pub(super) attributes: Vec<RawAttribute>,
    pub(super) namespaces: Vec<Box<str>>,
    pub(super) declared: Declared,
}

/// Attributes beyond which the declarations among them are found by their prefixes.
pub(super) const MANY_ATTRIBUTES: usize = 32;

/// The places of declarations of namespaces among the attributes, by element and prefix: of elements with many
/// attributes, once somebody asks.
#[derive(Debug, Default)]
pub(super) struct Declared(OnceLock<HashMap<ElementId, HashMap<Box<str>, usize>>>);

impl Document {
    /// The file it was read from.
    pub fn file(&self) -> FileId {
        self.file
    }

    /// The text it was read from.
    pub fn text(&self) -> &Arc<String> {
        &self.text
    }

    /// The tokens in order; they tile the text.
    pub fn tokens(&self) -> impl Iterator<Item = (TokenKind, Span)> {
        (0..self.tokens.len() - 1).map(|at| self.token(at))
    }

    /// The tokens of a stretch of the text.
    pub fn tokens_in(&self, stretch: Span) -> impl Iterator<Item = (TokenKind, Span)> {
        let first = self.tokens.partition_point(|token| token.start < stretch.start);
        let end = self.tokens.partition_point(|token| token.start < stretch.end);
        (first..end).map(|at| self.token(at))
    }

    /// The token that byte `at` is in; `None` behind the last byte.
    pub fn token_at(&self, at: u32) -> Option<(TokenKind, Span)> {
        let place = self.tokens.partition_point(|token| token.start <= at).checked_sub(1)?;
        (place + 1 < self.tokens.len()).then(|| self.token(place))
    }

    fn token(&self, at: usize) -> (TokenKind, Span) {
        (self.tokens[at].kind, self.token_span(at as u32))
    }

    #[inline]
    pub(super) fn token_span(&self, at: u32) -> Span {
        Span::new(self.tokens[at as usize].start, self.tokens[at as usize + 1].start)
    }

    /// All namespaces that are declared.
    pub(crate) fn namespaces(&self) -> impl Iterator<Item = &str> {
        self.namespaces.iter().map(AsRef::as_ref)
    }

    /// The one element that holds all others.
    pub fn root(&self) -> Element<'_> {
        self.element(ElementId::ROOT)
    }

    /// An element by its identifier.
    ///
    /// # Panics
    /// When the identifier is of another document.
    #[inline]
    pub fn element(&self, id: ElementId) -> Element<'_> {
        assert!((id.0 as usize) < self.elements.len(), "the element is of this document");
        Element { document: self, id }
    }

    /// All elements in document order.
    pub fn elements(&self) -> impl Iterator<Item = Element<'_>> {
        (0..self.elements.len() as u32).map(|id| Element { document: self, id: ElementId(id) })
    }

    /// The place of the declaration of a prefix among the attributes of an element with many of them.
    pub(super) fn declaration(&self, element: ElementId, prefix: &str) -> Option<usize> {
        let all = self.declared.0.get_or_init(|| {
            let many = self.elements().filter(|element| element.count_of_attributes() > MANY_ATTRIBUTES);
            let declared =
                |element: Element<'_>| element.declared_prefixes().map(|(prefix, at)| (prefix.into(), at)).collect();
            many.map(|element| (element.id(), declared(element))).collect()
        });
        all.get(&element)?.get(prefix).copied()
    }

    /// The innermost element that byte `at` is in, its tags included; right behind an element without an end is in it,
    /// too.
    pub fn innermost(&self, at: u32) -> Option<Element<'_>> {
        let started = self.elements.partition_point(|one| self.tokens[one.token as usize].start < at);
        let mut here = Some(self.element(ElementId(started.checked_sub(1)? as u32)));
        while let Some(element) = here {
            let end = element.span().end;
            if at < end || (at == end && !element.is_closed()) {
                break;
            }
            here = element.parent();
        }
        here
    }

    /// The same, or the root for a place outside.
    pub fn element_at(&self, at: u32) -> Element<'_> {
        self.innermost(at).unwrap_or_else(|| self.root())
    }
}
