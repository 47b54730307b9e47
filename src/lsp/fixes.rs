//! Ways to mend what is wrong at a place, and what the codes there mean.

use std::collections::HashMap;
use std::io::Write;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, Diagnostic, Position, Range, TextEdit, Uri,
    WorkspaceEdit,
};

use saoms_tools::editor::{Allowance, allowances};

use super::convert::text_edit;
use super::diagnostics::Reported;
use super::position::offset_in;
use super::server::{Refusal, Server};

impl<W: Write> Server<W> {
    /// Fixes for the diagnostics that a range touches, the likeliest first; then fixes for all of the file.
    pub(super) fn fixes(&mut self, params: &CodeActionParams) -> Result<Vec<CodeActionOrCommand>, Refusal> {
        let uri = &params.text_document.uri;
        let Some(document) = self.documents.get(uri.as_str()) else { return Ok(Vec::new()) };
        let (path, version) = (document.path.clone(), document.version);
        // What was found in an older text does not fit any more.
        let shown = self.shown.get(&path).filter(|shown| shown.is_of(version));
        let all = shown.map(|shown| Arc::clone(&shown.all)).unwrap_or_default();
        let touched = all.iter().filter(|one| overlap(one.shown.range, params.range));
        let mut actions = Vec::new();
        if is_wanted(params, &CodeActionKind::QUICKFIX) {
            let scene = self.scene(uri)?;
            for one in touched.clone() {
                for (rank, fix) in one.fixes.iter().enumerate() {
                    let edits = fix.edits.iter().map(|(path, edits)| (path.as_path(), edits.clone()));
                    actions.push(self.action(&fix.title, &[one], edits, rank == 0));
                }
            }
            for (one, code) in touched.filter_map(|one| Some((one, one.can_be_allowed?))) {
                let file = scene.file();
                for Allowance { title, edits } in allowances(&scene, offset_in(file, one.shown.range.start), code) {
                    let edits = edits.into_iter().map(|edit| text_edit(file, edit)).collect();
                    actions.push(self.action(&title, &[one], [(path.as_path(), edits)].into_iter(), false));
                }
            }
        }
        let (mended, edits) = mended(&all, &path);
        // In a list of what can be done, one fault has its own fix; who mends all on saving means that one, too.
        let few = usize::from(params.context.only.is_none());
        if mended.len() > few && is_wanted(params, &CodeActionKind::SOURCE_FIX_ALL) {
            let title = match mended.len() {
                1 => "Mend the fault of this file that has one suggestion".to_owned(),
                count => format!("Mend all {count} faults of this file that have one suggestion"),
            };
            let whole = self.action(&title, &mended, [(path.as_path(), edits)].into_iter(), false);
            actions.push(CodeAction { kind: Some(CodeActionKind::SOURCE_FIX_ALL), ..whole });
        }
        Ok(actions.into_iter().map(CodeActionOrCommand::CodeAction).collect())
    }

    #[expect(clippy::mutable_key_type, reason = "the protocol's edits are by URIs, which never change")]
    fn action<'p>(
        &self,
        title: &str,
        of: &[&Reported],
        edits: impl Iterator<Item = (&'p Path, Vec<TextEdit>)>,
        is_preferred: bool,
    ) -> CodeAction {
        let changes = edits.filter_map(|(path, edits)| Some((Uri::from_str(&self.uri_of(path)).ok()?, edits)));
        let changes: HashMap<Uri, _> = changes.collect();
        CodeAction {
            title: title.to_owned(),
            kind: Some(CodeActionKind::QUICKFIX),
            diagnostics: Some(of.iter().map(|one| one.shown.clone()).collect::<Vec<Diagnostic>>()),
            edit: Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }),
            is_preferred: Some(is_preferred),
            ..CodeAction::default()
        }
    }

    /// Meanings of the codes of the diagnostics that are shown at a place. Those of a text before the last change may
    /// be elsewhere by now.
    pub(super) fn reported_at(&self, uri: &Uri, at: Position) -> impl Iterator<Item = String> {
        let shown = self.documents.get(uri.as_str()).and_then(|document| {
            let shown = self.shown.get(&document.path)?;
            shown.is_of(document.version).then_some(shown.all.as_slice())
        });
        shown
            .into_iter()
            .flatten()
            .filter(move |one| overlap(one.shown.range, Range::new(at, at)))
            .map(|one| one.meaning.clone())
    }
}

/// True if actions of a kind are asked for: all are where none is named, or the empty one.
fn is_wanted(params: &CodeActionParams, kind: &CodeActionKind) -> bool {
    params.context.only.as_ref().is_none_or(|kinds| {
        kinds.iter().any(|asked| {
            let rest = kind.as_str().strip_prefix(asked.as_str());
            rest.is_some_and(|rest| asked.as_str().is_empty() || rest.is_empty() || rest.starts_with('.'))
        })
    })
}

/// The diagnostics with one suggestion, and the edits of these, where they change this file alone and do not overlap.
fn mended<'r>(all: &'r [Reported], path: &Path) -> (Vec<&'r Reported>, Vec<TextEdit>) {
    let (mut mended, mut edits): (Vec<&Reported>, Vec<TextEdit>) = (Vec::new(), Vec::new());
    for one in all {
        let [fix] = &one.fixes[..] else { continue };
        let Some(own) = fix.edits.get(path).filter(|_| fix.edits.len() == 1) else { continue };
        let meets = |new: &TextEdit| edits.iter().any(|known| overlap(known.range, new.range));
        if own.iter().any(meets) {
            continue;
        }
        edits.extend(own.iter().cloned());
        mended.push(one);
    }
    (mended, edits)
}

/// True if two ranges touch.
fn overlap(one: Range, other: Range) -> bool {
    one.start <= other.end && other.start <= one.end
}
