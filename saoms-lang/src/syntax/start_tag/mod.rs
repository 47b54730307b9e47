//! Start tags and their attributes, however broken.

mod recovery;
mod value;

use quick_xml::parser::{ElementParser, Parser as _};

use super::attribute::{Ending, RawAttribute};
use super::characters::name_length;
use super::document::{NO_NAMESPACE, Token, TokenKind};
use super::fault::Input;
use super::lexer::Lexer;
use super::slips;
use crate::diagnostic::Diagnostic;
use crate::limits::TAG_END_SEARCHES;
use crate::source::Span;

/// A start tag that is being read.
struct Tag<'l, 'a> {
    lexer: &'l mut Lexer<'a>,
    input: Input<'a>,
    start: u32,
    name: Span,
    /// The first of its attributes.
    first: usize,
    at: u32,
    /// The next `<`, or the end of the text: the tag goes no further, unless a value does.
    limit: u32,
    /// The `>` of the tag, as far as quotes fit.
    close: Option<u32>,
    /// The first quote behind the last place that was looked at for text, or the limit.
    quote: u32,
    measures: u32,
    token: Token,
}

impl Lexer<'_> {
    /// Reads the start tag, or what looks like one, whose `<` is at `start`; gives where it ends.
    pub(super) fn start_tag(&mut self, start: u32) -> u32 {
        let input = self.input;
        let mut token = Token::new(start, TokenKind::StartTag);
        let mut from = start + 1;
        let length_at = |from: u32| name_length(&input.bytes()[from as usize..]) as u32;
        let mut end = from + length_at(from);
        if end == from {
            let behind = name_behind_blank(input, start);
            self.faults.add(|| slips::nameless(input, start, behind));
            let Some(behind) = behind else {
                // Of two `<` one is too many, and no text.
                let is_damaged = input.byte(start + 1) == Some(b'<');
                self.tokens.push(Token { is_damaged, ..Token::new(start, TokenKind::Error) });
                return start + 1;
            };
            from = behind;
            end = from + length_at(from);
        }
        let mut at = end;
        if let Some(fault) = slips::bad_name(input, from, end, "element") {
            // Behind a character that looks like a blank, an attribute begins.
            let is_attribute = input.byte(input.skip_space(end)) == Some(b'=');
            let odd = slips::odd_space(input.slice(from, end)).filter(|_| is_attribute);
            (token.is_damaged, token.is_unnamed) = (odd.is_none(), odd.is_none());
            if let Some((length, odd)) = odd.filter(|(length, _)| *length > 0) {
                end = from + length as u32;
                at = end + odd.len_utf8() as u32;
            }
            self.faults.add(|| fault);
        }
        let place = self.tokens.len();
        let first = self.attributes.len();
        let name = Span::new(from, end);
        self.push_element(token, name);
        let (limit, close, quote, measures) = (0, None, 0, 0);
        let mut tag = Tag { lexer: self, input, start, name, first, at, limit, close, quote, measures, token };
        let is_empty = tag.read();
        let (at, token) = (tag.at, tag.token);
        self.tokens[place] = if is_empty { Token { kind: TokenKind::EmptyTag, ..token } } else { token };
        at
    }
}

impl Tag<'_, '_> {
    fn fault(&mut self, make: impl FnOnce() -> Diagnostic) {
        self.lexer.faults.add(make);
    }

    /// Looks for the end of the tag from a place outside of values; quick-xml knows quotes.
    fn measure(&mut self) {
        self.measures += 1;
        self.quote = 0;
        if self.measures > TAG_END_SEARCHES {
            self.close = None;
            return;
        }
        let input = self.input;
        self.limit = input.find(b'<', self.at.max(self.start + 1)).unwrap_or(input.len());
        let rest = &input.bytes()[self.at as usize..self.limit as usize];
        self.close = ElementParser::default().feed(rest).map(|length| self.at + length as u32);
    }

    /// Reads all behind the name up to behind the `>`. Gives whether the tag ends with `/>`.
    fn read(&mut self) -> bool {
        let (input, name) = (self.input, self.name);
        self.measure();
        loop {
            let before = self.at;
            self.at = input.skip_space(before);
            let at = self.at;
            if self.close == Some(at) {
                self.at += 1;
                return false;
            }
            let byte = if at < self.limit { input.byte(at) } else { None };
            match byte {
                None => {
                    self.broken_off();
                    return false;
                }
                Some(b'/') if self.close == Some(at + 1) => {
                    self.at += 2;
                    return true;
                }
                Some(b'\\') if self.close == Some(at + 1) => {
                    self.fault(|| slips::backslash(input, at));
                    self.at += 2;
                    return true;
                }
                Some(b'>') => {
                    // Behind quotes that do not fit, the first `>` ends the tag.
                    self.close = Some(at);
                }
                Some(b'/') if input.byte(at + 1) == Some(b'>') => self.close = Some(at + 1),
                Some(b'/') if input.skip_space(at + 1) >= self.limit => self.at = self.limit,
                Some(_) if self.is_text(before, at) => {
                    self.token.is_broken_off = true;
                    self.at = before;
                    self.fault(|| slips::text_in_tag(input, name, before));
                    return false;
                }
                Some(byte) if name_length(&[byte]) == 1 => {
                    if before < at || self.missing_blank(at) {
                        self.attribute(at);
                    }
                }
                Some(byte) => self.misplaced(before, at, byte),
            }
            if self.at > self.limit {
                self.measure();
            }
        }
    }

    /// True if what is at `at`, and behind `before` without blanks, is the text of the element, because the `>` of the
    /// tag is missing: there is no quote up to the end tag. One word behind a blank may be an attribute that is being
    /// typed.
    fn is_text(&mut self, before: u32, at: u32) -> bool {
        let (input, limit) = (self.input, self.limit);
        let name = input.slice(self.name.start, self.name.end);
        let end_tag = &input.bytes()[limit as usize..];
        let is_before_end = end_tag.strip_prefix(b"</").is_some_and(|tag| tag.starts_with(name.as_bytes()));
        if self.close.is_some() || !is_before_end {
            return false;
        }
        if self.quote <= at {
            let rest = &input.bytes()[at as usize..limit as usize];
            self.quote = memchr::memchr2(b'"', b'\'', rest).map_or(limit, |length| at + length as u32);
        }
        let word = name_length(&input.bytes()[at as usize..limit as usize]) as u32;
        self.quote == limit && (before == at || input.skip_space(at + word) < limit)
    }

    /// Reads the attribute whose name starts at `start`.
    fn attribute(&mut self, start: u32) {
        let input = self.input;
        let name_len = name_length(&input.bytes()[start as usize..]) as u32;
        let name_end = start + name_len;
        let mut one = RawAttribute {
            start,
            name_len,
            value: Span::empty(name_end),
            namespace: NO_NAMESPACE,
            ending: Ending::Closed,
            is_unsure: false,
            is_duplicate: false,
            is_misnamed: false,
        };
        let equals = input.skip_space(name_end);
        let has_equals = input.byte(equals) == Some(b'=');
        let colon = if has_equals { None } else { slips::colon(input, start, name_end, equals) };
        let is_colon = colon.is_some();
        if let Some(fault) = colon {
            self.fault(|| fault);
            one.name_len -= 1;
        } else if let Some(fault) = slips::bad_name(input, start, name_end, "attribute") {
            self.fault(|| fault);
            one.is_misnamed = true;
            self.token.is_damaged = true;
        }
        let from = if has_equals { input.skip_space(equals + 1) } else { equals };
        let quote = input.byte(from).filter(|byte| matches!(byte, b'"' | b'\''));
        match quote {
            Some(quote) => {
                if !has_equals && !is_colon && !one.is_misnamed {
                    self.fault(|| slips::without_value(input, start, name_end, Some(equals)));
                }
                self.quoted_value(&mut one, from, quote);
            }
            None if !has_equals => {
                one.ending = Ending::Missing;
                self.at = name_end;
                self.token.is_damaged = true;
                // Of a tag that breaks off with the text, that is the fault.
                if !one.is_misnamed && (equals as usize) < input.text.len() {
                    self.fault(|| slips::without_value(input, start, name_end, None));
                }
            }
            None => self.unquoted_value(&mut one, equals, from),
        }
        self.token.is_damaged |= one.is_unsure;
        self.lexer.attributes.push(one);
    }
}

/// The place of the name behind `<` and white space, if an element probably begins there.
fn name_behind_blank(input: Input<'_>, start: u32) -> Option<u32> {
    let name = input.skip_space(start + 1);
    let length = name_length(&input.bytes()[name as usize..]) as u32;
    if name == start + 1 || length == 0 {
        return None;
    }
    let behind = input.skip_space(name + length);
    let rest = &input.text[behind as usize..];
    let is_tag = rest.starts_with('>') || rest.starts_with("/>") || starts_attribute(input, behind).is_some();
    is_tag.then_some(name)
}

/// The start of the value of an attribute, if at `at` there is a name, a `=` and a quote.
fn starts_attribute(input: Input<'_>, at: u32) -> Option<u32> {
    let length = name_length(&input.bytes()[at as usize..]) as u32;
    let equals = input.skip_space(at + length);
    if length == 0 || input.byte(equals) != Some(b'=') {
        return None;
    }
    let value = input.skip_space(equals + 1);
    matches!(input.byte(value), Some(b'"' | b'\'')).then_some(value)
}
