//! The tree of a text, and the tokens that the text is cut into.

use std::sync::Arc;

use super::Element;
use super::attribute::RawAttribute;
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

/// The kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// A byte order mark at the start of the text.
    Mark,
    /// `<a ...>`
    StartTag,
    /// `<a .../>`
    EmptyTag,
    /// `</a>`
    EndTag,
    /// White space alone.
    Space,
    /// Character data that is more than white space.
    Text,
    /// `<![CDATA[...]]>`
    Section,
    /// `<!-- ... -->`
    Comment,
    /// `<?...?>`, the XML declaration included.
    Instruction,
    /// `<!DOCTYPE ...>`
    Doctype,
    /// Markup that is none: a `<` by itself, or an end tag that ends nothing.
    Error,
    /// Nothing, behind the last byte.
    End,
}

/// A token; it ends where the next one starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub(super) start: u32,
    pub(super) kind: TokenKind,
    /// Of a start tag: attributes may be missing, or may be meant otherwise. Of others: the meaning is unknown.
    pub(super) is_damaged: bool,
    /// Of a start tag: it has no `>`.
    pub(super) is_broken_off: bool,
    /// Of a start tag: the prefix of its name is bound to no namespace, or its name is none.
    pub(super) is_unnamed: bool,
}

impl Token {
    pub(super) fn new(start: u32, kind: TokenKind) -> Self {
        Self { start, kind, is_damaged: false, is_broken_off: false, is_unnamed: false }
    }
}

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
    /// Text other than white space is directly inside.
    pub(super) has_text: bool,
    /// The end tag was found, or none is needed.
    pub(super) is_closed: bool,
    /// Elements or texts directly inside may be missing, or may belong elsewhere.
    pub(super) is_content_damaged: bool,
    /// The meaning of the text directly inside is unknown.
    pub(super) is_text_unsure: bool,
}

impl Node {
    pub(super) fn name_span(&self) -> Span {
        Span::new(self.name, self.name + self.name_len)
    }
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
    /// By element and prefix.
    pub(super) declared: Vec<Declaration>,
}

/// A declaration of a namespace.
#[derive(Debug)]
pub(super) struct Declaration {
    pub(super) element: ElementId,
    /// Empty for the default namespace.
    pub(super) prefix: Box<str>,
    pub(super) namespace: u32,
}

impl Declaration {
    pub(super) fn key(&self) -> (ElementId, &str) {
        (self.element, &self.prefix)
    }
}

impl Document {
    /// The file it was read from.
    pub fn file(&self) -> FileId {
        self.file
    }

    /// The text it was read from.
    pub fn text(&self) -> &Arc<String> {
        &self.text
    }

    /// A stretch of it.
    #[inline]
    pub(crate) fn piece(&self, stretch: Span) -> &str {
        &self.text[stretch.start as usize..stretch.end as usize]
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
}
