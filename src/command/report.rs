//! `saoms report`: the report of a run that did not come to write it, from its journal; one report of those of all
//! nodes of a fleet.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use saoms_api::Time;
use saoms_api::host::one_line;
use saoms_core::adaptation::{Adaptations, Samples};
use saoms_core::journal::{JournalDocument, JournalSource};
use saoms_core::report::{RunReport, merge};
use serde_json::{Value, json};

use super::why::{document, named, text};
use crate::Exit;
use crate::output::{Outputs, eprint, print_json};

const EXIT_CODES: &str = "\
Exit codes:
  0  printed
  1  standard output could not be written
  2  the input is wrong: a file without journal, or a report; or reports that are not of the nodes of one fleet";

/// Rebuild the report of a run that crashed or was killed, from its journal; or join the reports of the nodes of a
/// fleet
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES, args_conflicts_with_subcommands = true, arg_required_else_help = true)]
pub(crate) struct ReportArguments {
    /// The file of `saoms run --journal`; `-` is standard input
    #[arg(long, value_name = "FILE", required = true)]
    pub(crate) from_journal: Option<PathBuf>,

    #[command(subcommand)]
    pub(crate) what: Option<ReportCommand>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum ReportCommand {
    /// Join the reports of the nodes of a fleet to one: counts are added, records of the journals follow from each
    /// other over programs
    #[command(after_help = EXIT_CODES)]
    Merge {
        /// The files of `saoms run --node NAME --report FILE`, of each node one
        #[arg(required = true, num_args = 2.., value_name = "FILE")]
        reports: Vec<PathBuf>,
    },
}

/// What the report of a run holds beside, by the names of its fields: only the program knew it.
const UNKNOWN: [&str; 9] = [
    "periods",
    "components: class, executions, missed, late_us, deadline_misses, slow, restarts, replaced, failures, dropped, messages",
    "the sections of components",
    "journal.loops: without_effect",
    "adaptation: throughput",
    "votes and standstill",
    "outcome.status",
    "recording",
    "trace_hash",
];

pub(crate) fn report(arguments: &ReportArguments) -> Exit {
    if let Some(ReportCommand::Merge { reports }) = &arguments.what {
        return merged_report(reports);
    }
    let Some(path) = arguments.from_journal.as_deref() else { return Exit::WrongInput };
    if let Err(exit) = Outputs::beside([path.to_owned()]).with_streams() {
        return exit;
    }
    let rebuilt = document(path).and_then(|document| match document.source == JournalSource::Report {
        true => Err(format!("`{}` is a report already", path.display())),
        false => Ok(rebuilt(&document)),
    });
    match rebuilt {
        Ok(report) => {
            print_json(&report);
            Exit::Done
        }
        Err(problem) => {
            eprint(&format!("error: {}\n", one_line(&problem)));
            Exit::WrongInput
        }
    }
}

fn merged_report(paths: &[PathBuf]) -> Exit {
    if let Err(exit) = Outputs::beside(paths.iter().cloned()).with_streams() {
        return exit;
    }
    match merged(paths) {
        Ok(report) => {
            print_json(&report);
            Exit::Done
        }
        Err(problem) => {
            eprint(&format!("error: {}\n", one_line(&problem)));
            Exit::WrongInput
        }
    }
}

/// One report of those in these files.
///
/// # Errors
/// One cannot be read, or they are not of the nodes of one fleet.
pub(super) fn merged(paths: &[PathBuf]) -> Result<RunReport, String> {
    let read = |path: &PathBuf| -> Result<RunReport, String> {
        serde_json::from_str(&text(path)?)
            .map_err(|error| format!("{} is not a report of `saoms run --report`: {error}", named(path)))
    };
    let reports = paths.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    merge(reports).map_err(|error| error.named(|place| paths.get(place).map_or_else(String::new, |path| named(path))))
}

fn rebuilt(document: &JournalDocument) -> Value {
    let last = document.journal.entries().last().map_or(Time::START, |entry| entry.time());
    let reason = match document.end {
        Some(_) => "the run ended; the journal does not record its result".to_owned(),
        None => {
            format!(
                "the journal has no end: the run crashed, was killed, or is still running; its last record is at {last}"
            )
        }
    };
    let mut adaptations = Adaptations::default();
    document.components.iter().for_each(|component| adaptations.join(component));
    document.journal.entries().iter().for_each(|entry| adaptations.take(entry));
    json!({
        "seed": document.seed,
        "time_s": document.end.unwrap_or(last).as_secs_f64(),
        "components": document.components,
        "journal": document.journal,
        "adaptation": adaptations.report(&Samples::new(Vec::new())),
        "outcome": { "status": null, "reasons": [reason] },
        "unknown": UNKNOWN,
    })
}
