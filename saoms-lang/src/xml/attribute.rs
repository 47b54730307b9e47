//! Views of attributes.

use std::borrow::Cow;

use super::element::{offset, slice, split};
use super::shape::Part;
use super::tree::Document;
use super::value;
use crate::source::{Located, Location, Span, Text};

/// An attribute of an element.
#[derive(Clone, Copy, Debug)]
pub struct Attribute<'a> {
    document: &'a Document,
    /// The shape of the tag that it is in, and its place among the attributes there.
    shape: u32,
    at: u32,
    /// Without the quotes.
    value: Span,
}

impl<'a> Attribute<'a> {
    /// The one whose value this is, by the shape of the tag that it is in and its place there.
    #[inline]
    pub(crate) fn of(document: &'a Document, (shape, at): (u32, u32), value: Span) -> Self {
        Self { document, shape, at, value }
    }

    /// What its shape says of it.
    #[inline]
    pub(super) fn part(self) -> &'a Part {
        &self.document.shapes.parts(self.shape)[self.at as usize]
    }

    /// The name as written, with its prefix.
    #[inline]
    pub fn name(self) -> &'a str {
        slice(self.document, self.name_span())
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
        &self.document.namespaces[self.part().namespace as usize]
    }

    /// The value: references resolved, each white space character a blank.
    pub fn value(self) -> Cow<'a, str> {
        value::attribute_value(self.raw_value())
    }

    /// The value as written.
    #[inline]
    pub fn raw_value(self) -> &'a str {
        slice(self.document, self.value)
    }

    /// From the name to behind the closing quote.
    pub fn span(self) -> Span {
        Span::new(self.name_span().start, self.value.end + 1)
    }

    /// The name.
    pub fn name_span(self) -> Span {
        let part = self.part();
        let start = self.value.start - part.name_back;
        Span::new(start, start + part.name_len)
    }

    /// The value, without its quotes.
    pub fn value_span(self) -> Span {
        self.value
    }

    /// Where the whole attribute is.
    pub fn location(self) -> Location {
        self.span().in_file(self.document.file)
    }

    /// The value, when it is a name as most are: not empty, and of ASCII without white space and `/`.
    #[inline]
    pub(crate) fn plain_name(self) -> Option<&'a str> {
        let name = self.raw_value();
        (!name.is_empty() && value::is_plain_name(name.as_bytes())).then_some(name)
    }

    /// A value that means itself, and where it is.
    #[inline]
    pub(crate) fn as_it_is(self, value: &str) -> Text {
        Located::new(value.into(), self.value_location())
    }

    /// Where the value is, without its quotes.
    #[inline]
    pub(crate) fn value_location(self) -> Location {
        self.value.in_file(self.document.file)
    }

    /// The value, when it is one word as most are, without white space or references.
    #[inline]
    pub(crate) fn plain_word(self) -> Option<&'a str> {
        let word = self.raw_value();
        (!word.is_empty() && value::is_plain(word.as_bytes())).then_some(word)
    }

    /// The same, and where it is.
    #[inline]
    pub(crate) fn only_word(self) -> Option<Text> {
        self.plain_word().map(|word| self.as_it_is(word))
    }

    /// The value and where it is, white space at its ends left out.
    pub fn trimmed(self) -> Text {
        // One look at the bytes of most values tells that they mean themselves.
        self.only_word().unwrap_or_else(|| self.located(value::trim(self.raw_value())))
    }

    /// The words of a value that is a list, each with its own place.
    pub fn words(self) -> impl Iterator<Item = Text> + use<'a> {
        self.raw_value()
            .split(value::is_space)
            .filter(|word| !word.is_empty())
            .map(move |word| self.located(word))
    }

    /// The same, where blanks between `${` and `}` do not separate.
    pub fn words_with_expressions(self) -> impl Iterator<Item = Text> + use<'a> {
        let mut rest = self.raw_value();
        std::iter::from_fn(move || {
            rest = rest.trim_start_matches(value::is_space);
            let mut end = 0;
            while let Some(next) = rest[end..].chars().next().filter(|next| !value::is_space(*next)) {
                let inside = rest[end..].strip_prefix("${").and_then(|inside| inside.find('}'));
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
        let whole = self.raw_value();
        let start = self.value.start + offset(whole, part);
        let span = Span::new(start, start + part.len() as u32);
        Located::new(value::attribute_value(part).into(), span.in_file(self.document.file))
    }
}
