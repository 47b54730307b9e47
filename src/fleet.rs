//! From composite files to an assembly, or to the diagnostics that say why there is none.

use std::io::IsTerminal;
use std::path::PathBuf;

use saoms_core::assembly::Assembly;
use saoms_core::check::{Options, Setting, SeveritySetting, Variable, check};
use saoms_core::diagnostic::{Diagnostic, Diagnostics, Severity, human, json, sarif};
use saoms_core::load::{load_file, load_named, read, read_values};
use saoms_core::model::{Composite, Contribution};
use saoms_core::plugin::{Search, open_named};
use saoms_core::registry::Registry;
use saoms_core::source::Sources;
use serde_json::Value;

use crate::Exit;
use crate::arguments::FleetArguments;
use crate::plugins::{registry, search};

/// The outcome of loading and checking.
pub(crate) struct Checked {
    /// What is to run; absent where there was an error.
    pub(crate) assembly: Option<Assembly>,
    contribution: Contribution,
    pub(crate) sources: Sources,
    /// Those that are kept for the record alone among them.
    diagnostics: Vec<Diagnostic>,
}

/// Loads the files and checks them as one fleet, as it is asked.
///
/// # Errors
/// A plugin cannot be used, which was told.
pub(crate) fn checked(arguments: &FleetArguments, asked: Options) -> Result<Checked, Exit> {
    let registry = registry(&arguments.plugins, &arguments.files)?;
    let mut sources = Sources::new();
    let mut diagnostics = Diagnostics::new();
    let settings = arguments.settings.iter();
    let settings: Vec<Setting> =
        settings.filter_map(|text| Setting::parse("--set", text, &mut sources, &mut diagnostics)).collect();
    let severities = arguments.severities.iter();
    let severities = severities
        .filter_map(|text| SeveritySetting::parse("--severity", text, &mut sources, &mut diagnostics))
        .collect();
    let options = Options { settings, severities, ..asked };
    let search = search(&arguments.plugins, &arguments.files);
    Ok(checked_with(&arguments.files, arguments.max_size, options, registry, &search, sources, diagnostics))
}

/// The same with these classes and those of the libraries that the composites name; what was read and found before is kept.
pub(crate) fn checked_with(
    files: &[PathBuf],
    max_size: u64,
    options: Options,
    mut registry: Registry,
    search: &Search,
    mut sources: Sources,
    mut diagnostics: Diagnostics,
) -> Checked {
    let mut composites = Vec::new();
    for path in files {
        let file = read(path, max_size, &mut sources, &mut diagnostics);
        let Some(mut composite) = file.and_then(|file| load_file(file, &sources, &mut diagnostics)) else {
            continue;
        };
        read_values(&mut composite, max_size, &mut sources, &mut diagnostics);
        composites.push(composite);
    }
    let mut contribution = Contribution::of(composites);
    load_named(&mut contribution, max_size, &mut sources, &mut diagnostics);
    open_named(&mut contribution, search, &sources, &mut registry);
    let variables =
        Variable::read(&contribution, |name| std::env::var_os(name), &mut sources, &mut diagnostics);
    let options = Options { variables, ..options };
    let assembly = check(&contribution, &registry, &options, &sources, &mut diagnostics);
    Checked { assembly, contribution, sources, diagnostics: diagnostics.into_all() }
}

impl Checked {
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
    pub(crate) fn human(&self, least: Severity) -> String {
        let shown: Vec<Diagnostic> = self.told().filter(|one| one.severity >= least).cloned().collect();
        human(&shown, &self.sources, std::io::stderr().is_terminal())
    }

    /// All diagnostics as one JSON object.
    pub(crate) fn json(&self) -> Value {
        json(&self.diagnostics, &self.sources)
    }

    /// All diagnostics as a SARIF log.
    pub(crate) fn sarif(&self) -> Value {
        sarif(&self.diagnostics, &self.sources, env!("CARGO_PKG_VERSION"))
    }

    /// How many diagnostics are of this severity.
    pub(crate) fn count(&self, severity: Severity) -> usize {
        self.told().filter(|one| one.severity == severity).count()
    }
}
