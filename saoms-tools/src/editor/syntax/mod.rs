//! Questions of editors to the tree of a file: what stands at a byte, and where the parts of an element are written.

mod cursor;
mod kinds;
#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::Arc;

use saoms_lang::source::{FileId, Span};
use saoms_lang::syntax::{self, Attribute, Document, Element, TokenKind};

pub(crate) use cursor::Cursor;
pub(crate) use kinds::{kinds, version};

/// The tree of a text. It stands alone, so that the number of its file says nothing.
pub(crate) fn parse(text: &Arc<String>) -> Document {
    syntax::parse(FileId(0), text).document
}

/// The bytes of a span.
pub(crate) fn bytes(span: Span) -> Range<usize> {
    span.start as usize..span.end as usize
}

/// The root of a tree, whose text may have none.
pub(crate) fn root(document: &Document) -> Option<Element<'_>> {
    Some(document.root()).filter(|root| !root.start_tag_span().is_empty())
}

/// The place for a new declaration of a namespace in the root.
pub(crate) fn root_name_end(document: &Document) -> Option<usize> {
    root(document).map(|root| root.name_span().end as usize)
}

/// Places in an element.
pub(crate) trait Places<'t>: Copy {
    /// The element with its tags.
    fn whole(self) -> Range<usize>;
    /// The start tag.
    fn tag(self) -> Range<usize>;
    /// The value of an attribute, white space at its ends left out; `None` while there is no `=`.
    fn value(self, name: &str) -> Option<Range<usize>>;
    /// The text directly inside, without white space at its ends, of an element that holds text alone.
    fn text_place(self) -> Option<Range<usize>>;
    /// The prefix that is bound to a namespace; "" for the default namespace.
    fn prefix_of(self, namespace: &str) -> Option<&'t str>;
}

impl<'t> Places<'t> for Element<'t> {
    fn whole(self) -> Range<usize> {
        bytes(self.span())
    }

    fn tag(self) -> Range<usize> {
        bytes(self.start_tag_span())
    }

    fn value(self, name: &str) -> Option<Range<usize>> {
        let found = self.written_attributes().find(|one| one.name() == name);
        Some(trimmed(self.document().text(), value_of(found?)?))
    }

    fn text_place(self) -> Option<Range<usize>> {
        let content = self.content_span();
        let is_text = |(kind, _)| matches!(kind, TokenKind::Text | TokenKind::Space);
        let is_plain = self.has_whole_start_tag() && self.document().tokens_in(content).all(is_text);
        let inside = trimmed(self.document().text(), bytes(content));
        (is_plain && !inside.is_empty()).then_some(inside)
    }

    fn prefix_of(self, namespace: &str) -> Option<&'t str> {
        let mut around = std::iter::successors(Some(self), |one| one.parent());
        let found = around.find_map(|one| one.namespace_declarations().find(|one| one.value() == namespace));
        found.map(|one| one.prefix().map_or("", |_| one.local_name()))
    }
}

/// The value of an attribute without its quotes; `None` while there is no `=`.
pub(crate) fn value_of(attribute: Attribute<'_>) -> Option<Range<usize>> {
    attribute.has_value().then(|| bytes(attribute.value_span()))
}

/// True for a declaration of a namespace.
pub(crate) fn is_declaration(name: &str) -> bool {
    name == "xmlns" || name.starts_with("xmlns:")
}

/// True for what is neither a tag nor text: comments, instructions, CDATA sections and declarations.
pub(crate) fn is_opaque(kind: TokenKind) -> bool {
    use TokenKind::{Comment, Doctype, Instruction, Section};
    matches!(kind, Comment | Section | Instruction | Doctype)
}

/// A name without its prefix.
pub(crate) fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// The prefix of a name with its colon; empty for none.
pub(crate) fn prefix(name: &str) -> &str {
    &name[..name.len() - local(name).len()]
}

/// A range without the white space at its ends.
pub(crate) fn trimmed(text: &str, range: Range<usize>) -> Range<usize> {
    let part = &text[range.clone()];
    let start = range.start + part.len() - part.trim_start().len();
    start..start + part.trim().len()
}

/// The words of a range, each with its place.
pub(crate) fn words(text: &str, range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let part = &text[range.clone()];
    part.split_whitespace().map(move |word| {
        let start = range.start + (word.as_ptr() as usize - part.as_ptr() as usize);
        start..start + word.len()
    })
}
