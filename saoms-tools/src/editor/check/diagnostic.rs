//! Diagnostics of the checker as editors show them, and their suggestions as edits.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use saoms_lang::diagnostic::{Diagnostic, Severity, codes};
use saoms_lang::source::{ColumnUnit, FileId, LineIndex, LineRange, Location, Sources, identity};

use crate::editor::describe;

/// A diagnostic of a file with the ways to mend it. All columns are in UTF-16.
#[derive(Clone, Debug, PartialEq)]
pub struct EditorDiagnostic {
    /// The place in the file.
    pub range: LineRange,
    /// The severity.
    pub severity: Severity,
    /// The code, such as `S2011`.
    pub code: &'static str,
    /// The message, with what helps on lines of its own.
    pub message: String,
    /// Other places that it is about.
    pub related: Vec<RelatedPlace>,
    /// True if what stands there is without effect, which editors show pale.
    pub is_without_effect: bool,
    /// The meaning of the code, for hovering.
    pub meaning: String,
    /// True if a composite can say that it is no fault.
    pub can_be_allowed: bool,
    /// The ways to mend it, the likeliest first.
    pub fixes: Vec<Fix>,
}

/// Another place that a diagnostic is about.
#[derive(Clone, Debug, PartialEq)]
pub struct RelatedPlace {
    /// The file.
    pub path: PathBuf,
    /// The place in it.
    pub range: LineRange,
    /// What is there.
    pub message: String,
}

/// A way to mend a diagnostic.
#[derive(Clone, Debug, PartialEq)]
pub struct Fix {
    /// The title of the action.
    pub title: String,
    /// Edits by file.
    pub edits: BTreeMap<PathBuf, Vec<RangeEdit>>,
}

/// New text for a range of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RangeEdit {
    /// The range that is replaced.
    pub range: LineRange,
    /// The text in its place.
    pub text: String,
}

/// The diagnostics with the files that they are of.
pub(super) fn reported<'d>(
    all: &'d [Diagnostic],
    sources: &'d Sources,
) -> impl Iterator<Item = (PathBuf, EditorDiagnostic)> + use<'d> {
    let mut places = Places { sources, lines: HashMap::new(), paths: HashMap::new() };
    all.iter().map(move |one| {
        let related = one.labels.iter().map(|label| RelatedPlace {
            path: places.path(label.location.file),
            range: places.range(label.location),
            message: label.text.clone(),
        });
        let related = related.collect();
        let mended = one.suggestions.iter().map(|suggestion| &suggestion.description);
        let lines = mended.chain(&one.help).map(|help| format!("\n{help}"));
        let fixes = one.suggestions.iter().map(|suggestion| Fix {
            title: capitalized(&suggestion.description),
            edits: suggestion.edits.iter().fold(BTreeMap::new(), |mut edits, edit| {
                let (path, range) = (places.path(edit.location.file), places.range(edit.location));
                let edit = RangeEdit { range, text: edit.replacement.clone() };
                edits.entry(path).or_insert_with(Vec::new).push(edit);
                edits
            }),
        });
        let fixes = fixes.collect();
        let shown = EditorDiagnostic {
            range: places.range(one.location),
            severity: one.severity,
            code: one.code.id,
            message: format!("{}{}", one.message, lines.collect::<String>()),
            related,
            is_without_effect: codes::is_without_effect(one.code),
            meaning: describe::code(one.code, one.rule),
            can_be_allowed: one.severity != Severity::Error || codes::is_judgement(one.code),
            fixes,
        };
        (places.path(one.location.file), shown)
    })
}

/// The diagnostics of one file in several fleets, the same one once. A place that one fleet reports is not reported
/// again for another one in other words, unless it is worse there: so `saoms check` has it for a folder.
pub(super) fn merged(of_fleets: &[&Arc<Vec<EditorDiagnostic>>]) -> Arc<Vec<EditorDiagnostic>> {
    let mut all: Vec<EditorDiagnostic> = Vec::new();
    let mut known: HashMap<_, Reports> = HashMap::new();
    for (fleet, one) in of_fleets.iter().enumerate().flat_map(|(fleet, of)| of.iter().map(move |one| (fleet, one))) {
        let reports = known.entry((one.range.start, one.range.end, one.code));
        let reports = reports.or_insert(Reports { fleet, severity: one.severity, messages: Vec::new() });
        let is_wanted = reports.fleet == fleet || one.severity > reports.severity;
        if is_wanted && !reports.messages.contains(&one.message.as_str()) {
            reports.fleet = fleet;
            reports.severity = reports.severity.max(one.severity);
            reports.messages.push(&one.message);
            all.push(one.clone());
        }
    }
    Arc::new(all)
}

/// The reports of one code at one place.
struct Reports<'d> {
    /// The last fleet with such a report.
    fleet: usize,
    /// The worst severity.
    severity: Severity,
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

    fn range(&mut self, at: Location) -> LineRange {
        let text = self.sources.get(at.file).text();
        let lines = self.lines.entry(at.file).or_insert_with(|| LineIndex::new(text, ColumnUnit::Utf16));
        let end = at.span.end.max(at.span.start) as usize;
        LineRange { start: lines.line_column(text, at.span.start as usize), end: lines.line_column(text, end) }
    }
}

fn capitalized(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}
