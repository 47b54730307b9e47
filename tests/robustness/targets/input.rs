//! Inputs of checks: one text, or the files of a fleet.

use std::fs;
use std::path::Path;

use saoms_lang::check::Occurrences;
use saoms_lang::diagnostic::Diagnostic;
use saoms_lang::project::{Compilation, Project};
use saoms_lang::registry::Registry;
use saoms_tools::format::format;
use tempfile::TempDir;

use super::memory::within;
use super::parsed;

/// The files of a fleet, each a path and a text; the first is the composite that is asked for.
pub(crate) type Files = Vec<(String, String)>;

/// An input of a check.
#[derive(Debug)]
pub(crate) enum Input {
    /// One composite, which finds no other.
    Text(String),
    /// Files in a folder.
    Files(Files),
}

/// Settings of a project.
pub(crate) type Settings = fn(Project) -> Project;

impl Input {
    /// The same in the one layout; what is ill-formed as it is.
    pub(crate) fn formatted(&self) -> Self {
        match self {
            Self::Text(text) => Self::Text(formatted(text)),
            Self::Files(files) => {
                Self::Files(files.iter().map(|(path, text)| (path.clone(), formatted(text))).collect())
            }
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::Files(files) => files.iter().map(|(_, text)| text.len()).sum(),
        }
    }

    /// Compiles it with these settings, within the memory that it may take.
    pub(crate) fn compiled(&self, settings: Settings, registry: &Registry) -> Compilation {
        self.measured(settings, |project| project.compile(registry))
    }

    /// Counts its components with these settings, within the memory that it may take.
    pub(crate) fn counted(&self, settings: Settings, registry: &Registry) -> Compilation<Occurrences> {
        self.measured(settings, |project| project.census(registry))
    }

    fn measured<T>(&self, settings: Settings, compile: impl FnOnce(Project) -> T) -> T {
        thread_local! {
            static FOLDER: TempDir = tempfile::tempdir().unwrap();
        }
        let path = FOLDER.with(|folder| folder.path().join("fleet"));
        let project = Project::new().environment(|_| Some("3".into()));
        let project = match self {
            Self::Text(text) => project.in_memory().text("x", text),
            Self::Files(files) => {
                write(&path, files);
                project.file(path.join(&files[0].0))
            }
        };
        within(&format!("{self:?}"), self.len(), || compile(settings(project)))
    }
}

fn formatted(text: &str) -> String {
    parsed(text).map_or_else(|| text.to_owned(), |document| format(&document, 60))
}

fn write(folder: &Path, files: &Files) {
    let _ = fs::remove_dir_all(folder);
    for (path, text) in files {
        let path = folder.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
}

/// The diagnostics of a fleet without their places, in order.
pub(crate) fn kinds<T>(fleet: &Compilation<T>) -> Vec<String> {
    let mut all: Vec<String> = fleet.diagnostics.iter().map(kind).collect();
    all.sort_unstable();
    all
}

/// A diagnostic without its places.
pub(crate) fn kind(one: &Diagnostic) -> String {
    let labels = one.labels.iter().map(|label| label.text.as_str());
    let suggestions = one.suggestions.iter().map(|one| one.description.as_str());
    let more: Vec<&str> = one.help.iter().map(String::as_str).chain(labels).chain(suggestions).collect();
    let set = one.set.as_ref().map(|set| (set.level, &set.reason));
    format!("{} {:?} {set:?} {} {more:?}", one.code.id, one.severity, one.message)
}
