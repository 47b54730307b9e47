//! The arena.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use super::Element;
use crate::source::{FileId, Span};

/// An element of a [`Document`]; the numbers rise in document order, the root is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ElementId(pub u32);

impl ElementId {
    /// The root of every document.
    pub const ROOT: Self = Self(0);
}

/// No element; also no attribute.
pub(super) const NONE: u32 = u32::MAX;
/// The number of "no namespace" in [`Document::namespaces`].
pub(super) const NO_NAMESPACE: u32 = 0;
/// The number of the namespace of declarations.
pub(super) const XMLNS: u32 = 2;

/// 36 bytes: a file of nothing but `<a/>` costs nine times its size.
#[derive(Debug)]
pub(super) struct Node {
    /// At the `<` of the start tag.
    pub(super) start: u32,
    /// Behind the `>` of the end tag.
    pub(super) end: u32,
    /// Behind the `>` of the start tag.
    pub(super) tag_end: u32,
    /// Bytes of the name in the start tag, its prefix included.
    pub(super) name_len: u32,
    pub(super) namespace: u32,
    pub(super) parent: u32,
    pub(super) next: u32,
    /// The first of its attributes; they end where those of the next element begin.
    pub(super) attributes: u32,
    /// Whether text other than white space is directly inside.
    pub(super) has_text: bool,
    /// Whether its name has a prefix.
    pub(super) has_prefix: bool,
    /// Whether its end tag was read; only those around a fault are not.
    pub(super) is_closed: bool,
}

/// An attribute as written, declarations of namespaces included.
#[derive(Debug)]
pub(super) struct RawAttribute {
    pub(super) start: u32,
    pub(super) name_len: u32,
    /// Without the quotes.
    pub(super) value: Span,
    pub(super) namespace: u32,
}

/// A well-formed XML text with its elements.
#[derive(Debug)]
pub struct Document {
    pub(super) file: FileId,
    pub(super) text: Arc<String>,
    pub(super) nodes: Vec<Node>,
    pub(super) attributes: Vec<RawAttribute>,
    pub(super) namespaces: Vec<Box<str>>,
    pub(super) declared: Declared,
}

/// Attributes beyond which the declarations among them are found by their prefixes.
pub(super) const MANY_ATTRIBUTES: usize = 32;

/// By element and prefix, the places of declarations of namespaces among the attributes: of elements with many attributes, once
/// somebody asks.
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
    pub fn element(&self, id: ElementId) -> Element<'_> {
        Element::new(self, id)
    }

    /// All elements in document order.
    pub fn elements(&self) -> impl Iterator<Item = Element<'_>> {
        (0..self.nodes.len() as u32).map(|id| self.element(ElementId(id)))
    }

    /// The place of the declaration of a prefix among the attributes of an element with many of them.
    pub(super) fn declaration(&self, element: ElementId, prefix: &str) -> Option<usize> {
        let all = self.declared.0.get_or_init(|| {
            let many = self.elements().filter(|element| element.raw_attributes().len() > MANY_ATTRIBUTES);
            let declared = |element: Element<'_>| {
                element.declared_prefixes().map(|(prefix, at)| (prefix.into(), at)).collect()
            };
            many.map(|element| (element.id(), declared(element))).collect()
        });
        all.get(&element)?.get(prefix).copied()
    }

    /// The innermost element that byte `at` is in, the root for a place outside.
    pub fn element_at(&self, at: u32) -> Element<'_> {
        let started = self.nodes.partition_point(|node| node.start < at);
        let mut here = self.element(ElementId(started.saturating_sub(1) as u32));
        while at >= here.span().end
            && let Some(outer) = here.parent()
        {
            here = outer;
        }
        here
    }
}
