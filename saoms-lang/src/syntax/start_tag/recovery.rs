//! Recovery: the continuation behind a fault in a start tag.

use super::{Tag, starts_attribute};
use crate::diagnostic::{codes, quoted};
use crate::source::Span;
use crate::syntax::attribute::{Ending, RawAttribute};
use crate::syntax::characters::name_length;
use crate::syntax::slips;

impl Tag<'_, '_> {
    /// The tag ends before the next one starts, or with the text.
    pub(super) fn broken_off(&mut self) {
        let (input, name) = (self.input, self.name);
        self.at = self.limit;
        (self.token.is_broken_off, self.token.is_damaged) = (true, true);
        let last = self.lexer.attributes[self.first..].last();
        let has_quote = |one: &RawAttribute| matches!(input.byte(one.value.start - 1), Some(b'"' | b'\''));
        let is_last = |one: &RawAttribute| input.skip_space(one.value.end) >= self.limit;
        if last.is_some_and(|last| last.ending == Ending::Open && has_quote(last) && is_last(last)) {
            // The value that is not closed is the fault.
            return;
        }
        let is_end = self.limit == input.len();
        if last.is_some_and(|last| last.ending == Ending::Missing && is_last(last)) && !is_end {
            return;
        }
        let shown = quoted(input.piece(name));
        let limit = self.limit;
        self.fault(|| {
            if is_end {
                let message = format!("the start tag of {shown} has no `>`");
                return input.ended(&codes::XML_UNCLOSED, name.start, name.end, message);
            }
            let message = format!("the start tag of {shown} has no `>` before the next `<`");
            input
                .fault(&codes::XML_UNCLOSED, limit, limit + 1, message)
                .label(name.in_file(input.file), "the start tag")
                .help("close it with `>` or `/>`")
        });
    }

    /// Something stands at `at`, directly behind an attribute, where a blank is missing. Gives whether an attribute is
    /// to be read there.
    pub(super) fn missing_blank(&mut self, at: u32) -> bool {
        if self.lexer.attributes.len() == self.first {
            return true;
        }
        if self.mend_last(at) || self.value_behind_quotes(at) {
            return false;
        }
        let input = self.input;
        self.fault(|| {
            let message = "white space is missing between two attributes";
            let location = input.at(at, at);
            let end = input.character_end(at);
            input.fault(&codes::XML_ATTRIBUTE, at, end, message).suggest("insert a blank", location, " ")
        });
        let is_attribute = starts_attribute(input, at).is_some();
        if !is_attribute {
            self.resume(at);
        }
        is_attribute
    }

    /// Finds out whether the value that ends before `at` should have ended before: what follows may be the rest of the
    /// next attribute.
    fn mend_last(&mut self, at: u32) -> bool {
        let input = self.input;
        let Some(last) = self.lexer.attributes[self.first..].last().copied() else { return false };
        if last.end() != at || !last.is_closed() {
            return false;
        }
        let quote_at = last.value.start - 1;
        if let Some((one, end)) = slips::closing_quote(input, quote_at, at - 1) {
            self.fault(|| one);
            self.end_last(end.start);
            self.at = end.end;
        } else if let Some((one, end)) = slips::open_before(input, quote_at, at - 1) {
            self.fault(|| one);
            self.end_last(end);
            self.at = end;
        } else {
            return false;
        }
        self.measure();
        true
    }

    /// Reads the quote at `at`, directly behind a value, as the second of two where one is meant: `a="b""`.
    fn doubled_quote(&mut self, at: u32, quote: u8) -> bool {
        let input = self.input;
        let Some(last) = self.lexer.attributes[self.first..].last() else { return false };
        let is_closed = last.end() == at && last.is_closed();
        let is_end = matches!(input.byte(at + 1), Some(b' ' | b'\t' | b'\r' | b'\n' | b'/' | b'>'));
        if !is_closed || !is_end || input.byte(at - 1) != Some(quote) {
            return false;
        }
        self.fault(|| slips::doubled_quote(input, at));
        self.at = at + 1;
        self.measure();
        true
    }

    /// Reads what is behind an empty value, at `at`, as that value, where its first quote stands there twice: `a=""b"`.
    fn value_behind_quotes(&mut self, at: u32) -> bool {
        let input = self.input;
        let Some(last) = self.lexer.attributes[self.first..].last_mut() else { return false };
        if last.end() != at || !last.value.is_empty() || !last.is_closed() {
            return false;
        }
        let Some(end) = slips::first_quote(input, at).filter(|end| input.byte(*end) == input.byte(at - 1)) else {
            return false;
        };
        last.value = Span::new(at, end);
        self.fault(|| slips::doubled_quote(input, at - 1));
        self.at = end + 1;
        self.measure();
        true
    }

    fn end_last(&mut self, end: u32) {
        if let Some(last) = self.lexer.attributes.last_mut() {
            last.value.end = end;
            last.ending = Ending::Open;
        }
    }

    /// A character that cannot start an attribute.
    pub(super) fn misplaced(&mut self, before: u32, at: u32, byte: u8) {
        if before == at && matches!(byte, b'"' | b'\'') && self.mend_last(at) {
            return;
        }
        if before == at && self.doubled_quote(at, byte) {
            return;
        }
        let (input, name) = (self.input, self.name);
        let end = input.character_end(at);
        let is_separator = matches!(byte, b',' | b';');
        if byte >= b' ' {
            self.fault(|| {
                let what = input.shown(at);
                let tag = quoted(input.piece(name));
                let message = format!("{what} is misplaced in the start tag of {tag}");
                let one = input.fault(&codes::XML_SYNTAX, at, end, message);
                if is_separator {
                    let has_space = input.byte(end).is_some_and(|byte| byte.is_ascii_whitespace());
                    let instead = if has_space { "" } else { " " };
                    return one.mend(format!("remove {what}"), instead);
                }
                one.help("write attributes as `name=\"value\"`, and end the tag with `>` or `/>`")
            });
        }
        if is_separator || byte == b'&' {
            self.at = end;
            if input.byte(end).is_some_and(|next| name_length(&[next]) == 1) {
                self.resume(end);
            }
        } else {
            self.resume(end);
        }
    }

    /// Goes on at the next attribute that is surely one, or at the end of the tag.
    pub(super) fn resume(&mut self, from: u32) {
        let input = self.input;
        self.token.is_damaged = true;
        // A `>` inside a value does not end the tag.
        let bound = self.close.filter(|close| *close >= from).unwrap_or(self.limit).max(from);
        let mut at = from;
        while at < bound {
            let byte = input.bytes()[at as usize];
            let length = name_length(&input.bytes()[at as usize..bound as usize]) as u32;
            let is_behind_space = matches!(input.bytes()[at as usize - 1], b' ' | b'\t' | b'\r' | b'\n');
            if length > 0 && is_behind_space && starts_attribute(input, at).is_some() {
                break;
            }
            let is_end = byte == b'>' || byte == b'/' && at + 1 == bound;
            if is_end {
                break;
            }
            at += length.max(1);
        }
        self.at = at;
    }
}
