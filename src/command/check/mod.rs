//! `saoms check`: finds every mistake, starts nothing.

mod stops;
mod wiring;

use std::path::Path;

use clap::{Args, ValueEnum};
use saoms_lang::diagnostic::Severity;
use saoms_lang::project::{Compilations, FleetOutput};
use serde::Serialize;
use serde::ser::Serializer;

use crate::Exit;
use crate::arguments::FleetArguments;
use crate::fleet::{DiagnosticReport, project};
use crate::output::{Outputs, counted, displayed, eprint_coloured, print, print_json};
use crate::plugins::{CommandClasses, search, usable};
use wiring::Wiring;

const EXIT_CODES: &str = "\
Exit codes:
  0  no error; there may be warnings and notes
  1  standard output could not be written
  2  an error in a composite, a value or the command line; a file cannot be read, or a plugin cannot be used";

/// Check composites without running anything
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,

    /// Format of diagnostics: for people on standard error, or on standard output as one JSON object or as SARIF 2.1.0
    #[arg(long, value_enum, default_value_t = CheckFormat::Human)]
    pub(crate) format: CheckFormat,

    /// Accept unknown classes and other kinds of implementations, and check everything that can be checked without them
    #[arg(long)]
    pub(crate) assume_classes: bool,

    /// Report the wiring of the whole fleet: which components publish and read each topic, how often, and what is
    /// unusual
    #[arg(long, conflicts_with = "assume_classes")]
    pub(crate) wiring: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CheckFormat {
    Human,
    Json,
    Sarif,
}

pub(crate) fn check(arguments: &CheckArguments) -> Exit {
    let classes = match CommandClasses::new(&arguments.fleet.plugins) {
        Ok(classes) => classes,
        Err(exit) => return exit,
    };
    let project = project(&arguments.fleet).assume_classes(arguments.assume_classes).wiring(arguments.wiring);
    let found = project.compile_each(&classes);
    let Compilations { outputs, fleets, problems, sources, .. } = &found;
    let files = &arguments.fleet.files;
    let read = sources.open().files_read().into_iter().chain(files.iter().cloned());
    let read = read.chain(search(&arguments.fleet.plugins, files).files());
    if let Err(exit) = usable(problems).and_then(|()| Outputs::beside(read).with_streams()) {
        return exit;
    }
    let shown = DiagnosticReport::from(&found);
    let wired = outputs.iter().filter(|_| arguments.wiring);
    let wired = wired.map(|FleetOutput { file, output }| (file.as_path(), Wiring(output)));
    let wired: Vec<(&Path, Wiring<'_>)> = wired.collect();
    let wiring = (!wired.is_empty()).then_some(Wired { of: &wired, is_one: *fleets == 1 });
    match arguments.format {
        CheckFormat::Json => print_json(&shown.json(wiring)),
        CheckFormat::Sarif => print_json(&shown.sarif(wiring.map(|wiring| Properties { wiring }))),
        CheckFormat::Human => {
            eprint_coloured(&shown.human(Severity::Note));
            for (path, wiring) in &wired {
                if *fleets > 1 {
                    print(&format!("{}\n", displayed(path)));
                }
                print(wiring);
            }
            let errors = counted(shown.count(Severity::Error), "error");
            let warnings = counted(shown.count(Severity::Warning), "warning");
            let components = outputs.iter().map(|one| one.output.components.len()).sum();
            let components = counted(components, "component");
            print(&match (*fleets, outputs.len()) {
                (2.., _) => format!("{fleets} fleets, {components}: {errors}, {warnings}\n"),
                (_, 1) => format!("{components}: {errors}, {warnings}\n"),
                _ => format!("{errors}, {warnings}\n"),
            });
        }
    }
    if shown.count(Severity::Error) == 0 { Exit::Done } else { Exit::WrongInput }
}

/// Additional properties in the log of `--format sarif`.
#[derive(Serialize)]
struct Properties<'a> {
    wiring: Wired<'a>,
}

/// Wiring of several fleets, each by its first file, or of a single fleet.
struct Wired<'a> {
    of: &'a [(&'a Path, Wiring<'a>)],
    is_one: bool,
}

impl Serialize for Wired<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.of {
            [(_, only)] if self.is_one => only.serialize(to),
            all => to.collect_map(all.iter().map(|(path, wiring)| (path.display().to_string(), wiring))),
        }
    }
}
