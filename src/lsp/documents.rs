//! The texts that the editor has open.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use lsp_types::TextDocumentContentChangeEvent;
use saoms_core::source::{OpenTexts, identity};

use super::position::Lines;
use super::uri;

/// A text that is open.
#[derive(Debug)]
pub(super) struct Document {
    /// Its file, which need not exist.
    pub(super) path: PathBuf,
    /// The number that the editor counts its changes with.
    pub(super) version: i32,
    pub(super) text: Arc<str>,
}

/// All of them, by the URIs that the editor uses.
#[derive(Debug, Default)]
pub(super) struct Documents {
    all: HashMap<String, Document>,
}

impl Documents {
    /// Takes in a text; one without a file of its own is none that can be asked about.
    pub(super) fn open(&mut self, uri: String, version: i32, text: String) {
        if let Some(path) = uri::path(&uri) {
            let path = identity(&path);
            self.all.insert(uri, Document { path, version, text: text.into() });
        }
    }

    pub(super) fn change(&mut self, uri: &str, version: i32, changes: Vec<TextDocumentContentChangeEvent>) {
        let Some(document) = self.all.get_mut(uri) else { return };
        let mut text = document.text.to_string();
        changes.into_iter().for_each(|change| apply(&mut text, change));
        document.text = text.into();
        document.version = version;
    }

    pub(super) fn close(&mut self, uri: &str) {
        self.all.remove(uri);
    }

    pub(super) fn get(&self, uri: &str) -> Option<&Document> {
        self.all.get(uri)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&str, &Document)> {
        self.all.iter().map(|(uri, document)| (uri.as_str(), document))
    }

    /// As loaders take them.
    pub(super) fn texts(&self) -> OpenTexts {
        let mut open = OpenTexts::default();
        self.all.values().for_each(|one| open.insert(&one.path, Arc::clone(&one.text)));
        open
    }
}

fn apply(text: &mut String, change: TextDocumentContentChangeEvent) {
    let Some(range) = change.range else {
        *text = change.text;
        return;
    };
    let lines = Lines::new(text);
    let start = lines.offset(text, range.start);
    let end = lines.offset(text, range.end).max(start);
    text.replace_range(start..end, &change.text);
}

#[cfg(test)]
mod tests {
    use lsp_types::{Position, Range};

    use super::*;

    fn change(from: (u32, u32), to: (u32, u32), text: &str) -> TextDocumentContentChangeEvent {
        let range = Range::new(Position::new(from.0, from.1), Position::new(to.0, to.1));
        TextDocumentContentChangeEvent { range: Some(range), range_length: None, text: text.to_owned() }
    }

    fn whole(text: &str) -> TextDocumentContentChangeEvent {
        TextDocumentContentChangeEvent { range: None, range_length: None, text: text.to_owned() }
    }

    #[test]
    fn changes_are_applied_one_after_another_in_utf_16() {
        let mut all = Documents::default();
        let uri = "file:///fleet.composite";
        all.open(uri.to_owned(), 1, "<ä>\n<🤖 x/>\n".to_owned());
        let text = |all: &Documents| all.get(uri).map(|one| one.text.to_string()).unwrap();
        all.change(
            uri,
            2,
            vec![change((1, 3), (1, 5), ""), change((0, 1), (0, 2), "aü"), change((9, 9), (9, 9), "!")],
        );
        assert_eq!(text(&all), "<aü>\n<🤖/>\n!");
        all.change(uri, 3, vec![whole("new"), change((0, 3), (0, 0), "er")]);
        assert_eq!(text(&all), "newer");
        assert_eq!(all.get(uri).unwrap().version, 3);
        all.change("file:///other", 4, vec![whole("x")]);
        all.close(uri);
        assert!(all.get(uri).is_none());
    }
}
