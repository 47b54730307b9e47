//! Faults of a text, as diagnostics.

use crate::diagnostic::{Code, Diagnostic, Label, codes, quoted};
use crate::limits::{DECLARED_ENTITIES, TEXT_FAULTS};
use crate::source::{FileId, Location, Span};

/// The faults found so far.
#[derive(Debug, Default)]
pub(super) struct Faults(Vec<Diagnostic>);

impl Faults {
    /// Adds a fault, which is not even put together when there are too many.
    pub(super) fn add(&mut self, make: impl FnOnce() -> Diagnostic) {
        if self.0.len() < TEXT_FAULTS {
            self.0.push(make());
        }
    }

    /// Adds the place of a reference to the fault of the document type declaration that declares it. False if there is
    /// none.
    pub(super) fn add_entity(&mut self, input: Input<'_>, start: u32, end: u32) -> bool {
        // Nearly all texts have none.
        let Some(one) = self.0.first_mut().filter(|one| one.code == &codes::XML_DOCTYPE) else { return false };
        let declaration = format!("<!ENTITY {} ", input.slice(start + 1, end - 1));
        if !input.text[one.location.span.start as usize..start as usize].contains(&declaration) {
            return false;
        }
        if one.labels.is_empty() {
            one.help.push(format!("write the text itself in place of {}", quoted(input.slice(start, end))));
        }
        if one.labels.len() < DECLARED_ENTITIES {
            one.labels.push(Label { location: input.at(start, end), text: "an entity that it declares".to_owned() });
        }
        true
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True if a fault says that the text ends, at `end`, inside a tag or a value: what is open around it is open for
    /// that.
    pub(super) fn says_cut(&self, end: u32) -> bool {
        let is_end = |at: Location| at.span.start == end;
        self.0.iter().any(|one| is_end(one.location) || one.labels.iter().any(|label| is_end(label.location)))
    }

    /// The faults in the order of their places.
    pub(super) fn into_sorted(mut self) -> Vec<Diagnostic> {
        self.0.sort_by_key(|one| one.location.span.start);
        self.0
    }
}

/// The text that is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input<'a> {
    pub(super) file: FileId,
    pub(super) text: &'a str,
}

impl<'a> Input<'a> {
    pub(super) fn bytes(self) -> &'a [u8] {
        self.text.as_bytes()
    }

    pub(super) fn len(self) -> u32 {
        self.text.len() as u32
    }

    pub(super) fn slice(self, start: u32, end: u32) -> &'a str {
        &self.text[start as usize..end as usize]
    }

    pub(super) fn piece(self, span: Span) -> &'a str {
        self.slice(span.start, span.end)
    }

    pub(super) fn byte(self, at: u32) -> Option<u8> {
        self.bytes().get(at as usize).copied()
    }

    /// The first byte at or behind `at` that is no white space, or the end.
    pub(super) fn skip_space(self, at: u32) -> u32 {
        let rest = &self.bytes()[at as usize..];
        let space = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t' | b'\r' | b'\n'));
        at + space.count() as u32
    }

    /// The first `byte` at or behind `at`.
    pub(super) fn find(self, byte: u8, at: u32) -> Option<u32> {
        memchr::memchr(byte, &self.bytes()[at as usize..]).map(|length| at + length as u32)
    }

    /// The place of the bytes from `start` to `end`.
    pub(super) fn at(self, start: u32, end: u32) -> Location {
        Span::new(start, end).in_file(self.file)
    }

    /// A diagnostic at the bytes from `start` to `end`.
    pub(super) fn fault(self, code: &'static Code, start: u32, end: u32, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(code, self.at(start, end), message)
    }

    /// The diagnostic for a text that ends inside something that starts at `start`.
    pub(super) fn ended(self, code: &'static Code, start: u32, end: u32, message: impl Into<String>) -> Diagnostic {
        self.fault(code, start, end, message).label(self.at(self.len(), self.len()), "the file ends here")
    }

    /// The end of the character at byte `at`.
    pub(super) fn character_end(self, at: u32) -> u32 {
        self.text.ceil_char_boundary(at as usize + 1) as u32
    }
}
