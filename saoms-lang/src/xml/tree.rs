//! The arena.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use super::Element;
use super::arena::{Alike, Arena};
use super::shape::Shapes;
use crate::source::{FileId, Span};

/// An element of a [`Document`]; the numbers rise in document order, the root is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ElementId(pub u32);

impl ElementId {
    /// The root of every document.
    pub const ROOT: Self = Self(0);

    /// The one so many behind it.
    #[inline]
    pub(crate) const fn further(self, by: u32) -> Self {
        Self(self.0 + by)
    }
}

/// No element; also no attribute.
pub(super) const NONE: u32 = u32::MAX;
/// The number of "no namespace" in [`Document::namespaces`].
pub(super) const NO_NAMESPACE: u32 = 0;
/// The number of the namespace of declarations.
pub(super) const XMLNS: u32 = 2;

/// A well-formed XML text with its elements.
#[derive(Debug)]
pub struct Document {
    pub(super) file: FileId,
    pub(super) text: Arc<String>,
    pub(super) arena: Arena,
    pub(super) shapes: Shapes,
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

    /// How many shapes of start tags there are.
    pub(crate) fn shapes(&self) -> usize {
        self.shapes.len()
    }

    /// Where the values of all attributes are from a place among them on.
    pub(crate) fn values_from(&self, first: u32) -> &[Span] {
        &self.arena.values[first as usize..]
    }

    /// Where the text of an element is among the values of the child of the root that it is in, in each of that form: for elements with a text
    /// and nothing else inside, by their place in that.
    pub(crate) fn text_in(&self, form: u32, element: u32) -> Option<u32> {
        self.arena.text(form, element)
    }

    /// Children of the root in order.
    pub(crate) fn alike(&self) -> &[Alike] {
        &self.arena.alike
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
        (0..self.arena.len()).map(|id| self.element(ElementId(id)))
    }

    /// The place of the declaration of a prefix among the attributes of an element with many of them.
    pub(super) fn declaration(&self, element: ElementId, prefix: &str) -> Option<usize> {
        let all = self.declared.0.get_or_init(|| {
            let many = self.elements().filter(|element| element.count_of_attributes() > MANY_ATTRIBUTES);
            let declared = |element: Element<'_>| {
                element.declared_prefixes().map(|(prefix, at)| (prefix.into(), at)).collect()
            };
            many.map(|element| (element.id(), declared(element))).collect()
        });
        all.get(&element)?.get(prefix).copied()
    }

    /// The innermost element that byte `at` is in, the root for a place outside.
    pub fn element_at(&self, at: u32) -> Element<'_> {
        let (mut started, mut end) = (0, self.arena.len());
        while started < end {
            let middle = started + (end - started) / 2;
            match self.element(ElementId(middle)).span().start < at {
                true => started = middle + 1,
                false => end = middle,
            }
        }
        let mut here = self.element(ElementId(started.saturating_sub(1)));
        while at >= here.span().end
            && let Some(outer) = here.parent()
        {
            here = outer;
        }
        here
    }
}
