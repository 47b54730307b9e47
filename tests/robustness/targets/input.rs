//! What is checked: one text, or the files of a fleet.

use std::fs;
use std::path::Path;

use saoms_lang::assembly::{Assembly, expanded};
use saoms_lang::check::{Options, Setting, Variable};
use saoms_lang::contribution::{load, load_named};
use saoms_lang::diagnostic::{Diagnostic, Diagnostics, Severity, human};
use saoms_lang::load::{MAX_SIZE, load_file, read_from};
use saoms_lang::model::Contribution;
use saoms_lang::registry::Registry;
use saoms_lang::source::Sources;
use saoms_tools::format::format;
use tempfile::TempDir;

use super::memory::within;
use super::parsed;

/// The files of a fleet, each a path and a text; the first is the composite that is asked for.
pub(crate) type Files = Vec<(String, String)>;

/// What is checked.
#[derive(Debug)]
pub(crate) enum Input {
    /// One composite, which finds no other.
    Text(String),
    /// Files in a folder.
    Files(Files),
}

/// How it is checked.
#[derive(Clone, Debug, Default)]
pub(crate) struct Asked {
    pub(crate) options: Options,
    /// Values from outside, for composite properties that the fleet may have.
    pub(crate) settings: &'static [&'static str],
}

/// What makes an assembly of a fleet, or something else.
pub(crate) type Checker<T> = fn(&Contribution, &Registry, &Options, &Sources, &mut Diagnostics) -> Option<T>;

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

    /// Loads and checks it, within the memory that it may take.
    pub(crate) fn checked<T>(&self, check: Checker<T>, asked: &Asked, registry: &Registry) -> Checked<T> {
        thread_local! {
            static FOLDER: TempDir = tempfile::tempdir().unwrap();
        }
        let Asked { options, settings } = asked.clone();
        let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
        let settings =
            settings.iter().filter_map(|text| Setting::parse("--set", text, &mut sources, &mut diagnostics));
        let settings = settings.collect();
        let path = FOLDER.with(|folder| folder.path().join("fleet"));
        let path = match self {
            Self::Text(_) => None,
            Self::Files(files) => {
                write(&path, files);
                Some(path.join(&files[0].0))
            }
        };
        within(&format!("{self:?}"), self.len(), || {
            let composite = match (self, path) {
                (Self::Text(text), _) => {
                    let file = read_from(text.as_bytes(), "x", MAX_SIZE, &mut sources, &mut diagnostics);
                    file.and_then(|file| load_file(file, &sources, &mut diagnostics))
                }
                (_, Some(path)) => load(&path, &mut sources, &mut diagnostics),
                _ => None,
            };
            let mut contribution = Contribution::of(composite.into_iter().collect());
            if matches!(self, Self::Files(_)) {
                load_named(&mut contribution, MAX_SIZE, &mut sources, &mut diagnostics);
            }
            let variables =
                Variable::read(&contribution, |_| Some("3".into()), &mut sources, &mut diagnostics);
            let options = Options { settings, variables, ..options };
            let made = check(&contribution, registry, &options, &sources, &mut diagnostics);
            Checked { contribution, sources, made, diagnostics: diagnostics.into_all() }
        })
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

/// A fleet that was loaded and checked.
pub(crate) struct Checked<T> {
    pub(crate) contribution: Contribution,
    pub(crate) sources: Sources,
    pub(crate) made: Option<T>,
    /// Those that are kept for the record alone among them.
    pub(crate) diagnostics: Vec<Diagnostic>,
}

impl<T> Checked<T> {
    /// What people read.
    pub(crate) fn told(&self) -> String {
        human(&self.diagnostics, &self.sources, false)
    }

    pub(crate) fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|one| one.severity == Severity::Error && !one.is_allowed())
    }

    /// What is found, wherever it is.
    pub(crate) fn kinds(&self) -> Vec<String> {
        let mut all: Vec<String> = self.diagnostics.iter().map(kind).collect();
        all.sort_unstable();
        all
    }
}

/// What a diagnostic says, without the places.
pub(crate) fn kind(one: &Diagnostic) -> String {
    let labels = one.labels.iter().map(|label| label.text.as_str());
    let suggestions = one.suggestions.iter().map(|one| one.description.as_str());
    let more: Vec<&str> = one.help.iter().map(String::as_str).chain(labels).chain(suggestions).collect();
    let set = one.set.as_ref().map(|set| (set.level, &set.reason));
    format!("{} {:?} {set:?} {} {more:?}", one.code.id, one.severity, one.message)
}

impl Checked<Assembly> {
    /// What is left when all is resolved, as a composite.
    pub(crate) fn expanded(&self, assembly: &Assembly) -> String {
        expanded(assembly, &self.contribution.asked_for()[0], &self.diagnostics)
    }
}
