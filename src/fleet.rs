//! The fleet of a command line: its project, and how diagnostics of it are shown.

use std::env;
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use saoms_lang::assembly::Assembly;
use saoms_lang::diagnostic::{Diagnostic, Severity};
use saoms_lang::project::{Compilation, Compilations, INPUT, Project};
use saoms_lang::source::Sources;
use saoms_tools::diagnostics::{Human, Sarif, json, sarif};
use serde::Serialize;
use serde_json::Value;

use crate::Exit;
use crate::arguments::FleetArguments;
use crate::output::{Outputs, eprint};
use crate::plugins::{CommandClasses, search, usable};

/// The project of a command line.
pub(crate) fn project(arguments: &FleetArguments) -> Project {
    Project::new()
        .files(&arguments.files)
        .set_all(&arguments.settings)
        .severities(&arguments.severities)
        .environment(|name| env::var_os(name))
        .max_size(arguments.max_size)
        .allow_outside(arguments.allow_outside)
}

/// Takes a step with a project and the classes of a command line.
///
/// # Errors
/// A plugin cannot be used, or standard output is a file that was read: it was reported.
pub(crate) fn compiled<T>(
    arguments: &FleetArguments,
    step: impl FnOnce(Project, &CommandClasses<'_>) -> Compilation<T>,
) -> Result<Compilation<T>, Exit> {
    let classes = CommandClasses::new(&arguments.plugins)?;
    let compilation = step(project(arguments), &classes);
    usable(&compilation.problems)?;
    Outputs::beside(files_read(&compilation, arguments)).with_streams()?;
    Ok(compilation)
}

/// True if a fleet has components. One without any is reported; `to_do` is what is done with a fleet, such as `run`.
pub(crate) fn has_components(assembly: &Assembly, to_do: &str) -> bool {
    if assembly.components.is_empty() {
        eprint(&format!(
            "error: this fleet has no components: there is nothing to {to_do}\n  = help: add a `<component name=\"...\">` \
            to its composite, or name another composite; `saoms new site` makes one to start from\n\n1 error: nothing was \
            started\n"
        ));
    }
    !assembly.components.is_empty()
}

/// The files that a compilation read, of composites and of plugins: no output may go there.
pub(crate) fn files_read<T>(of: &Compilation<T>, arguments: &FleetArguments) -> Vec<PathBuf> {
    let asked_for = of.contribution.asked_for().iter().map(|one| of.sources.get(one.file()).path().into());
    let mut all = of.sources.open().files_read();
    all.extend(search(&arguments.plugins, &asked_for.collect::<Vec<PathBuf>>()).files());
    all.extend(of.registry.origins().map(Path::to_owned));
    all.extend(arguments.files.iter().filter(|path| *path == Path::new(INPUT)).cloned());
    all
}

/// Diagnostics as they are shown.
#[derive(Clone, Copy)]
pub(crate) struct DiagnosticReport<'a> {
    diagnostics: &'a [Diagnostic],
    sources: &'a Sources,
}

/// The JSON object of a command.
#[derive(Serialize)]
pub(crate) struct Found<W> {
    diagnostics: Vec<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wiring: Option<W>,
}

impl<'a, T> From<&'a Compilation<T>> for DiagnosticReport<'a> {
    fn from(of: &'a Compilation<T>) -> Self {
        Self { diagnostics: &of.diagnostics, sources: &of.sources }
    }
}

impl<'a> From<&'a Compilations> for DiagnosticReport<'a> {
    fn from(of: &'a Compilations) -> Self {
        Self { diagnostics: &of.diagnostics, sources: &of.sources }
    }
}

impl<'a> DiagnosticReport<'a> {
    /// The diagnostics but for those that are allowed.
    fn reported(self) -> impl Iterator<Item = &'a Diagnostic> {
        self.diagnostics.iter().filter(|one| !one.is_allowed())
    }

    /// The diagnostics of at least this severity, as people read them.
    pub(crate) fn human(self, least: Severity) -> Human<'a> {
        self.human_in(least, io::stderr().is_terminal())
    }

    /// The same, in colours where somebody else shows them.
    pub(crate) fn human_in(self, least: Severity, coloured: bool) -> Human<'a> {
        Human::of(self.reported().filter(|one| one.severity >= least), self.sources, coloured)
    }

    /// All diagnostics as values of JSON.
    pub(crate) fn values(self) -> Vec<Value> {
        json(self.diagnostics, self.sources)
    }

    /// All diagnostics as JSON, with the wiring where it is asked for.
    pub(crate) fn json<W>(self, wiring: Option<W>) -> Found<W> {
        Found { diagnostics: json(self.diagnostics, self.sources), wiring }
    }

    /// All diagnostics as a SARIF log, with properties of the run.
    pub(crate) fn sarif<P>(self, properties: Option<P>) -> Sarif<P> {
        sarif(self.diagnostics, self.sources, env!("CARGO_PKG_VERSION"), properties)
    }

    /// The number of diagnostics of this severity.
    pub(crate) fn count(self, severity: Severity) -> usize {
        self.reported().filter(|one| one.severity == severity).count()
    }
}
