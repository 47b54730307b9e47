//! A text that can be put in at a place, and its order among others.

use std::ops::Range;

use crate::editor::FileEdit;

/// A text that an editor offers at a place.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// The name in the list.
    pub label: String,
    /// The kind of thing, which editors show as an icon.
    pub kind: ProposalKind,
    /// A short text beside the label; may be empty.
    pub detail: String,
    /// The description in Markdown; may be empty.
    pub doc: String,
    /// The text that is put in place of the range.
    pub insert: Insert,
    /// Those with a smaller number come first.
    rank: u8,
    /// The distance of the label from the typed text; those that are closer come first.
    distance: u8,
    /// The bytes that are replaced.
    pub range: Range<usize>,
    /// A change at another place of the file that goes with it.
    pub also: Option<FileEdit>,
}

/// The text of a completion.
#[derive(Clone, Debug)]
pub enum Insert {
    /// This text.
    Plain(String),
    /// A snippet.
    Snippet {
        /// The text with places to fill in: `$1`, `${2:text}`.
        snippet: String,
        /// The text for editors that know no snippets.
        plain: String,
    },
}

impl Insert {
    /// The text, and true where it is a snippet.
    pub fn text(&self, knows_snippets: bool) -> (&str, bool) {
        match self {
            Self::Snippet { snippet, .. } if knows_snippets => (snippet, true),
            Self::Snippet { plain, .. } | Self::Plain(plain) => (plain, false),
        }
    }
}

/// The kind of thing that a completion names, in the terms of editors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say all")]
pub enum ProposalKind {
    Class,
    Constant,
    EnumMember,
    Event,
    Field,
    File,
    Folder,
    Function,
    Interface,
    Keyword,
    Module,
    Property,
    TypeParameter,
    Value,
    Variable,
}

impl Proposal {
    /// A completion that puts its label in place of a range.
    pub(super) fn new(label: impl Into<String>, kind: ProposalKind, range: &Range<usize>) -> Self {
        let label = label.into();
        Self {
            insert: Insert::Plain(label.clone()),
            label,
            kind,
            detail: String::new(),
            doc: String::new(),
            rank: 5,
            distance: 0,
            range: range.clone(),
            also: None,
        }
    }

    /// With a short text beside the label.
    pub(super) fn detail(mut self, detail: impl Into<String>) -> Self {
        self.detail = detail.into();
        self
    }

    pub(super) fn doc(mut self, doc: impl Into<String>) -> Self {
        self.doc = doc.into();
        self
    }

    /// With a place in the order: those with smaller numbers come first, and 5 is usual.
    pub(super) fn rank(mut self, rank: u8) -> Self {
        self.rank = rank;
        self
    }

    /// With a text that is put in elsewhere, outside of the range.
    pub(super) fn also(mut self, at: usize, text: String) -> Self {
        self.also = Some(FileEdit::new(at..at, text));
        self
    }

    pub(super) fn insert(mut self, text: impl Into<String>) -> Self {
        self.insert = Insert::Plain(text.into());
        self
    }

    /// With a snippet as its text. Editors that know no snippets get it without its places.
    pub(super) fn snippet(mut self, snippet: impl Into<String>) -> Self {
        let snippet = snippet.into();
        let plain = without_places(&snippet);
        self.insert = Insert::Snippet { snippet, plain };
        self
    }

    /// The same with its distance from the typed text; `None` where the label does not hold its characters in their
    /// order. A word that begins with the text is closest, then one that holds it, then one with its characters.
    pub fn matching(mut self, typed: &str) -> Option<Self> {
        let (label, typed) = (self.label.to_lowercase(), typed.trim_start_matches('<').to_lowercase());
        let begins = |at: usize| !label[..at].ends_with(char::is_alphanumeric);
        let mut characters = label.chars();
        self.distance = if label.match_indices(&typed).any(|(at, _)| begins(at)) {
            0
        } else if label.contains(&typed) {
            1
        } else if typed.chars().all(|wanted| characters.any(|known| known == wanted)) {
            2
        } else {
            return None;
        };
        Some(self)
    }

    /// The key that completions are sorted by.
    pub fn order(&self) -> String {
        format!("{}{:03} {}", self.distance, self.rank, self.label)
    }

    /// The name alone, in place of another one.
    pub(super) fn renaming(self, range: &Range<usize>) -> Self {
        let label = self.label.clone();
        Self { range: range.clone(), ..self.insert(label) }
    }
}

/// A snippet without its places: `$1`, `${1:text}` becomes the text.
fn without_places(snippet: &str) -> String {
    let mut out = String::new();
    let mut rest = snippet;
    while let Some(at) = rest.find('$') {
        out.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
        if digits > 0 {
            rest = &rest[digits..];
        } else if let Some((place, after)) = rest.strip_prefix('{').and_then(|inner| inner.split_once('}')) {
            out.push_str(place.split_once(':').map_or("", |(_, text)| text));
            rest = after;
        }
    }
    out.push_str(rest);
    out.strip_suffix('\\').map(str::to_owned).unwrap_or(out)
}

/// A text as it stands in a snippet.
pub(super) fn in_snippet(text: &str) -> String {
    text.replace('\\', "\\\\").replace('$', "\\$").replace('}', "\\}")
}
