//! `saoms report`: the report of a run that did not come to write it, from its journal.

use std::path::PathBuf;

use clap::Args;
use saoms_api::Time;
use saoms_api::host::one_line;
use saoms_core::adaptation::{Adaptations, Samples};
use saoms_core::journal::{JournalDocument, JournalSource};
use serde_json::{Value, json};

use super::why::document;
use crate::Exit;
use crate::output::{Outputs, eprint, print_json};

const EXIT_CODES: &str = "\
Exit codes:
  0  printed
  1  standard output could not be written
  2  the input is wrong: a file without journal, or a report";

/// Rebuild the report of a run that crashed or was killed, from its journal
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ReportArguments {
    /// The file of `saoms run --journal`; `-` is standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) from_journal: PathBuf,
}

/// What the report of a run holds beside, by the names of its fields: only the program knew it.
const UNKNOWN: [&str; 8] = [
    "periods",
    "components: class, executions, missed, late_us, deadline_misses, slow, restarts, replaced, failures, dropped, messages",
    "the sections of components",
    "journal.loops: without_effect",
    "adaptation: throughput",
    "votes and standstill",
    "outcome.status",
    "trace_hash",
];

pub(crate) fn report(arguments: &ReportArguments) -> Exit {
    let path = arguments.from_journal.as_path();
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
