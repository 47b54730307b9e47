//! Views of attributes.

use std::borrow::Cow;

use super::document::Document;
use super::element::{part_span, split};
use super::value::{self, Place};
use crate::source::{Located, Location, Span, Text};

/// An attribute as written, declarations of namespaces included.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawAttribute {
    pub(super) start: u32,
    pub(super) name_len: u32,
    /// Without the quotes; empty, behind the name, where there is none.
    pub(super) value: Span,
    pub(super) namespace: u32,
    pub(super) ending: Ending,
    /// The meaning of the value, or of the name, is unknown.
    pub(super) is_unsure: bool,
    /// Another attribute of the name stands before it.
    pub(super) is_duplicate: bool,
    /// The name is none, or its prefix is bound to no namespace.
    pub(super) is_misnamed: bool,
}

/// The end of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    /// It has both quotes.
    Closed,
    /// It has no closing quote.
    Open,
    /// There is no value.
    Missing,
}

impl RawAttribute {
    pub(super) fn name_span(&self) -> Span {
        Span::new(self.start, self.start + self.name_len)
    }

    /// Behind the closing quote.
    pub(super) fn end(&self) -> u32 {
        self.value.end + u32::from(self.is_closed())
    }

    pub(super) fn is_closed(&self) -> bool {
        self.ending == Ending::Closed
    }

    /// True if the name is one, stands here for the first time, and has a value.
    pub(super) fn has_sure_name(&self) -> bool {
        self.ending != Ending::Missing && !self.is_misnamed && !self.is_duplicate
    }

    /// True if name and value are known, whatever faults there are.
    #[inline]
    pub(super) fn is_sure(&self) -> bool {
        self.has_sure_name() && !self.is_unsure
    }
}

/// An attribute of an element.
#[derive(Clone, Copy, Debug)]
pub struct Attribute<'a> {
    pub(super) document: &'a Document,
    pub(super) raw: &'a RawAttribute,
}

impl<'a> Attribute<'a> {
    /// The name as written, with its prefix.
    #[inline]
    pub fn name(self) -> &'a str {
        self.document.piece(self.name_span())
    }

    /// The name without its prefix.
    pub fn local_name(self) -> &'a str {
        split(self.name()).1
    }

    /// The prefix as written.
    pub fn prefix(self) -> Option<&'a str> {
        split(self.name()).0
    }

    /// The namespace; empty for none, as for every attribute without a prefix.
    pub fn namespace(self) -> &'a str {
        &self.document.namespaces[self.raw.namespace as usize]
    }

    /// The value: references resolved, each white space character a blank.
    pub fn value(self) -> Cow<'a, str> {
        value::meant(self.raw_value(), Place::Attribute)
    }

    /// The value as written.
    #[inline]
    pub fn raw_value(self) -> &'a str {
        self.document.piece(self.raw.value)
    }

    /// From the name to behind the closing quote.
    pub fn span(self) -> Span {
        Span::new(self.raw.start, self.raw.end())
    }

    /// The name.
    pub fn name_span(self) -> Span {
        self.raw.name_span()
    }

    /// The value, without its quotes; empty where there is none.
    pub fn value_span(self) -> Span {
        self.raw.value
    }

    /// True if there is a `=` behind the name.
    pub fn has_value(self) -> bool {
        self.raw.ending != Ending::Missing
    }

    /// True if the value has both quotes.
    pub fn is_closed(self) -> bool {
        self.raw.is_closed()
    }

    /// True if the name is one, stands here for the first time, and has a value, which may be doubtful.
    pub(crate) fn has_sure_name(self) -> bool {
        self.raw.has_sure_name()
    }

    /// True if name and value are known, whatever faults there are.
    #[inline]
    pub(super) fn is_sure(self) -> bool {
        self.raw.is_sure()
    }

    /// The place of the name.
    pub fn name_location(self) -> Location {
        self.name_span().in_file(self.document.file)
    }

    /// The place of the whole attribute.
    pub fn location(self) -> Location {
        self.span().in_file(self.document.file)
    }

    /// The value and where it is, white space at its ends left out.
    pub fn trimmed(self) -> Text {
        self.located(value::trim(self.raw_value()))
    }

    /// The words of a value that is a list, each with its own place. Blanks between `${` and `}` do not separate.
    pub fn words(self) -> impl Iterator<Item = Text> + use<'a> {
        let mut rest = self.raw_value();
        // Behind the last `}` no expression is closed.
        let closed = rest.rfind('}').map_or(rest.len(), |last| rest.len() - last);
        std::iter::from_fn(move || {
            rest = rest.trim_start_matches(value::is_space);
            let mut end = 0;
            while let Some(next) = rest[end..].chars().next().filter(|next| !value::is_space(*next)) {
                let is_open = rest.len() - end > closed;
                let inside = rest[end..].strip_prefix("${").filter(|_| is_open).and_then(|inside| inside.find('}'));
                end += inside.map_or(next.len_utf8(), |length| length + 3);
            }
            let word;
            (word, rest) = rest.split_at(end);
            (!word.is_empty()).then_some(word)
        })
        .map(move |word| self.located(word))
    }

    /// A part of the value as written, resolved.
    fn located(self, part: &str) -> Text {
        let span = part_span(self.raw.value.start, self.raw_value(), part);
        Located::new(value::meant(part, Place::Attribute).into(), span.in_file(self.document.file))
    }
}
