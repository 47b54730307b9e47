//! Start tags and their attributes, however broken.

use std::collections::HashMap;

use quick_xml::parser::{ElementParser, Parser as _};

use super::document::{NO_NAMESPACE, XMLNS};
use super::fault::Input;
use super::lexer::Lexer;
use super::names::{name_length, scan};
use super::token::{BROKEN_OFF, DAMAGED_TAG, PREFIXED, TokenKind, UNNAMED, UNSURE_TEXT};
use super::{quotes, reference, slips};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::limits::TAG_END_SEARCHES;
use crate::source::Span;

/// An element with more attributes than this has them compared through a map.
const FEW: usize = 16;
/// An attribute as written, declarations of namespaces included.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawAttribute {
    pub(super) start: u32,
    pub(super) name_len: u32,
    /// Without the quotes; empty, behind the name, where there is none.
    pub(super) value: Span,
    pub(super) namespace: u32,
    pub(super) flags: u8,
}

/// There is no value.
pub(super) const NO_VALUE: u8 = 1;
/// The value has no closing quote.
pub(super) const OPEN: u8 = 2;
/// Nobody knows what the value, or the name, means.
pub(super) const UNSURE: u8 = 4;
/// Another attribute of the name stands before it.
pub(super) const DUPLICATE: u8 = 8;
/// The name is none, or its prefix is bound to no namespace.
pub(super) const BAD_NAME: u8 = 16;

/// The namespace of an attribute with a prefix, until all declarations of its tag are known.
pub(super) const UNRESOLVED: u32 = u32::MAX;

impl RawAttribute {
    pub(super) fn name_span(&self) -> Span {
        Span::new(self.start, self.start + self.name_len)
    }

    /// Behind the closing quote.
    pub(super) fn end(&self) -> u32 {
        self.value.end + u32::from(self.flags & (NO_VALUE | OPEN) == 0)
    }
}

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
    flags: u8,
}

impl Lexer<'_> {
    /// Reads the start tag, or what looks like one, whose `<` is at `start`; gives where it ends.
    pub(super) fn start_tag(&mut self, start: u32) -> u32 {
        let input = self.input;
        let mut flags = 0;
        let mut from = start + 1;
        let mut name = scan(&input.bytes()[from as usize..]);
        if name.len == 0 {
            self.faults.add(|| slips::nameless(input, start));
            let Some(behind) = name_behind_blank(input, start) else {
                // Of two `<` one is too many, and no text.
                let is_doubled = input.byte(start + 1) == Some(b'<');
                self.push(start, TokenKind::Error, if is_doubled { UNSURE_TEXT } else { 0 });
                return start + 1;
            };
            from = behind;
            name = scan(&input.bytes()[from as usize..]);
        }
        let mut end = from + name.len;
        let mut at = end;
        if !name.is_plain {
            if let Some(fault) = slips::bad_name(input, from, end, "element") {
                // Behind a character that looks like a blank, an attribute begins.
                let odd = slips::odd_space(input.slice(from, end));
                flags |= if odd.is_some() { 0 } else { DAMAGED_TAG | UNNAMED };
                if let Some((length, odd)) = odd.filter(|(length, _)| *length > 0) {
                    end = from + length as u32;
                    at = end + odd.len_utf8() as u32;
                }
                self.faults.add(|| fault);
            }
            flags |= if input.slice(from, end).contains(':') { PREFIXED } else { 0 };
        }
        let token = self.tokens.len();
        let first = self.attributes.len();
        let name = Span::new(from, end);
        self.push_element(start, TokenKind::StartTag, 0, name);
        let (limit, close, quote, measures) = (0, None, 0, 0);
        let mut tag =
            Tag { lexer: self, input, start, name, first, at, limit, close, quote, measures, flags };
        let is_empty = tag.read();
        let (at, flags) = (tag.at, tag.flags);
        let one = &mut self.tokens[token];
        one.flags = flags;
        one.kind = if is_empty { TokenKind::EmptyTag } else { TokenKind::StartTag };
        self.check_unique(token, first);
        at
    }

    /// Finds attributes of one name. Two names of one namespace are for later, when prefixes are known.
    fn check_unique(&mut self, token: usize, first: usize) {
        let input = self.input;
        let name = |one: &RawAttribute| input.slice(one.start, one.start + one.name_len);
        let Self { attributes, faults, tokens, .. } = self;
        let attributes = &mut attributes[first..];
        if attributes.len() < 2 {
            return;
        }
        let mut seen: HashMap<&str, usize> = HashMap::new();
        for index in 1..attributes.len() {
            let one = &attributes[index];
            let before = if attributes.len() <= FEW {
                let same = |other: &RawAttribute| other.name_len == one.name_len && name(other) == name(one);
                attributes[..index].iter().position(same)
            } else {
                if index == 1 {
                    seen.insert(name(&attributes[0]), 0);
                }
                let before = seen.get(name(one)).copied();
                seen.entry(name(one)).or_insert(index);
                before
            };
            if let Some(before) = before {
                faults.add(|| slips::duplicate(input, &attributes[before], one, None));
                attributes[index].flags |= DUPLICATE;
                tokens[token].flags |= DAMAGED_TAG;
            }
        }
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
                Some(b'>') => {
                    // Behind quotes that do not fit, the first `>` ends the tag.
                    self.close = Some(at);
                }
                Some(b'/') if input.byte(at + 1) == Some(b'>') => self.close = Some(at + 1),
                Some(b'/') if input.skip_space(at + 1) >= self.limit => self.at = self.limit,
                Some(_) if self.is_text(before, at) => {
                    self.flags |= BROKEN_OFF;
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

    /// True if what is at `at`, and behind `before` without blanks, is the text of the element, because the `>` of the tag
    /// is missing: there is no quote up to the end tag. One word behind a blank may be an attribute that is being typed.
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

    /// The tag ends before the next one starts, or with the text.
    fn broken_off(&mut self) {
        let (input, name) = (self.input, self.name);
        self.at = self.limit;
        self.flags |= BROKEN_OFF | DAMAGED_TAG;
        let last = self.lexer.attributes[self.first..].last();
        let has_quote = |one: &RawAttribute| matches!(input.byte(one.value.start - 1), Some(b'"' | b'\''));
        let is_last = |one: &RawAttribute| input.skip_space(one.value.end) >= self.limit;
        if last.is_some_and(|last| last.flags & OPEN != 0 && has_quote(last) && is_last(last)) {
            // The value that is not closed is the fault.
            return;
        }
        let is_end = self.limit == input.len();
        if last.is_some_and(|last| last.flags & NO_VALUE != 0 && is_last(last)) && !is_end {
            return;
        }
        let shown = quoted(input.slice(name.start, name.end));
        let limit = self.limit;
        self.fault(|| {
            if is_end {
                let message = format!("the start tag of {shown} is never closed");
                return input.ended(&codes::XML_UNCLOSED, name.start, name.end, message);
            }
            let message = format!("the start tag of {shown} is not closed before the next `<`");
            input
                .fault(&codes::XML_UNCLOSED, limit, limit + 1, message)
                .label(name.in_file(input.file), "this tag is open")
                .help("close it with `>` or `/>`")
        });
    }

    /// Something stands at `at`, directly behind an attribute, where a blank is missing. Gives whether an attribute is to be read there.
    fn missing_blank(&mut self, at: u32) -> bool {
        if self.lexer.attributes.len() == self.first {
            return true;
        }
        if self.mend_last(at) || self.value_behind_quotes(at) {
            return false;
        }
        let input = self.input;
        self.fault(|| {
            let message = "white space is missing between two attributes";
            let location = Span::empty(at).in_file(input.file);
            let end = input.character_end(at);
            input.fault(&codes::XML_ATTRIBUTE, at, end, message).suggest("insert a blank", location, " ")
        });
        let is_attribute = starts_attribute(input, at).is_some();
        if !is_attribute {
            self.resume(at);
        }
        is_attribute
    }

    /// Finds out whether the value that ends before `at` should have ended before: what follows may be the rest of the next attribute.
    fn mend_last(&mut self, at: u32) -> bool {
        let input = self.input;
        let Some(last) = self.lexer.attributes[self.first..].last().copied() else { return false };
        if last.end() != at || last.flags & (NO_VALUE | OPEN) != 0 {
            return false;
        }
        let quote_at = last.value.start - 1;
        if let Some((one, end)) = quotes::closing(input, quote_at, at - 1) {
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
        let is_closed = last.end() == at && last.flags & (NO_VALUE | OPEN) == 0;
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
        if last.end() != at || !last.value.is_empty() || last.flags & (NO_VALUE | OPEN) != 0 {
            return false;
        }
        let Some(end) = slips::first_quote(input, at).filter(|end| input.byte(*end) == input.byte(at - 1))
        else {
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
            last.flags |= OPEN;
        }
    }

    /// A character that cannot start an attribute.
    fn misplaced(&mut self, before: u32, at: u32, byte: u8) {
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
                let tag = quoted(input.slice(name.start, name.end));
                let message = format!("{what} is misplaced in the start tag of {tag}");
                let one = input.fault(&codes::XML_SYNTAX, at, end, message);
                if is_separator {
                    let has_space = input.byte(end).is_some_and(|byte| byte.is_ascii_whitespace());
                    let place = Span::new(at, end).in_file(input.file);
                    let instead = if has_space { "" } else { " " };
                    return one.suggest(format!("remove {what}"), place, instead);
                }
                one.help("attributes are written `name=\"value\"`; the tag ends with `>` or `/>`")
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
    fn resume(&mut self, from: u32) {
        let input = self.input;
        self.flags |= DAMAGED_TAG;
        let bound = self.close.unwrap_or(self.limit).max(from);
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

    /// Reads the attribute whose name starts at `start`.
    fn attribute(&mut self, start: u32) {
        let input = self.input;
        let name = scan(&input.bytes()[start as usize..]);
        let name_end = start + name.len;
        let raw = &input.bytes()[start as usize..name_end as usize];
        let mut one = RawAttribute {
            start,
            name_len: name.len,
            value: Span::empty(name_end),
            namespace: NO_NAMESPACE,
            flags: 0,
        };
        let equals = input.skip_space(name_end);
        let has_equals = input.byte(equals) == Some(b'=');
        let colon = if has_equals { None } else { slips::colon(input, start, name_end, equals) };
        let is_colon = colon.is_some();
        if let Some(fault) = colon {
            self.fault(|| fault);
            one.name_len -= 1;
        } else if let Some(fault) =
            (!name.is_plain).then(|| slips::bad_name(input, start, name_end, "attribute")).flatten()
        {
            self.fault(|| fault);
            one.flags |= BAD_NAME;
            self.flags |= DAMAGED_TAG;
        }
        if raw.starts_with(b"xmlns") && matches!(raw.get(5), None | Some(b':')) {
            one.namespace = XMLNS;
            self.flags |= PREFIXED;
        } else if !name.is_plain && !is_colon && raw.contains(&b':') {
            one.namespace = UNRESOLVED;
            self.flags |= PREFIXED;
        }
        let from = if has_equals { input.skip_space(equals + 1) } else { equals };
        let quote = input.byte(from).filter(|byte| matches!(byte, b'"' | b'\''));
        match quote {
            Some(quote) => {
                if !has_equals && !is_colon && one.flags & BAD_NAME == 0 {
                    self.fault(|| slips::without_value(input, start, name_end, Some(equals)));
                }
                self.quoted_value(&mut one, from, quote);
            }
            None if !has_equals => {
                one.flags |= NO_VALUE;
                self.at = name_end;
                self.flags |= DAMAGED_TAG;
                // Of a tag that breaks off with the text, that is the fault.
                if one.flags & BAD_NAME == 0 && (equals as usize) < input.text.len() {
                    self.fault(|| slips::without_value(input, start, name_end, None));
                }
            }
            None => self.unquoted_value(&mut one, equals, from),
        }
        self.flags |= if one.flags & UNSURE == 0 { 0 } else { DAMAGED_TAG };
        self.lexer.attributes.push(one);
    }

    /// Reads a value up to its closing quote, or to where it probably ends.
    fn quoted_value(&mut self, one: &mut RawAttribute, quote_at: u32, quote: u8) {
        let input = self.input;
        let bytes = input.bytes();
        let mut at = quote_at + 1;
        loop {
            let Some(length) = memchr::memchr3(quote, b'<', b'&', &bytes[at as usize..]) else {
                self.fault(|| {
                    let name = quoted(input.slice(one.start, one.start + one.name_len));
                    let message = format!("the value of {name} is never closed");
                    input.ended(&codes::XML_UNCLOSED, quote_at, quote_at + 1, message)
                });
                return self.open_value(one, quote_at);
            };
            at += length as u32;
            match bytes[at as usize] {
                b'&' => match reference::check(input, at) {
                    Ok(end) => at = end,
                    Err(fault) => {
                        one.flags |= if fault.is_unknown() { UNSURE } else { 0 };
                        self.fault(|| fault.diagnostic(input));
                        at += 1;
                    }
                },
                b'<' => {
                    if let Some((curly, end)) = quotes::closing(input, quote_at, at) {
                        self.fault(|| curly);
                        one.value = Span::new(quote_at + 1, end.start);
                        one.flags |= OPEN;
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
        one.flags |= if is_sure { OPEN } else { OPEN | UNSURE };
        self.at = next;
        self.measure();
    }

    /// Reads a value that does not start with a quote, at `at`.
    fn unquoted_value(&mut self, one: &mut RawAttribute, equals: u32, at: u32) {
        let input = self.input;
        one.value = Span::empty(equals + 1);
        one.flags |= OPEN;
        self.at = at;
        if at == input.len() {
            return;
        }
        if let Some((fault, inside, end)) = quotes::around(input, at) {
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
        one.flags |= UNSURE;
        // `a= b="..."`: the value is missing.
        if length == 0 || at > equals + 1 && starts_attribute(input, at).is_some() {
            return;
        }
        one.value = Span::new(at, at + length);
        self.at = at + length;
        let rest = &input.text[self.at as usize..];
        if rest.starts_with([' ', '\t', '\r', '\n', '>']) || rest.starts_with("/>") {
            one.flags &= !UNSURE;
        } else {
            self.resume(self.at);
        }
    }
}

/// Where the name is behind `<` and white space, if an element probably begins there.
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

/// Where the value starts of an attribute, if at `at` there is a name, a `=` and a quote.
fn starts_attribute(input: Input<'_>, at: u32) -> Option<u32> {
    let length = name_length(&input.bytes()[at as usize..]) as u32;
    let equals = input.skip_space(at + length);
    if length == 0 || input.byte(equals) != Some(b'=') {
        return None;
    }
    let value = input.skip_space(equals + 1);
    matches!(input.byte(value), Some(b'"' | b'\'')).then_some(value)
}
