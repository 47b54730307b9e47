//! One proposal, in the terms of this module; `mod.rs` makes one of the protocol of it.

use std::ops::Range;

use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, Documentation, InsertTextFormat, MarkupContent,
    MarkupKind, TextEdit,
};

use crate::lsp::file::File;

/// What an editor can offer.
#[derive(Clone, Debug)]
pub(in crate::lsp) struct Proposal {
    pub(in crate::lsp) label: String,
    kind: CompletionItemKind,
    /// What stands beside it, short.
    pub(super) detail: String,
    /// What is shown about it, in Markdown.
    doc: String,
    /// What is put in place of `range`; where it holds `$`, a snippet.
    insert: Insert,
    /// Those with a smaller number come first.
    rank: u8,
    /// How far the label is from what is typed; those that are closer come first.
    distance: u8,
    pub(in crate::lsp) range: Range<usize>,
    /// What is put in elsewhere as well.
    also: Option<(usize, String)>,
}

/// What is put into the text.
#[derive(Clone, Debug)]
pub(super) enum Insert {
    /// This text.
    Plain(String),
    /// A snippet, where the editor knows such, or a text.
    Snippet(String, String),
}

impl Proposal {
    pub(super) fn new(label: impl Into<String>, kind: CompletionItemKind, range: &Range<usize>) -> Self {
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

    pub(super) fn detail(mut self, detail: impl Into<String>) -> Self {
        self.detail = detail.into();
        self
    }

    pub(super) fn doc(mut self, doc: impl Into<String>) -> Self {
        self.doc = doc.into();
        self
    }

    pub(super) fn rank(mut self, rank: u8) -> Self {
        self.rank = rank;
        self
    }

    /// Something that is put in elsewhere, outside of the range.
    pub(super) fn also(mut self, at: usize, text: String) -> Self {
        self.also = Some((at, text));
        self
    }

    pub(super) fn insert(mut self, text: impl Into<String>) -> Self {
        self.insert = Insert::Plain(text.into());
        self
    }

    /// A snippet, and what is inserted where the editor knows none: up to where the first place to fill in is.
    pub(super) fn snippet(mut self, snippet: impl Into<String>) -> Self {
        let snippet = snippet.into();
        let plain = without_places(&snippet);
        self.insert = Insert::Snippet(snippet, plain);
        self
    }

    /// With how well it fits what is typed; `None` where it cannot be meant by that. A word of the label that begins so is better than a part of one, and that is
    /// better than the characters alone, in their order.
    pub(in crate::lsp) fn matching(mut self, typed: &str) -> Option<Self> {
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

    /// By what proposals are sorted.
    pub(in crate::lsp) fn order(&self) -> String {
        format!("{}{:03} {}", self.distance, self.rank, self.label)
    }

    /// The name alone, in place of another one.
    pub(super) fn renaming(self, range: &Range<usize>) -> Self {
        let label = self.label.clone();
        Self { range: range.clone(), ..self.insert(label) }
    }

    /// As the protocol has it.
    pub(in crate::lsp) fn into_item(self, file: &File, knows_snippets: bool) -> CompletionItem {
        let sort_text = Some(self.order());
        let (new_text, format) = match self.insert {
            Insert::Snippet(snippet, _) if knows_snippets => (snippet, InsertTextFormat::SNIPPET),
            Insert::Snippet(_, plain) | Insert::Plain(plain) => (plain, InsertTextFormat::PLAIN_TEXT),
        };
        let place = |range: Range<usize>| file.lines.range(&file.text, range);
        let range = place(self.range.clone());
        // Editors hold what is typed already against it.
        let filter_text = new_text.starts_with('<').then(|| format!("<{}", self.label));
        CompletionItem {
            sort_text,
            label: self.label,
            kind: Some(self.kind),
            detail: (!self.detail.is_empty()).then_some(self.detail),
            documentation: (!self.doc.is_empty()).then_some(Documentation::MarkupContent(MarkupContent {
                kind: MarkupKind::Markdown,
                value: self.doc,
            })),
            filter_text,
            insert_text_format: Some(format),
            additional_text_edits: self.also.map(|(at, text)| vec![TextEdit::new(place(at..at), text)]),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit { range, new_text })),
            ..CompletionItem::default()
        }
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
