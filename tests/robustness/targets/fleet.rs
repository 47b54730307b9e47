//! What has to hold for whatever files a fleet has.

use std::fs;
use std::path::Path;

use saoms_core::assembly::{Assembly, expanded};
use saoms_core::check::{Options, Setting, Variable, check};
use saoms_core::diagnostic::{Diagnostic, Diagnostics, Severity, human};
use saoms_core::format::format;
use saoms_core::load::{MAX_SIZE, load, load_named};
use saoms_core::model::Contribution;
use saoms_core::registry::Registry;
use saoms_core::source::Sources;
use tempfile::TempDir;

use super::{draw, parsed, show};

/// The files of a fleet, each a path and a text; the first is the composite that is asked for.
pub(crate) type Files = Vec<(String, String)>;

/// Values from outside, for composite properties that the fleet may have.
const SETTINGS: &[&str] = &["p=2", "site=north"];

/// Checks a fleet as the command does, and draws it.
///
/// The same is found when it is checked again, and when its files are formatted. What it comes to is written out, and comes to the same.
pub(crate) fn holds(files: &Files, registry: &Registry) {
    let fleet = Checked::of(files, &[], Options::default(), registry);
    let again = Checked::of(files, &[], Options::default(), registry);
    show(&fleet.diagnostics, &fleet.sources);
    assert!(fleet.diagnostics == again.diagnostics, "{}{}{files:#?}", fleet.told(), again.told());
    let all = &fleet.diagnostics;
    assert_eq!(fleet.assembly.is_none(), all.iter().any(is_error), "{}", fleet.told());
    draw(&fleet.contribution, registry, &fleet.sources);

    let formatted = files.iter().map(|(path, text)| (path.clone(), formatted(text))).collect();
    let of_formatted = Checked::of(&formatted, &[], Options::default(), registry);
    assert_eq!(fleet.kinds(), of_formatted.kinds(), "{formatted:#?}");

    Checked::of(
        files,
        SETTINGS,
        Options { assume_classes: true, wiring: true, ..Options::default() },
        registry,
    );
    let Some(assembly) = &fleet.assembly else { return };
    let text = fleet.expanded(assembly);
    let alone = Checked::of(
        &vec![("expanded.composite".to_owned(), text.clone())],
        &[],
        Options::default(),
        registry,
    );
    assert!(alone.assembly.is_some(), "{}{files:#?}{text}", alone.told());
    let Some(other) = &alone.assembly else { return };
    assert_eq!(facts(assembly), facts(other), "{files:#?}{text}");
    assert_eq!(text, alone.expanded(other), "{files:#?}");
}

fn is_error(diagnostic: &Diagnostic) -> bool {
    diagnostic.severity == Severity::Error && !diagnostic.is_allowed()
}

fn formatted(text: &str) -> String {
    parsed(text).map_or_else(|| text.to_owned(), |document| format(&document, 60))
}

/// An assembly without the declarations of its classes.
fn facts(assembly: &Assembly) -> Vec<String> {
    let fact = |one: &saoms_core::assembly::ComponentSpec| {
        let loops = one.loops.iter().map(|one| (&one.name, one.class.name(), &one.values));
        let loops: Vec<_> = loops.collect();
        let (class, library) = (one.class.name(), &one.library);
        format!(
            "{} {class} {library:?} {:?} {:?} {:?} {loops:?}",
            one.path, one.values, one.task, one.references
        )
    };
    assembly.components.iter().map(fact).collect()
}

/// A fleet that was loaded and checked.
struct Checked {
    contribution: Contribution,
    sources: Sources,
    assembly: Option<Assembly>,
    /// Those that are kept for the record alone among them.
    diagnostics: Vec<Diagnostic>,
}

impl Checked {
    fn of(files: &Files, settings: &[&str], options: Options, registry: &Registry) -> Self {
        thread_local! {
            static FOLDER: TempDir = tempfile::tempdir().unwrap();
        }
        FOLDER.with(|folder| {
            let folder = folder.path().join("fleet");
            write(&folder, files);
            Self::of_file(&folder.join(&files[0].0), settings, options, registry)
        })
    }

    fn of_file(path: &Path, settings: &[&str], options: Options, registry: &Registry) -> Self {
        let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
        let settings =
            settings.iter().filter_map(|text| Setting::parse("--set", text, &mut sources, &mut diagnostics));
        let settings = settings.collect();
        let composite = load(path, &mut sources, &mut diagnostics);
        let mut contribution = Contribution::of(composite.into_iter().collect());
        load_named(&mut contribution, MAX_SIZE, &mut sources, &mut diagnostics);
        let variables = Variable::read(&contribution, |_| Some("3".into()), &mut sources, &mut diagnostics);
        let options = Options { settings, variables, ..options };
        let assembly = check(&contribution, registry, &options, &sources, &mut diagnostics);
        let diagnostics = diagnostics.into_all();
        Self { contribution, sources, assembly, diagnostics }
    }

    fn told(&self) -> String {
        human(&self.diagnostics, &self.sources, false)
    }

    /// What is found, wherever it is.
    fn kinds(&self) -> Vec<String> {
        let mut all: Vec<String> = self
            .diagnostics
            .iter()
            .map(|one| format!("{} {:?} {}", one.code.id, one.severity, one.message))
            .collect();
        all.sort_unstable();
        all
    }

    fn expanded(&self, assembly: &Assembly) -> String {
        expanded(assembly, &self.contribution.asked_for()[0], &self.diagnostics)
    }
}

fn write(folder: &Path, files: &Files) {
    let _ = fs::remove_dir_all(folder);
    for (path, text) in files {
        let path = folder.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
}
