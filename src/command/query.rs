//! `saoms query`: asks the history of fleets in SQL.

use std::path::{Path, PathBuf};

use clap::Args;
use saoms_api::extension::HistoryValue;
use saoms_api::host::one_line;
use saoms_history::{Answer, Questions, TableDoc, table_docs};
use serde_json::{Value, json};

use super::control::{RunningFleetArguments, Table};
use crate::Exit;
use crate::arguments::Format;
use crate::output::{print, print_json};

const EXIT_CODES: &str = "\
Exit codes:
  0  answered
  1  standard output could not be written
  2  the question is wrong, or there is no history";

/// Ask the history of fleets in SQL, also while they run; without a question, show its tables
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct QueryArguments {
    /// One question, such as `select * from runs`
    #[arg(value_name = "SQL")]
    question: Option<String>,

    /// The history: a file of `saoms run --history`. Without it, that of the running fleet
    #[arg(long, value_name = "FILE", conflicts_with_all = ["name", "token_file"])]
    history: Option<PathBuf>,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

pub(crate) fn query(arguments: &QueryArguments) -> Exit {
    let Some(question) = &arguments.question else {
        show_tables(arguments.fleet.format);
        return Exit::Done;
    };
    let answer = path(arguments).and_then(|path| {
        let answer = Questions::open(&path).and_then(|questions| questions.ask(question));
        answer.map_err(|error| arguments.fleet.refuse(&error.to_string(), Exit::WrongInput))
    });
    match answer {
        Ok(answer) => {
            arguments.fleet.show(&as_json(&answer), || as_table(&answer));
            Exit::Done
        }
        Err(exit) => exit,
    }
}

/// The file of the history that is meant. Why there is none is reported.
fn path(arguments: &QueryArguments) -> Result<PathBuf, Exit> {
    if let Some(path) = &arguments.history {
        return Ok(path.clone());
    }
    let fleet = arguments.fleet.ask("GET", "/v1/fleet", "")?;
    let path = fleet["history"].as_str().map(|path| Path::new(path).to_owned());
    path.ok_or_else(|| {
        let name = fleet["name"].as_str().unwrap_or_default();
        let message = format!(
            "the fleet `{}` writes no history\n  = help: start it with `--history FILE`, or name a history: \
             `saoms query --history FILE ...`",
            one_line(name)
        );
        arguments.fleet.refuse(&message, Exit::WrongInput)
    })
}

fn show_tables(format: Format) {
    let tables = table_docs();
    match format {
        Format::Human => print(&tables.iter().map(TableDoc::to_string).collect::<Vec<_>>().join("\n")),
        Format::Json => print_json(&tables.iter().map(table_json).collect::<Vec<Value>>()),
    }
}

fn table_json(table: &TableDoc) -> Value {
    let columns = table.columns.iter().map(|one| json!({ "name": one.name, "kind": one.kind, "doc": one.doc }));
    json!({ "name": table.name, "doc": table.doc, "columns": columns.collect::<Vec<_>>() })
}

fn as_json(answer: &Answer) -> Value {
    let cell = |cell: &HistoryValue| match cell {
        HistoryValue::Null => Value::Null,
        HistoryValue::Integer(value) => Value::from(*value),
        HistoryValue::Real(value) => Value::from(*value),
        HistoryValue::Text(text) => Value::from(text.as_str()),
    };
    let rows = answer.rows.iter().map(|row| row.iter().map(cell).collect::<Vec<Value>>());
    json!({ "columns": answer.columns, "rows": rows.collect::<Vec<_>>() })
}

fn as_table(answer: &Answer) -> String {
    let cell = |cell: &HistoryValue| match cell {
        HistoryValue::Null => String::new(),
        HistoryValue::Integer(value) => value.to_string(),
        HistoryValue::Real(value) => value.to_string(),
        HistoryValue::Text(text) => one_line(text).into_owned(),
    };
    let names: Vec<String> = answer.columns.iter().map(|name| one_line(name).into_owned()).collect();
    let is_number = |column: &usize| {
        let mut cells = answer.rows.iter().filter_map(|row| row.get(*column));
        cells.all(|cell| !matches!(cell, HistoryValue::Text(_)))
    };
    let numbers: Vec<usize> = (0..names.len()).filter(is_number).collect();
    let mut table = Table::new(&names.iter().map(String::as_str).collect::<Vec<_>>()).with_numbers(numbers);
    answer.rows.iter().for_each(|row| table.row(row.iter().map(cell)));
    table.to_string()
}
