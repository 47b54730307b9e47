//! Nesting: which end tag belongs to which start tag.
//!
//! If not all tags fit, it is known from the numbers of tags which names lack end tags, and from the vocabulary of
//! composites which elements cannot stand in which; so an element that is never closed ends where it should have, and
//! what follows it is read as what it is.

mod repair;
mod tags;

use std::collections::HashMap;

use tags::{Named, is_holder, local};

use super::document::{NONE, Node, Token, TokenKind};
use super::element::part_span;
use super::fault::Input;
use super::lexer::{Lexer, end_name};
use super::unseen::is_unseen;
use super::value;
use crate::diagnostic::{codes, quoted};
use crate::source::Span;

/// Greatest number of end tags that are proposed where a file ends too early.
const MAX_MISSING_TAGS: usize = 8;

/// Finds the ends and the parents of all elements.
pub(super) fn nest(lexer: &mut Lexer<'_>) {
    let input = lexer.input;
    let (counts, open) = (HashMap::new(), Vec::new());
    let mut nest = Nest { input, lexer, counts, open, count: 0, has_second_root: false, has_other_root: false };
    if !nest.fits() {
        nest.counts = nest.counted();
    }
    nest.run();
}

/// The tags of one name, from the place on that is looked at.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    /// Elements that are open.
    open: u32,
    /// Start tags that come, without those of empty elements.
    starts: u32,
    /// End tags that come.
    ends: u32,
}

impl Count {
    fn missing_ends(self) -> u32 {
        (self.open + self.starts).saturating_sub(self.ends)
    }
}

struct Nest<'l, 'a> {
    input: Input<'a>,
    lexer: &'l mut Lexer<'a>,
    /// The tags by name; empty where all fit.
    counts: HashMap<&'a str, Count>,
    open: Vec<u32>,
    /// The number of elements so far.
    count: u32,
    has_second_root: bool,
    /// True if an element beside the root is called as the root is: it is another one.
    has_other_root: bool,
}

impl<'a> Nest<'_, 'a> {
    /// True if there is one root, and each end tag is that of the element that was opened last.
    fn fits(&self) -> bool {
        let mut elements = self.lexer.elements.iter();
        let mut open = Vec::new();
        let is_fit = self.lexer.tokens.iter().all(|token| match token.kind {
            TokenKind::StartTag | TokenKind::EmptyTag => {
                let is_root = elements.len() == self.lexer.elements.len();
                let is_inside = !open.is_empty();
                let name = elements.next().map(|node| self.name(node));
                open.extend(name.filter(|_| token.kind == TokenKind::StartTag));
                !token.is_broken_off && (is_root || is_inside)
            }
            TokenKind::EndTag => open.pop() == Some(self.end_name(token.start)),
            _ => true,
        });
        is_fit && open.is_empty()
    }

    fn counted(&self) -> HashMap<&'a str, Count> {
        let mut counts: HashMap<&str, Count> = HashMap::new();
        for node in self.lexer.elements.iter().filter(|node| self.token(node.token).kind == TokenKind::StartTag) {
            counts.entry(self.name(node)).or_default().starts += 1;
        }
        for token in self.lexer.tokens.iter().filter(|token| token.kind == TokenKind::EndTag) {
            counts.entry(self.end_name(token.start)).or_default().ends += 1;
        }
        counts
    }

    fn count_of(&self, name: &str) -> Count {
        self.counts.get(name).copied().unwrap_or_default()
    }

    fn recount(&mut self, name: &'a str, change: impl FnOnce(&mut Count)) {
        if !self.counts.is_empty() {
            change(self.counts.entry(name).or_default());
        }
    }

    fn token(&self, at: u32) -> Token {
        self.lexer.tokens[at as usize]
    }

    fn span(&self, at: u32) -> Span {
        Span::new(self.token(at).start, self.token(at + 1).start)
    }

    fn node(&self, element: u32) -> &Node {
        &self.lexer.elements[element as usize]
    }

    fn name(&self, node: &Node) -> &'a str {
        self.input.piece(node.name_span())
    }

    fn end_name(&self, start: u32) -> &'a str {
        self.input.piece(end_name(self.input, start).0)
    }

    fn named(&self, node: &Node) -> Named<'a> {
        Named { name: self.name(node), at: node.name_span(), start_tag: self.span(node.token) }
    }

    fn node_mut(&mut self, element: u32) -> &mut Node {
        &mut self.lexer.elements[element as usize]
    }

    fn run(&mut self) {
        let mut next = 0;
        for at in 0..self.lexer.tokens.len() as u32 - 1 {
            match self.token(at).kind {
                TokenKind::StartTag | TokenKind::EmptyTag => {
                    self.start_tag(at, next);
                    next += 1;
                }
                TokenKind::EndTag => self.end_tag(at),
                TokenKind::Text | TokenKind::Section | TokenKind::Error => self.text(at),
                _ => {}
            }
        }
        self.finish();
    }

    /// Opens the next element of the lexer, `next`, whose start tag is at the token `at`.
    fn start_tag(&mut self, at: u32, next: usize) {
        let mut node = self.lexer.elements[next];
        let named = self.named(&node);
        let Token { kind, is_broken_off, .. } = self.token(at);
        let is_empty = kind == TokenKind::EmptyTag;
        let behind = self.lexer.elements.get(next + 1).map(|one| one.attributes);
        let has_none = node.attributes == behind.unwrap_or(self.lexer.attributes.len() as u32);
        let has_no_room = self.makes_room(at, named, has_none && !is_empty);
        let lacks_end = !is_empty && self.count_of(named.name).missing_ends() > 0;
        if !is_empty {
            self.recount(named.name, |count| count.starts = count.starts.saturating_sub(1));
        }
        if has_no_room {
            return;
        }
        if self.open.is_empty() && self.count > 0 {
            self.second_root(named);
        }
        node.parent = self.open.last().copied().unwrap_or(NONE);
        node.end = at;
        let element = self.count;
        node.after = element + 1;
        self.lexer.elements[element as usize] = node;
        self.count += 1;
        if is_broken_off {
            // Most elements that are being typed stand alone; those that hold others have end tags.
            if lacks_end && !is_holder(local(named.name)) {
                self.node_mut(element).end = at + 1;
                return;
            }
        } else if is_empty {
            self.node_mut(element).is_closed = true;
            return;
        }
        self.open_element(element);
    }

    fn open_element(&mut self, element: u32) {
        self.open.push(element);
        let name = self.name(self.node(element));
        self.recount(name, |count| count.open += 1);
    }

    fn end_tag(&mut self, at: u32) {
        let tag = self.span(at);
        let found = self.end_name(tag.start);
        self.recount(found, |count| count.ends = count.ends.saturating_sub(1));
        match self.open.last() {
            None => {
                self.lexer.faults.add(|| {
                    let message = format!("{} closes nothing: no element is open", quoted(&format!("</{found}>")));
                    self.input.fault(&codes::XML_TAG_MISMATCH, tag.start, tag.end, message)
                });
                self.lexer.tokens[at as usize].kind = TokenKind::Error;
            }
            // The file ends inside the tag, which is reported.
            Some(top) if self.is_cut(tag) && self.name(self.node(*top)).starts_with(found) => self.close(at, true),
            // `</>` ends whatever is open.
            Some(top) if found.is_empty() || is_same(self.name(self.node(*top)), found) => self.close(at, true),
            Some(&top) => self.mismatch(at, found, top),
        }
    }

    fn is_cut(&self, tag: Span) -> bool {
        tag.end == self.input.len() && !self.input.piece(tag).ends_with('>')
    }

    fn ignore(&mut self, at: u32, top: u32) {
        self.lexer.tokens[at as usize].kind = TokenKind::Error;
        self.node_mut(top).is_content_damaged = true;
    }

    /// Closes the element that was opened last, at the token `at`: its end tag, or what is no longer in it.
    fn close(&mut self, at: u32, has_end_tag: bool) {
        let Some(element) = self.open.pop() else { return };
        let count = self.count;
        let node = &mut self.lexer.elements[element as usize];
        (node.end, node.after) = (at, count);
        let node = *node;
        let is_in_text = !has_end_tag && self.has_end_tag_in_text(at, &node);
        let closed = self.node_mut(element);
        closed.is_closed |= has_end_tag;
        closed.is_content_damaged |= !has_end_tag;
        closed.is_text_unsure |= is_in_text;
        self.recount(self.input.piece(node.name_span()), |count| count.open = count.open.saturating_sub(1));
    }

    /// True if the text before the token `at` ends with the end tag of an element but for its `<`.
    fn has_end_tag_in_text(&self, at: u32, node: &Node) -> bool {
        let text = self.input.piece(self.span(at - 1)).trim_end();
        let name = text.strip_suffix('>').and_then(|text| text.strip_suffix(self.name(node)));
        name.is_some_and(|text| text.ends_with('/'))
    }

    /// Text, a CDATA section, or an error.
    fn text(&mut self, at: u32) {
        let (span, token) = (self.span(at), self.token(at));
        let written = self.input.piece(span);
        let Some(&top) = self.open.last() else {
            if !self.has_second_root && token.kind != TokenKind::Error {
                let text = value::trim(written);
                let place = part_span(span.start, written, text);
                let root = (self.count > 0).then(|| self.named(self.node(0)));
                self.lexer.faults.add(|| tags::outside(self.input, place, root));
            }
            return;
        };
        let is_blank = token.kind == TokenKind::Section && value::trim(value::section(written)).is_empty();
        let is_markup = token.kind == TokenKind::Error && span.len() > 1;
        let around = self.node_mut(top);
        around.has_text |= !is_blank && !is_markup;
        around.is_content_damaged |= token.kind == TokenKind::Error;
        around.is_text_unsure |= token.is_damaged;
    }

    fn finish(&mut self) {
        let end = self.lexer.tokens.len() as u32 - 1;
        if let Some(&top) = self.open.last() {
            let node = *self.node(top);
            // A tag with an unknown end may have been meant as `/>`.
            let is_doubtful = self.token(node.token).is_damaged && top + 1 == self.count;
            let is_cut = self.lexer.is_cut_short || self.lexer.faults.says_cut(self.input.len());
            if !is_doubtful && !is_cut && !self.has_second_root {
                let open = self.named(&node);
                let all: Vec<_> = self.open.iter().rev().map(|open| self.named(self.node(*open)).name).collect();
                self.lexer.faults.add(|| {
                    let message = tags::without_end_tag(self.input, open);
                    let one = self.input.ended(&codes::XML_UNCLOSED, open.at.start, open.at.end, message);
                    if all.len() > MAX_MISSING_TAGS {
                        return one;
                    }
                    let length = self.input.len();
                    let tags: Vec<String> = all.iter().map(|name| format!("</{name}>")).collect();
                    let end = self.input.at(length, length);
                    let break_before = if self.input.text.ends_with('\n') { "" } else { "\n" };
                    let message = format!("add {} at the end", quoted(&tags.concat()));
                    one.suggest(message, end, format!("{break_before}{}\n", tags.join("\n")))
                });
            }
        }
        // A root that was opened again had its end tag.
        let is_whole = self.has_second_root && self.lexer.elements.first().is_some_and(|root| !root.is_content_damaged);
        while !self.open.is_empty() {
            self.close(end, false);
        }
        if is_whole {
            self.node_mut(0).is_content_damaged = false;
        }
        self.lexer.elements.truncate(self.count as usize);
        let is_nothing = self.lexer.elements.len() == 1 && self.node(0).name_len == 0;
        if is_nothing && self.lexer.faults.is_empty() {
            let at = self.input.len();
            self.lexer.faults.add(|| self.input.ended(&codes::XML_SYNTAX, at, at, "the file contains no element"));
        }
    }
}

/// True if a name is the other one, but for what nobody sees in it, which is reported.
fn is_same(name: &str, other: &str) -> bool {
    let seen = |sign: &char| !is_unseen(*sign) && !sign.is_whitespace();
    name == other || !name.is_ascii() && name.chars().filter(seen).eq(other.chars())
}
