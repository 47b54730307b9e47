//! Diagnostics and their fixes in the types of the protocol.

use std::io::Write;
use std::str::FromStr;
use std::sync::Arc;

use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, Diagnostic, DiagnosticRelatedInformation,
    DiagnosticSeverity, DiagnosticTag, Location, NumberOrString, Position, Range, TextEdit, Uri, WorkspaceEdit,
};
use saoms_lang::diagnostic::Severity;
use saoms_tools::editor::{EditorDiagnostic, FixAction, RangeEdit, RelatedPlace, fix_all, fixes, touching};

use super::position::{line_range, range_of};
use super::server::{Refusal, Server};
use super::uri;

/// A diagnostic as editors show it.
pub(super) fn diagnostic(one: &EditorDiagnostic) -> Diagnostic {
    let related = one.related.iter().filter_map(|RelatedPlace { path, range, message }| {
        let location = Location { uri: Uri::from_str(&uri::uri(path)).ok()?, range: range_of(*range) };
        Some(DiagnosticRelatedInformation { location, message: message.clone() })
    });
    let related: Vec<DiagnosticRelatedInformation> = related.collect();
    Diagnostic {
        range: range_of(one.range),
        severity: Some(match one.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
            Severity::Note => DiagnosticSeverity::INFORMATION,
        }),
        code: Some(NumberOrString::String(one.code.to_owned())),
        source: Some("saoms".to_owned()),
        message: one.message.clone(),
        related_information: (!related.is_empty()).then_some(related),
        tags: one.is_without_effect.then(|| vec![DiagnosticTag::UNNECESSARY]),
        ..Diagnostic::default()
    }
}

impl<W: Write> Server<W> {
    /// Fixes for the diagnostics that a range touches, the likeliest first; then fixes for all of the file.
    pub(super) fn fixes(&mut self, params: &CodeActionParams) -> Result<Vec<CodeActionOrCommand>, Refusal> {
        let uri = &params.text_document.uri;
        let Some(document) = self.documents.get(uri.as_str()) else { return Ok(Vec::new()) };
        let path = document.path.clone();
        let all = self.current(uri);
        let mut actions = Vec::new();
        if is_wanted(params, &CodeActionKind::QUICKFIX) {
            let scene = self.scene(uri)?;
            let found = fixes(&scene, &all, line_range(params.range));
            actions.extend(found.into_iter().map(|one| self.action(one, CodeActionKind::QUICKFIX)));
        }
        if is_wanted(params, &CodeActionKind::SOURCE_FIX_ALL) {
            // In a list of what can be done, one fault has its own fix; who mends all on saving means that one, too.
            let least = if params.context.only.is_none() { 2 } else { 1 };
            let whole = fix_all(&all, &path, least);
            actions.extend(whole.map(|one| self.action(one, CodeActionKind::SOURCE_FIX_ALL)));
        }
        Ok(actions.into_iter().map(CodeActionOrCommand::CodeAction).collect())
    }

    fn action(&self, FixAction { fix, of, is_preferred }: FixAction<'_>, kind: CodeActionKind) -> CodeAction {
        let edit = |RangeEdit { range, text }: RangeEdit| TextEdit::new(range_of(range), text);
        let changes = fix.edits.into_iter().filter_map(|(path, edits)| {
            let uri = Uri::from_str(&self.uri_of(&path)).ok()?;
            Some((uri, edits.into_iter().map(edit).collect()))
        });
        CodeAction {
            title: fix.title,
            kind: Some(kind),
            diagnostics: Some(of.into_iter().map(diagnostic).collect()),
            edit: Some(WorkspaceEdit { changes: Some(changes.collect()), ..WorkspaceEdit::default() }),
            is_preferred: Some(is_preferred),
            ..CodeAction::default()
        }
    }

    /// Meanings of the codes of the diagnostics that are shown at a place.
    pub(super) fn reported_at(&self, uri: &Uri, at: Position) -> Vec<String> {
        let all = self.current(uri);
        touching(&all, line_range(Range::new(at, at))).map(|one| one.meaning.clone()).collect()
    }

    /// The diagnostics that are shown of a document; none of an older text, where they may have stood elsewhere.
    fn current(&self, uri: &Uri) -> Arc<Vec<EditorDiagnostic>> {
        let shown = self.documents.get(uri.as_str()).and_then(|document| {
            let shown = self.shown.get(&document.path)?;
            shown.is_of(document.version).then(|| Arc::clone(&shown.all))
        });
        shown.unwrap_or_default()
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
