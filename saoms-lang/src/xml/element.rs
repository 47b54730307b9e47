//! Views of elements.

use std::borrow::Cow;

use super::Attribute;
use super::arena::{Place, Seen};
use super::shape::Shape;
use super::tree::{Document, ElementId, MANY_ATTRIBUTES, NO_NAMESPACE, NONE, XMLNS};
use super::value;
use crate::source::{Located, Location, Span, Text};

/// An element of a document; as cheap to copy as a reference.
#[derive(Clone, Copy, Debug)]
pub struct Element<'a> {
    document: &'a Document,
    id: ElementId,
    place: Place,
}

impl<'a> Element<'a> {
    #[inline]
    pub(super) fn new(document: &'a Document, id: ElementId) -> Self {
        assert!(id.0 < document.arena.len(), "the element is of this document");
        Self { document, id, place: document.arena.place(id.0) }
    }

    #[inline]
    fn node(self) -> Seen<'a> {
        self.document.arena.get(self.id.0, self.place)
    }

    #[inline]
    fn tag(self) -> &'a Shape {
        self.document.shapes.get(self.node().shape())
    }

    /// Another element of this one, or one that this one is in.
    #[inline]
    fn near(self, id: u32) -> Self {
        let Self { document, id: ElementId(own), place } = self;
        match (own, id) {
            (0, _) => Self::new(document, ElementId(id)),
            (_, 0) => Self { document, id: ElementId::ROOT, place: Place::ROOT },
            _ => Self { document, id: ElementId(id), place: place.moved(id.wrapping_sub(own)) },
        }
    }

    /// The one behind it.
    #[inline]
    fn sibling(self, id: u32) -> Self {
        let Self { document, place, .. } = self;
        match self.node().parent() {
            0 => Self { document, id: ElementId(id), place: document.arena.place_behind(id, place) },
            _ => self.near(id),
        }
    }

    /// Its identifier in its document.
    #[inline]
    pub fn id(self) -> ElementId {
        self.id
    }

    /// The document.
    #[inline]
    pub fn document(self) -> &'a Document {
        self.document
    }

    /// The name as written, with its prefix.
    #[inline]
    pub fn name(self) -> &'a str {
        slice(self.document, self.name_span())
    }

    /// The name without its prefix.
    #[inline]
    pub fn local_name(self) -> &'a str {
        if self.tag().has_prefix { split(self.name()).1 } else { self.name() }
    }

    /// The prefix as written.
    pub fn prefix(self) -> Option<&'a str> {
        split(self.name()).0
    }

    /// The namespace; empty for none.
    pub fn namespace(self) -> &'a str {
        &self.document.namespaces[self.tag().namespace as usize]
    }

    /// Whether two elements of one document are in the same namespace.
    #[inline]
    pub(crate) fn shares_namespace(self, other: Self) -> bool {
        self.tag().namespace == other.tag().namespace
    }

    /// From the `<` of the start tag to behind the `>` of the end tag.
    pub fn span(self) -> Span {
        Span::new(self.node().start(), self.node().end())
    }

    /// From the `<` to behind the `>` of the start tag.
    pub fn start_tag_span(self) -> Span {
        Span::new(self.node().start(), self.node().tag_end())
    }

    /// The name in the start tag.
    #[inline]
    pub fn name_span(self) -> Span {
        let start = self.node().start() + 1;
        Span::new(start, start + self.tag().name_len)
    }

    /// Where the name in the start tag is.
    #[inline]
    pub fn name_location(self) -> Location {
        self.name_span().in_file(self.document.file)
    }

    /// From behind the start tag to before the end tag; empty, at the end, for `<a/>`.
    #[inline]
    pub fn content_span(self) -> Span {
        let (tag_end, end) = (self.node().tag_end(), self.node().end());
        if tag_end == end || !self.is_closed() {
            return Span::new(tag_end, end);
        }
        // Most end tags have no white space before their `>`.
        let usual = end - self.tag().name_len - 3;
        if usual >= tag_end && self.document.text.as_bytes()[usual as usize] == b'<' {
            return Span::new(tag_end, usual);
        }
        // An end tag holds no `<` but its first character.
        let content = &self.document.text.as_bytes()[tag_end as usize..end as usize];
        let length = content.iter().rposition(|&byte| byte == b'<').unwrap_or(content.len());
        Span::new(tag_end, tag_end + length as u32)
    }

    /// Whether it was read to its end; only those that were open at a fault were not.
    #[inline]
    pub fn is_closed(self) -> bool {
        self.node().is_closed()
    }

    /// The element it is in.
    pub fn parent(self) -> Option<Self> {
        let parent = self.node().parent();
        (parent != NONE).then(|| self.near(parent))
    }

    /// The elements directly inside, in order.
    #[inline]
    pub fn children(self) -> impl Iterator<Item = Self> + use<'a> {
        let end = self.node().after();
        let first = self.id.0 + 1;
        std::iter::successors((first < end).then(|| self.near(first)), move |child| {
            let next = child.node().after();
            (next < end).then(|| child.sibling(next))
        })
    }

    /// Itself and everything inside, in document order.
    pub fn descendants(self) -> impl Iterator<Item = Self> + use<'a> {
        (self.id.0..self.node().after()).map(move |id| self.near(id))
    }

    /// The one of its [`descendants`](Self::descendants) at a place among them.
    #[inline]
    pub(crate) fn inner(self, place: u32) -> Self {
        self.near(self.id.0 + place)
    }

    /// A number that elements have in common whose start tags are the same but for the values, white space and the namespaces included.
    #[inline]
    pub(crate) fn shape(self) -> usize {
        self.node().shape() as usize
    }

    /// How many values of attributes there are from the start of another element, which starts before it, to its own.
    pub(crate) fn values_behind(self, other: Self) -> u32 {
        self.node().values() - other.node().values()
    }

    pub(super) fn count_of_attributes(self) -> usize {
        self.document.shapes.parts(self.node().shape()).len()
    }

    /// Whether it has neither attributes nor anything inside.
    pub(crate) fn is_bare(self) -> bool {
        self.count_of_attributes() == 0 && self.content_span().is_empty()
    }

    /// The attribute at a place among all that are written.
    ///
    /// # Panics
    /// When there are not as many.
    #[inline]
    pub(crate) fn nth_attribute(self, at: usize) -> Attribute<'a> {
        let node = self.node();
        // As many as its shape has attributes stand there.
        let value = self.document.arena.values[node.values() as usize + at];
        Attribute::of(self.document, (node.shape(), at as u32), value)
    }

    /// The place of the first of its values among those of the document.
    pub(crate) fn first_value(self) -> u32 {
        self.node().values()
    }

    /// Where the values of all attributes are from its own on, those of inner elements and of all behind it included.
    pub(crate) fn values(self) -> &'a [Span] {
        self.document.values_from(self.first_value())
    }

    /// Its attributes and its declarations of namespaces, in the order in which they are written.
    pub fn written_attributes(self) -> impl Iterator<Item = Attribute<'a>> + use<'a> {
        (0..self.count_of_attributes()).map(move |at| self.nth_attribute(at))
    }

    /// Its attributes in order, without declarations of namespaces.
    pub fn attributes(self) -> impl Iterator<Item = Attribute<'a>> + use<'a> {
        self.written_attributes().filter(|one| one.part().namespace != XMLNS)
    }

    /// Its declarations of namespaces (`xmlns`, `xmlns:a`) in order.
    pub fn namespace_declarations(self) -> impl Iterator<Item = Attribute<'a>> + use<'a> {
        self.written_attributes().filter(|one| one.part().namespace == XMLNS)
    }

    /// The attribute of this name in no namespace.
    #[inline]
    pub fn attribute(self, name: &str) -> Option<Attribute<'a>> {
        self.attributes().find(|one| one.part().namespace == NO_NAMESPACE && one.name() == name)
    }

    /// The attribute of this name in this namespace.
    pub fn attribute_in(self, namespace: &str, local_name: &str) -> Option<Attribute<'a>> {
        self.attributes().find(|one| one.local_name() == local_name && one.namespace() == namespace)
    }

    /// The namespace that `prefix` is bound to here; "" asks for the default namespace. `None` when it is unbound.
    pub fn resolve_prefix(self, prefix: &str) -> Option<Cow<'a, str>> {
        if prefix == "xml" {
            return Some(Cow::Borrowed(super::XML_NAMESPACE));
        }
        let mut here = Some(self);
        while let Some(element) = here {
            let found = match element.count_of_attributes() > MANY_ATTRIBUTES {
                true => self.document.declaration(element.id, prefix),
                false => element.declared_prefixes().find(|(known, _)| **known == *prefix).map(|(_, at)| at),
            };
            if let Some(at) = found {
                return Some(element.nth_attribute(at).value()).filter(|uri| !uri.is_empty());
            }
            here = element.parent();
        }
        None
    }

    /// The prefixes that it declares, "" for the default namespace, each with the place of its declaration among the attributes.
    pub(super) fn declared_prefixes(self) -> impl Iterator<Item = (&'a str, usize)> {
        let all = self.written_attributes().enumerate().filter(|(_, one)| one.part().namespace == XMLNS);
        all.map(move |(at, one)| {
            let (before, local) = split(one.name());
            (before.map_or("", |_| local), at)
        })
    }

    /// The name in the end tag; `None` for `<a/>` and where the end tag was not read.
    pub fn end_name_span(self) -> Option<Span> {
        let start = self.content_span().end + 2;
        (!self.is_empty() && self.is_closed()).then(|| Span::new(start, start + self.tag().name_len))
    }

    /// Whether there is nothing between its tags, or no end tag as in `<a/>`.
    #[inline]
    pub(crate) fn is_empty(self) -> bool {
        self.node().tag_end() == self.node().end() && self.is_closed()
    }

    /// Whether text other than white space is directly inside.
    #[inline]
    pub fn has_text(self) -> bool {
        self.node().has_text()
    }

    /// The stretches of its content that hold text, comments and instructions but no elements.
    fn stretches(self) -> impl Iterator<Item = Span> + use<'a> {
        let content = self.content_span();
        let mut start = Some(content.start);
        let mut children = self.children();
        std::iter::from_fn(move || {
            let from = start?;
            let child = children.next();
            start = child.map(|child| child.span().end);
            Some(Span::new(from, child.map_or(content.end, |child| child.span().start)))
        })
        .filter(|stretch| !stretch.is_empty())
    }

    /// The text directly inside, without that of inner elements: references resolved, line ends as LF.
    pub fn text(self) -> Cow<'a, str> {
        let mut text = Cow::Borrowed("");
        for stretch in self.stretches() {
            let piece = value::character_data(slice(self.document, stretch));
            if text.is_empty() {
                text = piece;
            } else {
                text.to_mut().push_str(&piece);
            }
        }
        text
    }

    /// From the first to behind the last character of the text directly inside, white space at both ends not
    /// counted; `None` when there is nothing but white space.
    #[inline]
    pub fn text_span(self) -> Option<Span> {
        if !self.has_text() {
            return None;
        }
        let pieces = || {
            self.stretches().flat_map(|stretch| {
                value::text_pieces(slice(self.document, stretch))
                    .map(move |piece| Span::new(stretch.start + piece.start, stretch.start + piece.end))
            })
        };
        Some(Span::new(pieces().next()?.start, pieces().last()?.end))
    }

    /// The text directly inside without white space at its ends, and where it is; `None` when there is none.
    #[inline]
    pub fn trimmed_text(self) -> Option<Text> {
        if !self.has_text() {
            return None;
        }
        let content = self.content_span();
        let whole = slice(self.document, content);
        let (text, span) = if value::is_literal(whole) {
            let text = value::trim(whole);
            let start = content.start + offset(whole, text);
            (text.into(), Span::new(start, start + text.len() as u32))
        } else {
            (value::trim(&self.text()).into(), self.text_span()?)
        };
        Some(Located::new(text, span.in_file(self.document.file)))
    }
}

pub(super) fn slice(document: &Document, span: Span) -> &str {
    &document.text[span.start as usize..span.end as usize]
}

/// Where in `whole` its part `part` starts.
pub(super) fn offset(whole: &str, part: &str) -> u32 {
    (part.as_ptr() as usize - whole.as_ptr() as usize) as u32
}

/// A name into its prefix and its local part.
pub(super) fn split(name: &str) -> (Option<&str>, &str) {
    name.split_once(':').map_or((None, name), |(prefix, local)| (Some(prefix), local))
}
