//! Values of attributes, however broken.

use super::{Tag, starts_attribute};
use crate::diagnostic::{codes, quoted};
use crate::source::Span;
use crate::syntax::attribute::{Ending, RawAttribute};
use crate::syntax::slips;

impl Tag<'_, '_> {
    /// Reads a value up to its closing quote, or to where it probably ends.
    pub(super) fn quoted_value(&mut self, one: &mut RawAttribute, quote_at: u32, quote: u8) {
        let input = self.input;
        let bytes = input.bytes();
        let mut at = quote_at + 1;
        loop {
            let Some(length) = memchr::memchr3(quote, b'<', b'&', &bytes[at as usize..]) else {
                self.fault(|| {
                    let name = quoted(input.slice(one.start, one.start + one.name_len));
                    let message = format!("the value of {name} has no closing quote");
                    input.ended(&codes::XML_UNCLOSED, quote_at, quote_at + 1, message)
                });
                return self.open_value(one, quote_at);
            };
            at += length as u32;
            match bytes[at as usize] {
                b'&' => {
                    let (behind, is_sure) = self.lexer.reference(at);
                    one.is_unsure |= !is_sure;
                    at = behind;
                }
                b'<' => {
                    if let Some((curly, end)) = slips::closing_quote(input, quote_at, at) {
                        self.fault(|| curly);
                        one.value = Span::new(quote_at + 1, end.start);
                        one.ending = Ending::Open;
                        self.at = end.end;
                        return self.measure();
                    }
                    let name = input.slice(one.start, one.start + one.name_len);
                    self.fault(|| slips::open_value(input, name, quote_at, at));
                    match slips::closed_behind(input, quote_at, at) {
                        Some(end) => at = end,
                        None => return self.open_value(one, quote_at),
                    }
                }
                _ => {
                    one.value = Span::new(quote_at + 1, at);
                    self.at = at + 1;
                    return;
                }
            }
        }
    }

    /// Ends a value without a closing quote: before the `>` in its line, or with the line.
    fn open_value(&mut self, one: &mut RawAttribute, quote_at: u32) {
        let (end, next, is_sure) = slips::value_end(self.input, quote_at);
        one.value = Span::new(quote_at + 1, end);
        one.ending = Ending::Open;
        one.is_unsure |= !is_sure;
        self.at = next;
        self.measure();
    }

    /// Reads a value that does not start with a quote, at `at`.
    pub(super) fn unquoted_value(&mut self, one: &mut RawAttribute, equals: u32, at: u32) {
        let input = self.input;
        one.value = Span::empty(equals + 1);
        one.ending = Ending::Open;
        self.at = at;
        if at == input.len() {
            return;
        }
        if let Some((fault, inside, end)) = slips::curly_quotes(input, at) {
            self.fault(|| fault);
            one.value = inside;
            self.at = end;
            return self.measure();
        }
        if let Some(end) = slips::first_quote(input, at).filter(|end| *end > at) {
            self.fault(|| slips::without_first_quote(input, one, at, end));
            one.value = Span::new(at, end);
            self.at = end + 1;
            return self.measure();
        }
        let (fault, length) = slips::unquoted(input, one, at);
        self.fault(|| fault);
        one.is_unsure = true;
        // `a= b="..."`: the value is missing.
        if length == 0 || at > equals + 1 && starts_attribute(input, at).is_some() {
            return;
        }
        one.value = Span::new(at, at + length);
        self.at = at + length;
        let rest = &input.text[self.at as usize..];
        if rest.starts_with([' ', '\t', '\r', '\n', '>']) || rest.starts_with("/>") {
            one.is_unsure = false;
        } else {
            self.resume(self.at);
        }
    }
}
