//! Diagnostics of the checker as editors show them, and their suggestions as edits.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use lsp_types::{
    DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Location, NumberOrString, TextEdit, Uri,
};
use saoms_lang::diagnostic::{Diagnostic, Severity, codes};
use saoms_lang::source::{FileId, LineIndex, Location as SourcePlace, Sources, identity};

use saoms_tools::editor::describe_code;

use super::position;
use super::uri;

/// A diagnostic with the ways to mend it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Reported {
    pub(super) shown: lsp_types::Diagnostic,
    /// The meaning of the code, for hovering.
    pub(super) meaning: String,
    /// The code, where a composite can say that it is no fault.
    pub(super) can_be_allowed: Option<&'static str>,
    pub(super) fixes: Vec<Fix>,
}

/// A way to mend it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fix {
    pub(super) title: String,
    /// Edits by file.
    pub(super) edits: BTreeMap<PathBuf, Vec<TextEdit>>,
}

/// The diagnostics with the files that they are of.
pub(super) fn reported<'d>(
    all: &'d [Diagnostic],
    sources: &'d Sources,
) -> impl Iterator<Item = (PathBuf, Reported)> + use<'d> {
    let mut places = Places { sources, lines: HashMap::new(), paths: HashMap::new() };
    all.iter().map(move |one| {
        let related: Vec<DiagnosticRelatedInformation> = one
            .labels
            .iter()
            .filter_map(|label| {
                let location = Location { uri: places.uri(label.location.file)?, range: places.range(label.location) };
                Some(DiagnosticRelatedInformation { location, message: label.text.clone() })
            })
            .collect();
        let mended = one.suggestions.iter().map(|suggestion| &suggestion.description);
        let lines = mended.chain(&one.help).map(|help| format!("\n{help}"));
        let shown = lsp_types::Diagnostic {
            range: places.range(one.location),
            severity: Some(match one.severity {
                Severity::Error => DiagnosticSeverity::ERROR,
                Severity::Warning => DiagnosticSeverity::WARNING,
                Severity::Note => DiagnosticSeverity::INFORMATION,
            }),
            code: Some(NumberOrString::String(one.code.id.to_owned())),
            source: Some("saoms".to_owned()),
            message: format!("{}{}", one.message, lines.collect::<String>()),
            related_information: (!related.is_empty()).then_some(related),
            tags: codes::is_without_effect(one.code).then(|| vec![DiagnosticTag::UNNECESSARY]),
            ..lsp_types::Diagnostic::default()
        };
        let meaning = describe_code(one.code, one.rule);
        let fixes = one.suggestions.iter().map(|suggestion| Fix {
            title: capitalized(&suggestion.description),
            edits: suggestion.edits.iter().fold(BTreeMap::new(), |mut edits, edit| {
                let path = places.path(edit.location.file);
                let range = places.range(edit.location);
                edits.entry(path).or_insert_with(Vec::new).push(TextEdit::new(range, edit.replacement.clone()));
                edits
            }),
        });
        let fixes = fixes.collect();
        let can_be_allowed = one.severity != Severity::Error || codes::is_judgement(one.code);
        let can_be_allowed = can_be_allowed.then_some(one.code.id);
        (places.path(one.location.file), Reported { shown, meaning, can_be_allowed, fixes })
    })
}

/// The diagnostics of one file in several fleets, the same one once. A place that one fleet reports is not reported
/// again for another one in other words, unless it is worse there: so `saoms check` has it for a folder.
pub(super) fn merged(of_fleets: &[&Arc<Vec<Reported>>]) -> Arc<Vec<Reported>> {
    let mut all: Vec<Reported> = Vec::new();
    let mut known: HashMap<_, Place> = HashMap::new();
    for (fleet, one) in of_fleets.iter().enumerate().flat_map(|(fleet, of)| of.iter().map(move |one| (fleet, one))) {
        let shown = &one.shown;
        let (Some(code), Some(severity)) = (&shown.code, shown.severity) else { continue };
        let place = known.entry((shown.range.start, shown.range.end, code));
        let place = place.or_insert(Place { fleet, severity, messages: Vec::new() });
        let is_wanted = place.fleet == fleet || severity < place.severity;
        if is_wanted && !place.messages.contains(&shown.message.as_str()) {
            place.fleet = fleet;
            place.severity = place.severity.min(severity);
            place.messages.push(&shown.message);
            all.push(one.clone());
        }
    }
    Arc::new(all)
}

/// The reports of one code at one place.
struct Place<'d> {
    /// The last fleet with such a report.
    fleet: usize,
    /// The worst severity; the smaller, the worse.
    severity: DiagnosticSeverity,
    messages: Vec<&'d str>,
}

/// Translator of the places of a check.
struct Places<'s> {
    sources: &'s Sources,
    lines: HashMap<FileId, LineIndex>,
    paths: HashMap<FileId, PathBuf>,
}

impl Places<'_> {
    fn path(&mut self, file: FileId) -> PathBuf {
        let path = || identity(Path::new(self.sources.get(file).path()));
        self.paths.entry(file).or_insert_with(path).clone()
    }

    fn uri(&mut self, file: FileId) -> Option<Uri> {
        Uri::from_str(&uri::uri(&self.path(file))).ok()
    }

    fn range(&mut self, at: SourcePlace) -> lsp_types::Range {
        let text = self.sources.get(at.file).text();
        let lines = self.lines.entry(at.file).or_insert_with(|| position::lines(text));
        position::range(lines, text, at.span.start as usize..at.span.end.max(at.span.start) as usize)
    }
}

fn capitalized(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}
