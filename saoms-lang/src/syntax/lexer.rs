//! The lexer: cuts a text into tokens.

use quick_xml::Reader;
use quick_xml::events::Event;

use super::attribute::RawAttribute;
use super::characters::name_length;
use super::document::{NONE, Node, Token, TokenKind};
use super::fault::{Faults, Input};
use super::{prolog, slips, value};
use crate::diagnostic::codes;
use crate::source::Span;

/// The tokens of a text, with an element for each start tag.
pub(super) struct Lexer<'a> {
    pub(super) input: Input<'a>,
    pub(super) tokens: Vec<Token>,
    pub(super) elements: Vec<Node>,
    pub(super) attributes: Vec<RawAttribute>,
    pub(super) faults: Faults,
    /// True if a comment or the like is never closed, so that the rest of the text is in it.
    pub(super) is_cut_short: bool,
    /// The second version of lines in conflict, with its marks: what is from here to there is passed over.
    second_version: (u32, u32),
    /// True if quick-xml found a document type declaration without an end: behind it, no other has one.
    has_open_doctype: bool,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(input: Input<'a>) -> Self {
        Self {
            input,
            tokens: Vec::new(),
            elements: Vec::new(),
            attributes: Vec::new(),
            faults: Faults::default(),
            is_cut_short: false,
            second_version: (0, 0),
            has_open_doctype: false,
        }
    }

    pub(super) fn run(&mut self) {
        let bytes = self.input.bytes();
        let mut at = 0;
        if self.input.text.starts_with('\u{feff}') {
            self.push(0, TokenKind::Mark);
            at = 3;
        }
        while let Some(&first) = bytes.get(at as usize) {
            at = match (first, bytes.get(at as usize + 1)) {
                (b'<', Some(b'/')) => self.end_tag(at),
                (b'<', Some(b'!' | b'?')) => self.other_markup(at),
                (b'<', Some(b'<')) if let Some(end) = self.conflict(at) => end,
                (b'<', _) => self.start_tag(at),
                _ if at > 0 && at == self.second_version.0 => {
                    self.push(at, TokenKind::Error);
                    self.second_version.1
                }
                _ => self.text(at),
            };
        }
        if self.elements.is_empty() {
            // Every tree has a root.
            let tag = Token { is_damaged: true, is_unnamed: true, ..Token::new(at, TokenKind::EmptyTag) };
            self.push_element(tag, Span::empty(at));
        }
        self.push(at, TokenKind::End);
    }

    pub(super) fn push(&mut self, start: u32, kind: TokenKind) {
        self.tokens.push(Token::new(start, kind));
    }

    pub(super) fn push_damaged(&mut self, start: u32, kind: TokenKind) {
        self.tokens.push(Token { is_damaged: true, ..Token::new(start, kind) });
    }

    /// Adds a start tag without its attributes, which follow, and its element.
    pub(super) fn push_element(&mut self, tag: Token, name: Span) {
        let token = self.tokens.len() as u32;
        self.tokens.push(tag);
        self.elements.push(Node {
            token,
            end: token,
            parent: NONE,
            after: NONE,
            attributes: self.attributes.len() as u32,
            name: name.start,
            name_len: name.len(),
            namespace: 0,
            has_text: false,
            is_closed: false,
            is_content_damaged: false,
            is_text_unsure: false,
        });
    }

    /// Reads an end tag; gives where it ends. To which element it belongs is found later.
    fn end_tag(&mut self, start: u32) -> u32 {
        let input = self.input;
        let (name, close) = end_name(input, start);
        self.push(start, TokenKind::EndTag);
        let is_nameless = name.start > start + 2 || name.is_empty();
        match input.byte(close) {
            None => {
                let message = "this end tag has no `>`";
                self.faults.add(|| input.ended(&codes::XML_UNCLOSED, start, name.end, message));
                self.is_cut_short = true;
                close
            }
            Some(byte) => {
                if is_nameless {
                    let message = "an end tag is `</`, the name of the element, and `>`";
                    self.faults.add(|| {
                        let one = input.fault(&codes::XML_NAME, start, start + 2, message);
                        if name.is_empty() {
                            return one;
                        }
                        one.suggest("remove the white space", input.at(start + 2, name.start), "")
                    });
                } else if byte != b'>' {
                    self.faults.add(|| {
                        let message = format!("{} is misplaced in an end tag", input.shown(close));
                        let end = input.character_end(close);
                        let one = input.fault(&codes::XML_SYNTAX, close, end, message);
                        one.help("remove everything but the name of the element")
                    });
                }
                let rest = &input.bytes()[close as usize..];
                match memchr::memchr2(b'<', b'>', rest) {
                    Some(length) if rest[length] == b'>' => close + length as u32 + 1,
                    _ => name.end,
                }
            }
        }
    }

    /// Reads comments, instructions, CDATA sections and the like, whose ends quick-xml finds.
    fn other_markup(&mut self, start: u32) -> u32 {
        let input = self.input;
        let is_doctype = prolog::starts_doctype(input.slice(start, input.len()));
        if is_doctype && self.has_open_doctype {
            return self.broken_markup(start);
        }
        let mut reader = Reader::from_str(&input.text[start as usize..]);
        let event = reader.read_event();
        let end = start + reader.buffer_position() as u32;
        match event {
            Ok(Event::CData(_)) => self.push(start, TokenKind::Section),
            Ok(Event::Comment(_)) => {
                self.push(start, TokenKind::Comment);
                if let Some(one) = prolog::comment(input, start, end) {
                    self.faults.add(|| one);
                }
            }
            Ok(Event::PI(_) | Event::Decl(_)) => {
                self.push(start, TokenKind::Instruction);
                if let Some(one) = prolog::instruction(input, start, end) {
                    self.faults.add(|| one);
                }
            }
            Ok(Event::DocType(_)) => {
                self.push(start, TokenKind::Doctype);
                self.faults.add(|| prolog::doctype(input, start, start + 9));
            }
            _ => {
                self.has_open_doctype |= is_doctype;
                return self.broken_markup(start);
            }
        }
        end
    }

    /// Reads markup that quick-xml cannot read to its end.
    fn broken_markup(&mut self, start: u32) -> u32 {
        let input = self.input;
        let kind = prolog::kind(input.slice(start, input.len()));
        if kind.is_some() || !self.has_open_doctype {
            self.faults.add(|| prolog::broken(input, start));
        }
        match kind {
            Some(kind @ (TokenKind::Comment | TokenKind::Section | TokenKind::Instruction)) => {
                self.push_damaged(start, kind);
                self.is_cut_short = true;
                input.len()
            }
            Some(kind) => {
                self.push_damaged(start, kind);
                input.find(b'>', start).map_or(input.len(), |close| close + 1)
            }
            None => {
                self.push_damaged(start, TokenKind::Error);
                let rest = &input.bytes()[start as usize + 2..];
                match memchr::memchr2(b'<', b'>', rest) {
                    Some(length) if rest[length] == b'>' => start + 2 + length as u32 + 1,
                    _ => start + 2,
                }
            }
        }
    }

    /// Reads the first mark of a conflict, if there is one; gives where it ends.
    fn conflict(&mut self, start: u32) -> Option<u32> {
        // In the first version, and where one has no end, others mean nothing.
        if start < self.second_version.0 {
            return None;
        }
        let (fault, end, second) = slips::conflict(self.input, start)?;
        self.faults.add(|| fault);
        self.second_version = second;
        self.push(start, TokenKind::Error);
        Some(end)
    }

    /// Reads character data up to the next `<`.
    fn text(&mut self, start: u32) -> u32 {
        let input = self.input;
        let second = self.second_version.0;
        let end = input.find(b'<', start).unwrap_or(input.len()).min(if start < second { second } else { u32::MAX });
        if value::trim(input.slice(start, end)).is_empty() {
            self.push(start, TokenKind::Space);
            return end;
        }
        let mut text = Token::new(start, TokenKind::Text);
        let mut at = start;
        while let Some(length) = memchr::memchr2(b'&', b']', &input.bytes()[at as usize..end as usize]) {
            at += length as u32;
            if input.byte(at) == Some(b'&') {
                let (behind, is_sure) = self.reference(at);
                text.is_damaged |= !is_sure;
                at = behind;
                continue;
            }
            if input.text[at as usize..].starts_with("]]>") {
                self.faults.add(|| {
                    let message = "`]]>` in text, which XML allows only to end a CDATA section";
                    let one = input.fault(&codes::XML_SYNTAX, at, at + 3, message);
                    one.mend("replace it with `]]&gt;`", "]]&gt;")
                });
            }
            at += 1;
        }
        self.tokens.push(text);
        end
    }
}

/// The name in an end tag, and the first byte behind it that is no white space.
pub(super) fn end_name(input: Input<'_>, start: u32) -> (Span, u32) {
    let mut from = start + 2;
    let mut end = from + name_length(&input.bytes()[from as usize..]) as u32;
    if end == from {
        // `</ a>`
        let behind = input.skip_space(from);
        let length = name_length(&input.bytes()[behind as usize..]) as u32;
        if length > 0 && input.byte(input.skip_space(behind + length)) == Some(b'>') {
            (from, end) = (behind, behind + length);
        }
    }
    (Span::new(from, end), input.skip_space(end))
}
