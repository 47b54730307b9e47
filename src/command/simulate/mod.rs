//! `saoms simulate`: many runs of a fleet in virtual time, each with another seed, held to the invariants of its
//! components.

mod crew;
mod ending;
mod one;
mod shrink;
mod table;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use saoms_lang::diagnostic::Severity;
use saoms_lang::project::INPUT;

use super::run::faults::{FaultScript, Known, report_wrong};
use crate::Exit;
use crate::arguments::{FleetArguments, duration};
use crate::fleet::{DiagnosticReport, compiled};
use crate::output::{counted, eprint, eprint_coloured, print, print_json};
use one::Simulation;
use table::Table;

const EXIT_CODES: &str = "\
Exit codes:
  0    all runs kept the invariants, and none failed
  1    a run violated an invariant or failed, or the result could not be written
  2    the input is wrong: a composite, a value, a file of faults or the command line; nothing was started
  130  ended by Ctrl-C, SIGTERM or SIGHUP";

/// Run a fleet in virtual time with many seeds, and hold each run to the invariants of its components
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct SimulateArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,

    /// The number of seeds, one run for each; the first one and each tenth after it run twice, for the same trace
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub(crate) seeds: u64,

    /// The first seed; the others follow
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    pub(crate) first: u64,

    /// Put the faults of this file into each run, as `saoms run --faults` does
    #[arg(long, value_name = "FILE")]
    pub(crate) faults: Option<PathBuf>,

    /// End each run after this time of its own (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long = "for", value_name = "DURATION", default_value = "1h", allow_hyphen_values = true, value_parser = duration)]
    pub(crate) limit: Duration,

    /// The number of processes; without it, one for each core
    #[arg(short, long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,

    /// The format of the result on standard output
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t = ReportFormat::Human)]
    pub(crate) report: ReportFormat,

    /// Run the seeds that come on standard input: what a process of `saoms simulate` does
    #[arg(long, hide = true)]
    pub(crate) worker: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReportFormat {
    Human,
    Json,
}

pub(crate) fn simulate(arguments: &SimulateArguments) -> Exit {
    if arguments.fleet.files.iter().any(|path| path == Path::new(INPUT)) {
        eprint("error: several processes read the composites, which standard input cannot be\n  = help: name a file\n");
        return Exit::WrongInput;
    }
    if !arguments.worker {
        ending::end_at_signals();
    }
    let simulation = match simulation(arguments) {
        Ok(simulation) => simulation,
        Err(exit) => return exit,
    };
    if arguments.worker {
        crew::work(&simulation);
        return Exit::Done;
    }
    let began = Instant::now();
    let last = arguments.first.saturating_add(arguments.seeds - 1);
    let results = match crew::run(arguments, arguments.first..=last) {
        Ok(results) => results,
        Err(why) => {
            eprint(&format!("error: {why}\n"));
            return Exit::Failed;
        }
    };
    let table = Table::of(arguments, results, began.elapsed(), &simulation);
    match arguments.report {
        ReportFormat::Human => print(&table),
        ReportFormat::Json => print_json(&table.json()),
    }
    if table.is_clean() { Exit::Done } else { Exit::Failed }
}

/// What each process runs. Mistakes are shown.
fn simulation(arguments: &SimulateArguments) -> Result<Simulation, Exit> {
    let compilation = compiled(&arguments.fleet, |project, classes| project.to_start().compile(classes))?;
    let shown = DiagnosticReport::from(&compilation);
    if !arguments.worker {
        eprint_coloured(&shown.human(Severity::Warning));
    }
    let errors = shown.count(Severity::Error);
    let Some(assembly) = compilation.output else {
        eprint(&format!("\n{}: nothing was started\n", counted(errors, "error")));
        return Err(Exit::WrongInput);
    };
    let known = Known::of(&assembly);
    let script = match &arguments.faults {
        Some(path) => Some(FaultScript::read(path).ok_or(Exit::WrongInput)?),
        None => None,
    };
    if let Some(Err(wrong)) = script.as_ref().map(|script| script.events(&known, arguments.first)) {
        report_wrong(&wrong);
        return Err(Exit::WrongInput);
    }
    Ok(Simulation { assembly, known, script, limit: arguments.limit, first: arguments.first })
}
