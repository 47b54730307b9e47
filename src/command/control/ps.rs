//! `saoms ps`: the fleets that run on this machine.

use std::time::{SystemTime, UNIX_EPOCH};

use clap::Args;
use saoms_api::host::one_line;
use saoms_control::running;
use serde_json::{Value, json};

use super::table::Table;
use crate::Exit;
use crate::arguments::Format;
use crate::output::{print, print_json};

const EXIT_CODES: &str = "\
Exit codes:
  0  listed, also if no fleet runs
  1  the list could not be written
  2  the command line is wrong";

/// List the fleets that run on this machine
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct PsArguments {
    /// The format of the list: for people, or JSON
    #[arg(long, value_enum, default_value_t = Format::Human)]
    format: Format,
}

pub(crate) fn ps(arguments: &PsArguments) -> Exit {
    let fleets = running();
    if arguments.format == Format::Json {
        let fleet = |(client, one): &(saoms_control::Client, saoms_control::FleetDescription)| {
            let mut value = json!(one);
            value["socket"] = Value::from(client.place());
            value
        };
        print_json(&fleets.iter().map(fleet).collect::<Vec<Value>>());
        return Exit::Done;
    }
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
    let mut table = Table::new(&["NAME", "PID", "RUNS FOR", "COMPOSITES"]);
    for (_, one) in &fleets {
        let runs_for = format!("{} s", now.saturating_sub(one.started));
        table.row(
            [&one.name, &one.pid.to_string(), &runs_for, &one.composites.join(" ")]
                .map(|cell| one_line(cell).into_owned()),
        );
    }
    print(&table.to_string());
    Exit::Done
}
