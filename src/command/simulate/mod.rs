//! `saoms simulate`: many runs of a fleet in virtual time, each with another seed, held to the invariants of its
//! components.

mod compare;
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
use crate::arguments::{FleetArguments, duration, setting_of};
use crate::fleet::{DiagnosticReport, compiled, has_components};
use crate::output::{counted, eprint, eprint_coloured, print, print_json};
use compare::Comparison;
use one::Simulation;
use table::{Table, named};

const EXIT_CODES: &str = "\
Exit codes:
  0    all runs kept the invariants, and none failed
  1    a run violated an invariant or failed, or the result could not be written
  2    the input is wrong: a composite, a value, a file of faults or the command line; nothing was started
  130  ended by Ctrl-C, SIGTERM or SIGHUP";

/// Greatest number of seeds.
const MOST_SEEDS: u64 = 10_000_000;

/// Greatest first seed, so that all seeds are numbers.
const LAST_FIRST: u64 = u64::MAX - MOST_SEEDS;

/// Run a fleet in virtual time with many seeds, and hold each run to the invariants of its components
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct SimulateArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,

    /// The number of seeds, one run for each; the first one and each tenth after it run twice, for the same trace
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=MOST_SEEDS))]
    pub(crate) seeds: u64,

    /// The first seed; the others follow
    #[arg(long, value_name = "SEED", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=LAST_FIRST))]
    pub(crate) first: u64,

    /// Run the fleet of this composite with the same seeds, too, and compare both, with how they adapt; may be repeated
    #[arg(long, value_name = "FILE")]
    pub(crate) against: Vec<PathBuf>,

    /// Set the value of a composite property in the other fleet; without `--against`, that is the same composite. Other
    /// values of `--set` are those of both fleets; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = setting_of_other)]
    pub(crate) against_set: Vec<String>,

    /// Put the faults of this file into each run, as `saoms run --faults` does
    #[arg(long, value_name = "FILE")]
    pub(crate) faults: Option<PathBuf>,

    /// End each run after this time of its own (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long = "for", value_name = "DURATION", default_value = "1h", allow_hyphen_values = true, value_parser = limit)]
    pub(crate) limit: Duration,

    /// The number of processes; without it, one for each core
    #[arg(short, long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,

    /// The format of the result on standard output
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t = ReportFormat::Human)]
    pub(crate) report: ReportFormat,

    /// Run the seeds that come on standard input: what a process of `saoms simulate` does
    #[arg(long, hide = true, value_enum, value_name = "SIDE")]
    pub(crate) worker: Option<Side>,
}

/// The fleets of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Side {
    One,
    Other,
}

impl Side {
    fn word(self) -> &'static str {
        match self {
            Side::One => "one",
            Side::Other => "other",
        }
    }
}

/// A setting of the other fleet, which has to be one argument.
fn setting_of_other(text: &str) -> Result<String, String> {
    setting_of("--against-set", text)
}

impl SimulateArguments {
    /// The fleet to compare with, if there is one.
    fn other(&self) -> Option<FleetArguments> {
        if self.against.is_empty() && self.against_set.is_empty() {
            return None;
        }
        let mut fleet = self.fleet.clone();
        if !self.against.is_empty() {
            fleet.files.clone_from(&self.against);
        }
        let name = |setting: &str| setting.split('=').next().unwrap_or_default().to_owned();
        let replaced: Vec<String> = self.against_set.iter().map(|one| name(one)).collect();
        fleet.settings.retain(|one| !replaced.contains(&name(one)));
        fleet.settings.extend(self.against_set.iter().cloned());
        Some(fleet)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReportFormat {
    Human,
    Json,
}

pub(crate) fn simulate(arguments: &SimulateArguments) -> Exit {
    let other = arguments.other();
    let fleets = || [Some(&arguments.fleet), other.as_ref()].into_iter().flatten();
    if fleets().any(|fleet| fleet.files.iter().any(|path| path == Path::new(INPUT))) {
        eprint("error: several processes read the composites, which standard input cannot be\n  = help: name a file\n");
        return Exit::WrongInput;
    }
    if let Some(side) = arguments.worker {
        let fleet = other.as_ref().filter(|_| side == Side::Other).unwrap_or(&arguments.fleet);
        return match simulation(arguments, fleet) {
            Ok(simulation) => {
                crew::work(&simulation);
                Exit::Done
            }
            Err(exit) => exit,
        };
    }
    ending::end_at_signals();
    // The mistakes of both are shown before anything starts.
    let simulations: Vec<_> = fleets().map(|fleet| simulation(arguments, fleet).map(|one| (fleet, one))).collect();
    let simulations = match simulations.into_iter().collect::<Result<Vec<_>, Exit>>() {
        Ok(simulations) => simulations,
        Err(exit) => return exit,
    };
    // The ranges of both leave room for all seeds.
    let last = arguments.first + (arguments.seeds - 1);
    let tables = simulations.iter().zip([Side::One, Side::Other]).map(|((fleet, simulation), side)| {
        let began = Instant::now();
        let runs = crew::run(arguments, side, arguments.first..=last)?;
        Ok(Table::of((arguments, fleet), runs, began.elapsed(), simulation))
    });
    let tables = match tables.collect::<Result<Vec<Table>, String>>() {
        Ok(tables) => tables,
        Err(why) => {
            eprint(&format!("error: {why}\n"));
            return Exit::Failed;
        }
    };
    match (&tables[..], &other) {
        ([one, two], Some(other)) => {
            let comparison = Comparison::of([named(&arguments.fleet), named(other)], [one, two]);
            match arguments.report {
                ReportFormat::Human => print(&comparison),
                ReportFormat::Json => print_json(&comparison.json()),
            }
        }
        (tables, _) => tables.iter().for_each(|table| match arguments.report {
            ReportFormat::Human => print(table),
            ReportFormat::Json => print_json(&table.json()),
        }),
    }
    if tables.iter().all(Table::is_clean) { Exit::Done } else { Exit::Failed }
}

/// The time of a run, in which something can happen.
fn limit(text: &str) -> Result<Duration, String> {
    match duration(text)? {
        Duration::ZERO => Err("nothing happens in no time: write a longer one, such as `10min`".to_owned()),
        limit => Ok(limit),
    }
}

/// What each process runs of a fleet. Mistakes are shown.
fn simulation(arguments: &SimulateArguments, fleet: &FleetArguments) -> Result<Simulation, Exit> {
    let compilation = compiled(fleet, |project, classes| project.to_start().compile(classes))?;
    let shown = DiagnosticReport::from(&compilation);
    if arguments.worker.is_none() {
        eprint_coloured(&shown.human(Severity::Warning));
    }
    let errors = shown.count(Severity::Error);
    let Some(assembly) = compilation.output else {
        eprint(&format!("\n{}: nothing was started\n", counted(errors, "error")));
        return Err(Exit::WrongInput);
    };
    if !has_components(&assembly, "simulate") {
        return Err(Exit::WrongInput);
    }
    let known = Known::of(&assembly, &fleet.severities);
    let script = match &arguments.faults {
        Some(path) => Some(FaultScript::read(path).ok_or(Exit::WrongInput)?),
        None => None,
    };
    match script.as_ref().map(|script| script.events(&known, arguments.first)) {
        Some(Err(wrong)) => {
            if arguments.other().is_some() {
                eprint(&format!("in the fleet of {}:\n", named(fleet)));
            }
            report_wrong(&wrong);
            return Err(Exit::WrongInput);
        }
        Some(Ok(planned)) if arguments.worker.is_none() => eprint(&planned.lowered.concat()),
        _ => {}
    }
    let is_measured = arguments.other().is_some();
    Ok(Simulation { assembly, known, script, limit: arguments.limit, first: arguments.first, is_measured })
}
