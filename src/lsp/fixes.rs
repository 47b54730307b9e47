//! Ways to mend what is wrong at a place, and what the codes there mean.

use std::collections::HashMap;
use std::io::Write;
use std::path::Path;
use std::str::FromStr;

use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, Position, Range, Uri, WorkspaceEdit,
};

use super::diagnostics::{Fix, Reported};
use super::server::Server;
use super::uri;

impl<W: Write> Server<W> {
    /// The suggestions of the diagnostics that a range touches, the likeliest first.
    pub(super) fn fixes(&self, params: &CodeActionParams) -> Vec<CodeActionOrCommand> {
        let wants = params.context.only.as_ref().is_none_or(|kinds| {
            // `quickfix` is also meant by the empty kind, which all are part of.
            kinds.iter().any(|kind| *kind == CodeActionKind::QUICKFIX || *kind == CodeActionKind::EMPTY)
        });
        let document = self.documents.get(params.text_document.uri.as_str());
        let shown = document.and_then(|document| {
            // What was found in an older text does not fit any more.
            self.shown.get(&document.path).filter(|shown| shown.is_of(document.version))
        });
        let Some(shown) = shown.filter(|_| wants) else { return Vec::new() };
        let touched = shown.all.iter().filter(|one| overlap(one.shown.range, params.range));
        touched
            .flat_map(|one| one.fixes.iter().enumerate().map(|(rank, fix)| self.action(one, fix, rank == 0)))
            .collect()
    }

    #[expect(clippy::mutable_key_type, reason = "the protocol's edits are by URIs, which never change")]
    fn action(&self, of: &Reported, fix: &Fix, is_preferred: bool) -> CodeActionOrCommand {
        let uri_of = |path: &Path| {
            let open = self.documents.iter().find(|(_, one)| one.path == path);
            Uri::from_str(&open.map_or_else(|| uri::uri(path), |(uri, _)| uri.to_owned())).ok()
        };
        let changes = fix.edits.iter().filter_map(|(path, edits)| Some((uri_of(path)?, edits.clone())));
        let changes: HashMap<Uri, _> = changes.collect();
        CodeActionOrCommand::CodeAction(CodeAction {
            title: fix.title.clone(),
            kind: Some(CodeActionKind::QUICKFIX),
            diagnostics: Some(vec![of.shown.clone()]),
            edit: Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }),
            is_preferred: Some(is_preferred),
            ..CodeAction::default()
        })
    }

    /// What the codes of the diagnostics mean that are shown at a place.
    pub(super) fn reported_at(&self, path: &Path, at: Position) -> impl Iterator<Item = String> {
        let all = self.shown.get(path).map(|shown| &shown.all);
        all.into_iter()
            .flatten()
            .filter(move |one| overlap(one.shown.range, Range::new(at, at)))
            .map(|one| one.meaning.clone())
    }
}

/// Whether two ranges touch.
fn overlap(one: Range, other: Range) -> bool {
    one.start <= other.end && other.start <= one.end
}
