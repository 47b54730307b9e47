//! The texts that the editor has open.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lsp_types::TextDocumentContentChangeEvent;
use saoms_lang::source::{OpenTexts, identity};

use super::position::{lines, offset};
use super::uri;

/// A text that is open.
#[derive(Debug)]
pub(super) struct Document {
    /// Its file, which need not exist.
    pub(super) path: PathBuf,
    /// The number that the editor counts its changes with.
    pub(super) version: i32,
    pub(super) text: Arc<String>,
}

/// All of them, by the URIs that the editor uses.
#[derive(Debug, Default)]
pub(super) struct Documents {
    all: HashMap<String, Document>,
    texts: OpenTexts,
    /// The URIs of files that are open.
    uris: HashMap<PathBuf, String>,
}

impl Documents {
    /// Takes in a text. One that has no file yet, as `untitled:Untitled-1`, counts as one in the folder that the server
    /// was started in; so does one whose URI names no file, as `file:///a/..`.
    pub(super) fn open(&mut self, uri: String, version: i32, text: String) {
        self.close(&uri);
        let names_file = |path: &PathBuf| path.file_name().is_some();
        let named = uri::path(&uri).filter(names_file);
        let nameless = || Some(PathBuf::from(uri.replace('/', "_"))).filter(names_file);
        let path = named.or_else(nameless).unwrap_or_else(|| format!("untitled:{uri}").into());
        let document = Document { path: identity(&path), version, text: text.into() };
        self.texts.insert(&document.path, Arc::clone(&document.text));
        self.uris.insert(document.path.clone(), uri.clone());
        self.all.insert(uri, document);
    }

    pub(super) fn change(&mut self, uri: &str, version: i32, changes: Vec<TextDocumentContentChangeEvent>) {
        let Some(document) = self.all.get_mut(uri) else { return };
        let text = Arc::make_mut(&mut document.text);
        changes.into_iter().for_each(|change| apply(text, change));
        document.version = version;
        self.texts.insert(&document.path, Arc::clone(&document.text));
    }

    pub(super) fn close(&mut self, uri: &str) {
        let Some(Document { path, .. }) = self.all.remove(uri) else { return };
        // One file can be open under several URIs.
        match self.all.iter().find(|(_, other)| other.path == path) {
            Some((uri, other)) => {
                self.texts.insert(&path, Arc::clone(&other.text));
                self.uris.insert(path, uri.clone());
            }
            None => {
                self.texts.remove(&path);
                self.uris.remove(&path);
            }
        }
    }

    pub(super) fn get(&self, uri: &str) -> Option<&Document> {
        self.all.get(uri)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&str, &Document)> {
        self.all.iter().map(|(uri, document)| (uri.as_str(), document))
    }

    /// The URI of a file that is open.
    pub(super) fn uri(&self, path: &Path) -> Option<&str> {
        self.uris.get(path).map(String::as_str)
    }

    /// As loaders take them.
    pub(super) fn texts(&self) -> &OpenTexts {
        &self.texts
    }
}

fn apply(text: &mut String, change: TextDocumentContentChangeEvent) {
    let Some(range) = change.range else {
        *text = change.text;
        return;
    };
    let lines = lines(text);
    let start = offset(&lines, text, range.start);
    let end = offset(&lines, text, range.end).max(start);
    text.replace_range(start..end, &change.text);
}

#[cfg(test)]
mod tests {
    use lsp_types::{Position, Range};
    use proptest::prelude::*;
    use saoms_tools::editor::Workspace;

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
        all.change(uri, 2, vec![change((1, 3), (1, 5), ""), change((0, 1), (0, 2), "aü"), change((9, 9), (9, 9), "!")]);
        assert_eq!(text(&all), "<aü>\n<🤖/>\n!");
        all.change(uri, 3, vec![whole("new"), change((0, 3), (0, 0), "er")]);
        assert_eq!(text(&all), "newer");
        assert_eq!(all.get(uri).unwrap().version, 3);
        all.change("file:///other", 4, vec![whole("x")]);
        all.close(uri);
        assert!(all.get(uri).is_none());
    }

    /// The same change on UTF-16 units, as the protocol describes it.
    fn replaced(text: &[u16], from: (u32, u32), to: (u32, u32), new: &str) -> Vec<u16> {
        let is = |at: usize, sign: char| text.get(at) == Some(&(sign as u16));
        let offset = |(line, column): (u32, u32)| {
            let mut at = usize::from(text.first() == Some(&0xfeff));
            for _ in 0..line {
                while at < text.len() && !is(at, '\n') && !is(at, '\r') {
                    at += 1;
                }
                if at == text.len() {
                    return at;
                }
                at += if is(at, '\r') && is(at + 1, '\n') { 2 } else { 1 };
            }
            let mut column = column;
            while column > 0 && at < text.len() && !is(at, '\n') && !is(at, '\r') {
                let is_pair = (0xd800..0xdc00).contains(&text[at]);
                // A place within a character is before it.
                if is_pair && column == 1 {
                    break;
                }
                (at, column) = if is_pair { (at + 2, column - 2) } else { (at + 1, column - 1) };
            }
            at
        };
        let (start, end) = (offset(from), offset(to));
        [&text[..start], &new.encode_utf16().collect::<Vec<u16>>(), &text[end.max(start)..]].concat()
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn any_changes_come_to_the_text_that_the_editor_has(
            first in "\u{feff}?(<a>|ä|🤖|\r\n|\n|\r|x){0,12}",
            edits in prop::collection::vec(((0u32..6, 0u32..8), (0u32..6, 0u32..8), "(<b|\"|🤖|ü|\r\n|\n|\r|y){0,4}"), 1..12),
        ) {
            let folder = tempfile::tempdir().unwrap();
            let uri = &uri::uri(&folder.path().join("fleet.composite"));
            let mut all = Documents::default();
            let mut expected: Vec<u16> = first.encode_utf16().collect();
            all.open(uri.clone(), 0, first);
            for (version, (from, to, new)) in (1..).zip(&edits) {
                all.change(uri, version, vec![change(*from, *to, new)]);
                expected = replaced(&expected, *from, *to, new);
            }
            let (text, expected) = (all.get(uri).unwrap().text.to_string(), String::from_utf16(&expected).unwrap());
            prop_assert_eq!(&text, &expected);
            // The workspace answers for that text, and not for an older one.
            let mut workspace = Workspace::default();
            workspace.set_open(all.texts().clone());
            let around = workspace.around(&all.get(uri).unwrap().path);
            prop_assert_eq!(&*around.file().unwrap().text, &expected);
        }
    }
}
