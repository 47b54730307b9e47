//! From composite files to an assembly, or to the diagnostics that say why there is none.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use saoms_core::plugin::{Search, open_named};
use saoms_lang::assembly::Assembly;
use saoms_lang::check::{Options, Setting, SeveritySetting, Variable};
use saoms_lang::diagnostic::{Diagnostic, Diagnostics, Human, Json, Sarif, Severity};
use saoms_lang::load::{Finder, STANDARD_INPUT, load_file, read, read_from, read_values};
use saoms_lang::model::{Composite, Contribution};
use saoms_lang::registry::Registry;
use saoms_lang::source::{FileId, Sources};
use serde::Serialize;

use crate::Exit;
use crate::arguments::FleetArguments;
use crate::folder;
use crate::plugins::{registry, search};

/// The option that sets composite properties.
pub(crate) const SET: &str = "--set";
/// The option that sets severities.
pub(crate) const SEVERITY: &str = "--severity";
/// The name that stands for standard input.
pub(crate) const INPUT: &str = "-";

/// What the checker is asked for: an assembly ([`saoms_lang::check::check`]), or the diagnostics alone
/// ([`saoms_lang::check::count`]).
pub(crate) type Checker<T> = fn(&Contribution, &Registry, &Options, &Sources, &mut Diagnostics) -> Option<T>;

/// The outcome of loading and checking.
pub(crate) struct Checked<T = Assembly> {
    /// What the checker made: what is to run. Absent where there was an error.
    pub(crate) made: Option<T>,
    pub(crate) contribution: Contribution,
    pub(crate) sources: Sources,
    /// Those that are kept for the record alone among them.
    pub(crate) diagnostics: Vec<Diagnostic>,
}

/// What is told as JSON.
#[derive(Serialize)]
pub(crate) struct Found<'a, W> {
    diagnostics: Json<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wiring: Option<W>,
}

/// Which files are to be loaded, and how they are to be checked.
pub(crate) struct Asked<'a> {
    pub(crate) files: &'a [PathBuf],
    /// The size of a file from which it is refused, in bytes.
    pub(crate) max_size: u64,
    pub(crate) options: Options,
    pub(crate) search: &'a Search,
    /// What finds the composites that they name.
    pub(crate) finder: &'a mut Finder,
}

/// Loads the files and checks them as one fleet, as it is asked. Folders stand for the fleets that run in them.
///
/// # Errors
/// A plugin cannot be used, which was told.
pub(crate) fn checked<T>(
    check: Checker<T>,
    arguments: &FleetArguments,
    asked: Options,
) -> Result<Checked<T>, Exit> {
    let mut sources = Sources::new();
    let mut diagnostics = Diagnostics::new();
    let (paths, max_size) = (&arguments.files, arguments.max_size);
    let mut finder = Finder::new(sources.open().clone());
    let files = folder::one_fleet(paths, max_size, &mut finder, &mut sources, &mut diagnostics);
    let options = options(arguments, asked, &mut sources, &mut diagnostics);
    let registry = registry(&arguments.plugins, &files)?;
    let search = search(&arguments.plugins, &files);
    let asked = Asked { files: &files, max_size, options, search: &search, finder: &mut finder };
    Ok(checked_with(check, asked, registry, sources, diagnostics))
}

/// What the command line says of a check.
pub(crate) fn options(
    arguments: &FleetArguments,
    asked: Options,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> Options {
    let settings = arguments.settings.iter();
    let settings: Vec<Setting> =
        settings.filter_map(|text| Setting::parse(SET, text, sources, diagnostics)).collect();
    let severities = arguments.severities.iter();
    let severities =
        severities.filter_map(|text| SeveritySetting::parse(SEVERITY, text, sources, diagnostics)).collect();
    Options { settings, severities, ..asked }
}

/// Reads a file; `-` is standard input.
pub(crate) fn read_or_input(
    path: &Path,
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> Option<FileId> {
    if path == Path::new(INPUT) {
        return read_from(std::io::stdin().lock(), STANDARD_INPUT, max_size, sources, diagnostics);
    }
    read(path, max_size, sources, diagnostics)
}

/// The same with these classes and those of the libraries that the composites name; what was read and found before is kept.
pub(crate) fn checked_with<T>(
    check: Checker<T>,
    asked: Asked<'_>,
    mut registry: Registry,
    mut sources: Sources,
    mut diagnostics: Diagnostics,
) -> Checked<T> {
    let Asked { files, max_size, options, search, finder } = asked;
    let mut composites = Vec::new();
    for path in files {
        let file = read_or_input(path, max_size, &mut sources, &mut diagnostics);
        let Some(mut composite) = file.and_then(|file| load_file(file, &sources, &mut diagnostics)) else {
            continue;
        };
        read_values(&mut composite, max_size, &mut sources, &mut diagnostics);
        composites.push(composite);
    }
    let mut contribution = Contribution::of(composites);
    finder.load_named(&mut contribution, max_size, &mut sources, &mut diagnostics);
    open_named(&mut contribution, search, &sources, &mut registry);
    let variables =
        Variable::read(&contribution, |name| std::env::var_os(name), &mut sources, &mut diagnostics);
    let options = Options { variables, ..options };
    let made = check(&contribution, &registry, &options, &sources, &mut diagnostics);
    Checked { made, contribution, sources, diagnostics: diagnostics.into_all() }
}

impl<T> Checked<T> {
    /// The first composite that was asked for.
    pub(crate) fn first(&self) -> Option<&Composite> {
        self.contribution.asked_for().first()
    }

    /// All diagnostics, those that are kept for the record alone among them.
    pub(crate) fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// The diagnostics that are not kept for the record alone.
    pub(crate) fn told(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics.iter().filter(|one| !one.is_allowed())
    }

    /// The diagnostics of at least this severity, as people read them.
    pub(crate) fn human(&self, least: Severity) -> Human<'_> {
        let shown = self.told().filter(|one| one.severity >= least);
        Human::of(shown, &self.sources, std::io::stderr().is_terminal())
    }

    /// All diagnostics as JSON, with the wiring where it is asked for.
    pub(crate) fn json<W>(&self, wiring: Option<W>) -> Found<'_, W> {
        Found { diagnostics: Json { diagnostics: &self.diagnostics, sources: &self.sources }, wiring }
    }

    /// All diagnostics as a SARIF log, with properties of the run.
    pub(crate) fn sarif<P>(&self, properties: Option<P>) -> Sarif<'_, P> {
        let version = env!("CARGO_PKG_VERSION");
        Sarif { diagnostics: &self.diagnostics, sources: &self.sources, version, properties }
    }

    /// How many diagnostics are of this severity.
    pub(crate) fn count(&self, severity: Severity) -> usize {
        self.told().filter(|one| one.severity == severity).count()
    }
}
