//! `saoms logs`: the log of a running fleet.

use clap::Args;
use saoms_api::host::one_line;
use saoms_control::LogLine;
use serde_json::Value;

use super::fleet::RunningFleetArguments;
use crate::Exit;
use crate::arguments::Format;
use crate::output::{eprint, print, print_json_line};

const EXIT_CODES: &str = "\
Exit codes:
  0  shown; with --follow, the fleet has ended
  1  it could not be written
  2  no fleet runs, it is not clear which one is meant, or the command line is wrong";

/// Show the log of a running fleet
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct LogsArguments {
    /// Continue with new lines as they are written, until the fleet ends
    #[arg(long, short)]
    follow: bool,

    /// The number of earlier lines to show
    #[arg(long, short = 'n', value_name = "N", default_value_t = 100)]
    lines: usize,

    /// Show only the lines of this component
    #[arg(value_name = "COMPONENT")]
    component: Option<String>,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

pub(crate) fn logs(arguments: &LogsArguments) -> Exit {
    let path = format!("/v1/logs?lines={}&follow={}", arguments.lines, arguments.follow);
    if !arguments.follow {
        let answer = match arguments.fleet.ask("GET", &path, "") {
            Ok(answer) => answer,
            Err(exit) => return exit,
        };
        answer.as_array().into_iter().flatten().for_each(|line| show(line, arguments));
        return Exit::Done;
    }
    let response = match arguments.fleet.request("GET", &path, "") {
        Ok(response) => response,
        Err(exit) => return exit,
    };
    for (name, data) in response.events() {
        if name == "lost" {
            eprint(&format!("warning: {data} lines came faster than they were read, and were lost\n"));
        } else if let Ok(line) = serde_json::from_str(&data) {
            show(&line, arguments);
        }
        if crate::output::has_failed() {
            break;
        }
    }
    Exit::Done
}

/// Prints a line, with the same form as `saoms run`.
fn show(line: &Value, arguments: &LogsArguments) {
    if arguments.component.as_deref().is_some_and(|component| line["component"] != component) {
        return;
    }
    if arguments.fleet.format == Format::Json {
        return print_json_line(line);
    }
    let Ok(LogLine { time_s, level, component, text, .. }) = serde_json::from_value(line.clone()) else { return };
    let level = if level == "info" { String::new() } else { format!("{level}: ") };
    let component = component.map(|component| format!("{}: ", one_line(&component))).unwrap_or_default();
    print(&format!("[{time_s:.3} s] {component}{level}{}\n", one_line(&text)));
}
