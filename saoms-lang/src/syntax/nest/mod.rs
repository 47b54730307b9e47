//! Nesting: which end tag belongs to which start tag.
//!
//! If all tags fit, one pass over the tokens is enough. If they do not, a second pass knows from the numbers of tags
//! which names lack end tags, and from the vocabulary of composites which elements cannot stand in which; so an element
//! that is never closed ends where it should have, and what follows it is read as what it is.

mod counts;
mod repair;
mod tags;

use counts::Counts;
use tags::{Named, is_holder, local};

use super::document::{NONE, Node};
use super::fault::Input;
use super::lexer::{Lexer, end_name};
use super::token::{BROKEN_OFF, CLOSED, DAMAGED_CONTENT, DAMAGED_TAG, HAS_TEXT, TokenKind, UNSURE_TEXT};
use super::value;
use crate::diagnostic::{codes, quoted};
use crate::source::Span;

/// The flags of start tags that are found here.
const FOUND_HERE: u8 = CLOSED | HAS_TEXT | DAMAGED_CONTENT | UNSURE_TEXT;

/// Finds the ends and the parents of all elements.
pub(super) fn nest(lexer: &mut Lexer<'_>) {
    let found = lexer.faults.len();
    if Nest::new(lexer).run().is_err() {
        lexer.faults.truncate(found);
        for token in lexer.tokens.iter_mut().filter(|token| token.is_start()) {
            token.flags &= !FOUND_HERE;
        }
        let mut nest = Nest::new(lexer);
        nest.counts = Some(nest.counted());
        let _ = nest.run();
    }
}

/// Tags that do not fit.
struct Mismatch;

struct Nest<'l, 'a> {
    input: Input<'a>,
    lexer: &'l mut Lexer<'a>,
    /// The tags that are still to come, in the second pass.
    counts: Option<Counts<'a>>,
    open: Vec<u32>,
    /// The number of elements so far.
    count: u32,
    has_second_root: bool,
    /// True if an element beside the root is called as the root is: it is another one.
    has_other_root: bool,
}

impl<'l, 'a> Nest<'l, 'a> {
    fn new(lexer: &'l mut Lexer<'a>) -> Self {
        let input = lexer.input;
        Self { input, lexer, counts: None, open: Vec::new(), count: 0, has_second_root: false, has_other_root: false }
    }

    /// Counts all tags.
    fn counted(&self) -> Counts<'a> {
        let mut counts = Counts::default();
        let elements = &self.lexer.elements;
        for one in elements.iter().filter(|one| self.token(one.token).kind == TokenKind::StartTag) {
            counts.add_start(self.name(one));
        }
        for token in self.lexer.tokens.iter().filter(|token| token.kind == TokenKind::EndTag) {
            counts.add_end(self.end_name(token.start));
        }
        counts
    }

    fn token(&self, at: u32) -> super::token::Token {
        self.lexer.tokens[at as usize]
    }

    fn span(&self, at: u32) -> Span {
        Span::new(self.token(at).start, self.token(at + 1).start)
    }

    fn node(&self, element: u32) -> &Node {
        &self.lexer.elements[element as usize]
    }

    fn name(&self, node: &Node) -> &'a str {
        self.input.slice(node.name, node.name + node.name_len)
    }

    fn end_name(&self, start: u32) -> &'a str {
        let (name, _) = end_name(self.input, start);
        self.input.slice(name.start, name.end)
    }

    fn named(&self, node: &Node) -> Named<'a> {
        let at = Span::new(node.name, node.name + node.name_len);
        Named { name: self.name(node), at, start_tag: self.span(node.token) }
    }

    fn flag(&mut self, element: u32, flags: u8) {
        let token = self.node(element).token as usize;
        self.lexer.tokens[token].flags |= flags;
    }

    fn run(&mut self) -> Result<(), Mismatch> {
        let mut next = 0;
        for at in 0..self.lexer.tokens.len() as u32 - 1 {
            let token = self.token(at);
            match token.kind {
                TokenKind::StartTag | TokenKind::EmptyTag => {
                    self.start_tag(at, next)?;
                    next += 1;
                }
                TokenKind::EndTag => self.end_tag(at)?,
                TokenKind::Text | TokenKind::Section | TokenKind::Error => self.text(at),
                _ => {}
            }
        }
        self.finish()
    }

    /// Opens the next element of the lexer, `next`, whose start tag is at the token `at`.
    fn start_tag(&mut self, at: u32, next: usize) -> Result<(), Mismatch> {
        let mut node = self.lexer.elements[next];
        let named = self.named(&node);
        let is_empty = self.token(at).kind == TokenKind::EmptyTag;
        let mut lacks_end = false;
        if self.counts.is_some() {
            let behind = self.lexer.elements.get(next + 1).map(|one| one.attributes);
            let has_none = node.attributes == behind.unwrap_or(self.lexer.attributes.len() as u32);
            let has_no_room = self.makes_room(at, named, has_none && !is_empty);
            if !is_empty {
                lacks_end = self.count_with(|counts| counts.missing_ends(named.name) > 0) == Some(true);
                self.count_with(|counts| counts.start(named.name));
            }
            if has_no_room {
                return Ok(());
            }
        }
        if self.open.is_empty() && self.count > 0 {
            self.second_root(named)?;
        }
        node.parent = self.open.last().copied().unwrap_or(NONE);
        node.end = at;
        let element = self.count;
        node.after = element + 1;
        self.lexer.elements[element as usize] = node;
        self.count += 1;
        let flags = self.token(at).flags;
        if flags & BROKEN_OFF != 0 {
            if self.counts.is_none() {
                return Err(Mismatch);
            }
            // Most elements that are being typed stand alone; those that hold others have end tags.
            if lacks_end && !is_holder(local(named.name)) {
                self.lexer.elements[element as usize].end = at + 1;
                return Ok(());
            }
        } else if is_empty {
            self.flag(element, CLOSED);
            return Ok(());
        }
        self.open.push(element);
        self.count_with(|counts| counts.open(named.name));
        Ok(())
    }

    fn count_with<T>(&mut self, with: impl FnOnce(&mut Counts<'a>) -> T) -> Option<T> {
        self.counts.as_mut().map(with)
    }

    fn end_tag(&mut self, at: u32) -> Result<(), Mismatch> {
        let start = self.token(at).start;
        if self.counts.is_none()
            && let Some(&top) = self.open.last()
        {
            let name = self.name(self.node(top)).as_bytes();
            let behind = &self.input.bytes()[start as usize + 2..];
            if behind.starts_with(name) && matches!(behind.get(name.len()), Some(b'>' | b' ' | b'\t' | b'\r' | b'\n')) {
                self.close(at, true);
                return Ok(());
            }
        }
        let found = self.end_name(start);
        if self.counts.is_none() {
            let is_top = self.open.last().is_some_and(|top| self.name(self.node(*top)) == found);
            if is_top {
                self.close(at, true);
                return Ok(());
            }
            return Err(Mismatch);
        }
        self.count_with(|counts| counts.end(found));
        match self.open.last() {
            None => {
                let end = self.span(at).end;
                self.lexer.faults.add(|| {
                    let message = format!("{} closes nothing: no element is open", quoted(&format!("</{found}>")));
                    self.input.fault(&codes::XML_TAG_MISMATCH, start, end, message)
                });
                self.lexer.tokens[at as usize].kind = TokenKind::Error;
            }
            // `</>` ends whatever is open.
            Some(top) if found.is_empty() || self.name(self.node(*top)) == found => self.close(at, true),
            Some(&top) => self.mismatch(at, found, top),
        }
        Ok(())
    }

    fn ignore(&mut self, at: u32, top: u32) {
        self.lexer.tokens[at as usize].kind = TokenKind::Error;
        self.flag(top, DAMAGED_CONTENT);
    }

    /// Closes the element that was opened last, at the token `at`: its end tag, or what is no longer in it.
    fn close(&mut self, at: u32, has_end_tag: bool) {
        let Some(element) = self.open.pop() else { return };
        let count = self.count;
        let node = &mut self.lexer.elements[element as usize];
        (node.end, node.after) = (at, count);
        let node = *node;
        let is_in_text = !has_end_tag && self.has_end_tag_in_text(at, &node);
        let damage = if is_in_text { DAMAGED_CONTENT | UNSURE_TEXT } else { DAMAGED_CONTENT };
        self.flag(element, if has_end_tag { CLOSED } else { damage });
        if let Some(counts) = &mut self.counts {
            counts.close(self.input.slice(node.name, node.name + node.name_len));
        }
    }

    /// True if the text before the token `at` ends with the end tag of an element but for its `<`.
    fn has_end_tag_in_text(&self, at: u32, node: &Node) -> bool {
        let span = self.span(at - 1);
        let text = self.input.slice(span.start, span.end).trim_end();
        let name = text.strip_suffix('>').and_then(|text| text.strip_suffix(self.name(node)));
        name.is_some_and(|text| text.ends_with('/'))
    }

    /// Text, a CDATA section, or an error.
    fn text(&mut self, at: u32) {
        let (span, token) = (self.span(at), self.token(at));
        let Some(&top) = self.open.last() else {
            let is_outside = self.count == 0 || !self.has_second_root;
            if is_outside && token.kind != TokenKind::Error {
                let written = self.input.slice(span.start, span.end);
                let text = value::trim(written);
                let start = span.start + (written.len() - written.trim_start_matches(value::is_space).len()) as u32;
                let place = Span::new(start, start + text.len() as u32);
                let root = (self.count > 0).then(|| self.named(self.node(0)));
                self.lexer.faults.add(|| tags::outside(self.input, place, root));
            }
            return;
        };
        let is_blank = token.kind == TokenKind::Section && {
            let written = self.input.slice(span.start, span.end);
            let inside = written.strip_prefix("<![CDATA[").unwrap_or_default();
            inside.strip_suffix("]]>").unwrap_or(inside).trim_matches(value::is_space).is_empty()
        };
        let is_markup = token.kind == TokenKind::Error && span.len() > 1;
        let text = if is_blank || is_markup { 0 } else { HAS_TEXT };
        let damage = if token.kind == TokenKind::Error { DAMAGED_CONTENT } else { 0 };
        self.flag(top, text | damage | token.flags & UNSURE_TEXT);
    }

    fn finish(&mut self) -> Result<(), Mismatch> {
        let end = self.lexer.tokens.len() as u32 - 1;
        if let Some(&top) = self.open.last() {
            if self.counts.is_none() {
                return Err(Mismatch);
            }
            let node = *self.node(top);
            // A tag of which nobody knows the end may have been meant as `/>`.
            let is_doubtful = self.token(node.token).flags & DAMAGED_TAG != 0 && top + 1 == self.count;
            if !is_doubtful && !self.lexer.is_cut_short && !self.has_second_root {
                let Named { name, at, .. } = self.named(&node);
                self.lexer.faults.add(|| {
                    let message = format!("{} is never closed", quoted(name));
                    self.input.ended(&codes::XML_UNCLOSED, at.start, at.end, message)
                });
            }
        }
        while !self.open.is_empty() {
            self.close(end, false);
        }
        self.lexer.elements.truncate(self.count as usize);
        let is_nothing = self.lexer.elements.len() == 1 && self.node(0).name_len == 0;
        if is_nothing && self.lexer.faults.len() == 0 {
            let at = self.input.len();
            self.lexer.faults.add(|| self.input.ended(&codes::XML_SYNTAX, at, at, "the file holds no element"));
        }
        Ok(())
    }
}
