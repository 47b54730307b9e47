//! `saoms journal`: what the loops of a component recorded.

use std::thread;
use std::time::Duration;

use clap::Args;
use saoms_api::host::one_line;
use saoms_control::Response;
use saoms_core::journal::JournalEntry;
use serde_json::Value;

use super::fleet::{RunningFleetArguments, escape};
use crate::Exit;
use crate::arguments::Format;
use crate::output::{print, print_json_line};

const EXIT_CODES: &str = "\
Exit codes:
  0  shown; with --follow, the fleet has ended
  1  it could not be written
  2  there is no such component, no fleet runs, or it is not clear which one is meant";

/// Time between two questions for new records.
const EVERY: Duration = Duration::from_millis(500);
/// The most new records of that time.
const MOST: usize = 10_000;

/// Show what the loops of a component in a running fleet recorded: symptoms, decisions and effects
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct JournalArguments {
    /// The component: its path, a unique ending of its path, or its ID
    #[arg(value_name = "COMPONENT")]
    component: String,

    /// Continue with new records as they are written, until the fleet ends
    #[arg(long, short)]
    follow: bool,

    /// The number of earlier records to show
    #[arg(long, short = 'n', value_name = "N", default_value_t = 100)]
    lines: usize,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

pub(crate) fn journal(arguments: &JournalArguments) -> Exit {
    let client = match arguments.fleet.client() {
        Ok(client) => client,
        Err(exit) => return exit,
    };
    let records = |after: u64, most: usize| {
        let path = format!("/v1/journal?component={}&after={after}&lines={most}", escape(&arguments.component));
        client.request("GET", &path, "").and_then(Response::json)
    };
    let mut found = match records(0, arguments.lines) {
        Ok(found) => found,
        Err(error) => return arguments.fleet.refuse(&error.to_string(), Exit::WrongInput),
    };
    let mut last = 0;
    loop {
        for record in found.as_array().into_iter().flatten() {
            last = record["id"].as_u64().unwrap_or(last);
            show(record, arguments);
        }
        if !arguments.follow || crate::output::has_failed() {
            return Exit::Done;
        }
        thread::sleep(EVERY);
        // A fleet that does not answer any more has ended.
        let Ok(new) = records(last, MOST) else { return Exit::Done };
        found = new;
    }
}

fn show(record: &Value, arguments: &JournalArguments) {
    match arguments.fleet.format {
        Format::Json => print_json_line(record),
        Format::Human => {
            if let Ok(entry) = serde_json::from_value::<JournalEntry>(record.clone()) {
                print(&format!("{}\n", one_line(&entry.to_string())));
            }
        }
    }
}
