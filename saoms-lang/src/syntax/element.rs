//! Views of elements.

use super::Attribute;
use super::document::{Declaration, Document, ElementId, NO_NAMESPACE, NONE, Node, Token, TokenKind, XMLNS};
use super::value;
use crate::source::{Location, Span};

/// An element of a document; as cheap to copy as a reference.
#[derive(Clone, Copy, Debug)]
pub struct Element<'a> {
    pub(super) document: &'a Document,
    pub(super) id: ElementId,
}

impl<'a> Element<'a> {
    #[inline]
    pub(super) fn node(self) -> &'a Node {
        &self.document.elements[self.id.0 as usize]
    }

    #[inline]
    fn start_tag(self) -> Token {
        self.document.tokens[self.node().token as usize]
    }

    fn with_id(self, id: u32) -> Self {
        Self { document: self.document, id: ElementId(id) }
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
        self.document.piece(self.name_span())
    }

    /// The name without its prefix.
    #[inline]
    pub fn local_name(self) -> &'a str {
        split(self.name()).1
    }

    /// The prefix as written.
    pub fn prefix(self) -> Option<&'a str> {
        split(self.name()).0
    }

    /// The namespace; empty for none.
    pub fn namespace(self) -> &'a str {
        &self.document.namespaces[self.node().namespace as usize]
    }

    /// True if both elements of one document are in one namespace.
    pub(crate) fn shares_namespace(self, other: Self) -> bool {
        self.node().namespace == other.node().namespace
    }

    /// From the `<` of the start tag to behind the `>` of the end tag.
    pub fn span(self) -> Span {
        let behind = self.node().end as usize + usize::from(self.is_closed());
        Span::new(self.start_tag().start, self.document.tokens[behind].start)
    }

    /// From the `<` to behind the `>` of the start tag.
    pub fn start_tag_span(self) -> Span {
        self.document.token_span(self.node().token)
    }

    /// The end tag; `None` where there is none, as for `<a/>`.
    pub fn end_tag_span(self) -> Option<Span> {
        (self.is_closed() && !self.is_empty()).then(|| self.document.token_span(self.node().end))
    }

    /// The name in the start tag.
    #[inline]
    pub fn name_span(self) -> Span {
        self.node().name_span()
    }

    /// The place of the name in the start tag.
    #[inline]
    pub fn name_location(self) -> Location {
        self.name_span().in_file(self.document.file)
    }

    /// From behind the start tag to before the end tag; empty, at the end, for `<a/>`.
    #[inline]
    pub fn content_span(self) -> Span {
        let start = self.start_tag_span().end;
        if self.is_empty() {
            Span::empty(start)
        } else {
            Span::new(start, self.document.tokens[self.node().end as usize].start)
        }
    }

    /// True if its end tag was found, or none is needed.
    #[inline]
    pub fn is_closed(self) -> bool {
        self.node().is_closed
    }

    /// True if the start tag ends with `>`.
    pub fn has_whole_start_tag(self) -> bool {
        !self.start_tag().is_broken_off
    }

    /// True if attributes, or what is directly inside, may be missing because of a fault of the text, or may be meant
    /// otherwise. That something is missing here says nothing.
    #[inline]
    pub fn is_damaged(self) -> bool {
        self.has_damaged_tag() || self.has_damaged_content()
    }

    /// True if attributes may be missing, or may be meant otherwise.
    pub fn has_damaged_tag(self) -> bool {
        self.start_tag().is_damaged
    }

    /// True if elements directly inside may be missing, or may belong elsewhere.
    pub fn has_damaged_content(self) -> bool {
        self.node().is_content_damaged || self.node().is_text_unsure
    }

    /// True if the name says nothing: it is none, or its prefix is bound to no namespace.
    pub fn is_unnamed(self) -> bool {
        self.start_tag().is_unnamed
    }

    /// The element it is in.
    pub fn parent(self) -> Option<Self> {
        let parent = self.node().parent;
        (parent != NONE).then(|| self.with_id(parent))
    }

    /// The elements directly inside, in order.
    #[inline]
    pub fn children(self) -> impl Iterator<Item = Self> + use<'a> {
        let end = self.node().after;
        let first = self.id.0 + 1;
        std::iter::successors((first < end).then(|| self.with_id(first)), move |child| {
            let next = child.node().after;
            (next < end).then(|| self.with_id(next))
        })
    }

    /// Itself and everything inside, in document order.
    pub fn descendants(self) -> impl Iterator<Item = Self> + use<'a> {
        (self.id.0..self.node().after).map(move |id| self.with_id(id))
    }

    /// All that is written in its start tag: attributes, declarations of namespaces, and what may be one of them.
    pub fn written_attributes(self) -> impl Iterator<Item = Attribute<'a>> + use<'a> {
        let Document { elements, attributes, .. } = self.document;
        let end = elements.get(self.id.0 as usize + 1).map_or(attributes.len(), |next| next.attributes as usize);
        let own = &attributes[self.node().attributes as usize..end];
        own.iter().map(move |raw| Attribute { document: self.document, raw })
    }

    /// Its attributes in order, without declarations of namespaces and without those whose name or value is unknown.
    pub fn attributes(self) -> impl Iterator<Item = Attribute<'a>> + use<'a> {
        self.written_attributes().filter(|one| one.raw.namespace != XMLNS && one.is_sure())
    }

    /// Its attributes whose names are known, and perhaps their values.
    pub(crate) fn named_attributes(self) -> impl Iterator<Item = Attribute<'a>> + use<'a> {
        self.written_attributes().filter(|one| one.raw.namespace != XMLNS && one.has_sure_name())
    }

    /// Its declarations of namespaces (`xmlns`, `xmlns:a`) in order.
    pub fn namespace_declarations(self) -> impl Iterator<Item = Attribute<'a>> + use<'a> {
        self.written_attributes().filter(|one| one.raw.namespace == XMLNS && one.is_sure())
    }

    /// The attribute of this name in no namespace.
    #[inline]
    pub fn attribute(self, name: &str) -> Option<Attribute<'a>> {
        let is_it = |one: &Attribute<'_>| one.raw.namespace == NO_NAMESPACE && one.raw.name_len as usize == name.len();
        self.written_attributes().find(|one| is_it(one) && one.is_sure() && one.name() == name)
    }

    /// The attribute of this name with a prefix of this namespace.
    pub fn attribute_in(self, namespace: &str, local_name: &str) -> Option<Attribute<'a>> {
        let mut prefixed = self.attributes().filter(|one| one.raw.namespace != NO_NAMESPACE);
        prefixed.find(|one| one.local_name() == local_name && one.namespace() == namespace)
    }

    /// The namespace that `prefix` is bound to here; "" asks for the default namespace. `None` when it is unbound.
    pub fn resolve_prefix(self, prefix: &str) -> Option<&'a str> {
        if prefix == "xml" {
            return Some(super::XML_NAMESPACE);
        }
        let Document { declared, namespaces, .. } = self.document;
        let found = std::iter::successors(Some(self), |element| element.parent())
            .find_map(|element| declared.binary_search_by_key(&(element.id, prefix), Declaration::key).ok())?;
        Some(&*namespaces[declared[found].namespace as usize]).filter(|uri| !uri.is_empty())
    }

    /// The name in the end tag; `None` where there is no end tag, as for `<a/>`.
    pub fn end_name_span(self) -> Option<Span> {
        let tag = self.end_tag_span()?;
        let name = &self.document.piece(tag)[2..];
        let start = tag.start + 2 + (name.len() - name.trim_start().len()) as u32;
        let length = name.trim_start().find(|c: char| c == '>' || value::is_space(c)).unwrap_or(name.len());
        Some(Span::new(start, start + length as u32))
    }

    /// True for `<a/>`.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.start_tag().kind == TokenKind::EmptyTag
    }
}

/// The place of `part` in `whole`, which starts at byte `start`.
pub(super) fn part_span(start: u32, whole: &str, part: &str) -> Span {
    let start = start + (part.as_ptr() as usize - whole.as_ptr() as usize) as u32;
    Span::new(start, start + part.len() as u32)
}

/// A name into its prefix and its local part.
pub(super) fn split(name: &str) -> (Option<&str>, &str) {
    match name.bytes().position(|byte| byte == b':') {
        Some(colon) => (Some(&name[..colon]), &name[colon + 1..]),
        None => (None, name),
    }
}
