//! The text of elements.

use std::borrow::Cow;

use super::Element;
use super::document::{Node, TokenKind};
use super::element::part_span;
use super::value::{self, Place};
use crate::source::{Located, Span, Text};

impl<'a> Element<'a> {
    /// True if text other than white space is directly inside.
    #[inline]
    pub fn has_text(self) -> bool {
        self.node().has_text
    }

    /// The tokens directly inside that are no tags.
    fn own_tokens(self) -> impl Iterator<Item = (TokenKind, Span)> + use<'a> {
        let document = self.document;
        let Node { token, end, .. } = *self.node();
        let mut children = self.children();
        let mut at = token + 1;
        std::iter::from_fn(move || {
            while at < end {
                let here = at;
                at += 1;
                let kind = document.tokens[here as usize].kind;
                match kind {
                    TokenKind::StartTag | TokenKind::EmptyTag => {
                        let child = children.next()?;
                        at = (child.node().end + u32::from(child.is_closed())).max(at);
                    }
                    _ => return Some((kind, document.token_span(here))),
                }
            }
            None
        })
    }

    /// The pieces of the text directly inside, each with what it means.
    fn pieces(self) -> impl Iterator<Item = (Span, Cow<'a, str>)> + use<'a> {
        self.own_tokens().filter_map(move |(kind, span)| {
            let written = self.document.piece(span);
            Some(match kind {
                TokenKind::Space | TokenKind::Text => (span, value::meant(written, Place::Content)),
                TokenKind::Section => {
                    let inside = value::section(written);
                    (part_span(span.start, written, inside), value::meant(inside, Place::Section))
                }
                TokenKind::Error if written == "<" => (span, Cow::Borrowed(written)),
                _ => return None,
            })
        })
    }

    /// The text directly inside, without that of inner elements: references resolved, line ends as LF.
    pub fn text(self) -> Cow<'a, str> {
        let mut text = Cow::Borrowed("");
        for (_, piece) in self.pieces() {
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
        let trimmed = |span: Span| {
            let written = self.document.piece(span);
            let text = value::trim(written);
            (!text.is_empty()).then(|| part_span(span.start, written, text))
        };
        let mut pieces = self.pieces().filter_map(|(span, _)| trimmed(span));
        let first = pieces.next()?;
        Some(Span::new(first.start, pieces.last().unwrap_or(first).end))
    }

    /// The text directly inside without white space at its ends, and where it is; `None` when there is none, or it is
    /// unknown.
    #[inline]
    pub fn trimmed_text(self) -> Option<Text> {
        if !self.has_text() || self.node().is_text_unsure {
            return None;
        }
        let location = self.text_span()?.in_file(self.document.file);
        Some(Located::new(value::trim(&self.text()).into(), location))
    }
}
