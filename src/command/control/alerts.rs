//! `saoms alerts`: what needs a person in a running fleet.

use clap::{Args, Subcommand};
use saoms_api::host::one_line;
use saoms_control::Alert;
use serde_json::Value;

use super::emergency::by;
use super::fleet::RunningFleetArguments;
use crate::Exit;
use crate::arguments::Format;
use crate::output::{eprint, print};

const EXIT_CODES: &str = "\
Exit codes:
  0  shown, also if there are no alerts; with --follow, the fleet has ended
  1  it could not be written
  2  no fleet runs, it is not clear which one is meant, or the command line is wrong";

/// Show the alerts of a running fleet: what needs a person
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES, args_conflicts_with_subcommands = true)]
pub(crate) struct AlertsArguments {
    #[command(subcommand)]
    command: Option<AlertsCommand>,

    /// Also show alerts that are over, and acknowledged alerts
    #[arg(long)]
    all: bool,

    /// Continue with changes as they happen, until the fleet ends
    #[arg(long, short)]
    follow: bool,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

#[derive(Debug, Subcommand)]
enum AlertsCommand {
    Ack(AckArguments),
}

const ACK_CODES: &str = "\
Exit codes:
  0  the alerts are acknowledged
  2  there is no such alert, no fleet runs, or it is not clear which one is meant";

/// Acknowledge alerts: they stay in the list of `--all` until they are over. The log records who acknowledged them
#[derive(Debug, Args)]
#[command(after_help = ACK_CODES)]
struct AckArguments {
    /// The numbers of the alerts
    #[arg(value_name = "ID", required_unless_present = "all")]
    ids: Vec<u64>,

    /// All alerts that are not acknowledged
    #[arg(long, conflicts_with = "ids")]
    all: bool,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

pub(crate) fn alerts(arguments: &AlertsArguments) -> Exit {
    match &arguments.command {
        Some(AlertsCommand::Ack(arguments)) => acknowledge(arguments),
        None if arguments.follow => follow(arguments),
        None => list(arguments),
    }
}

fn list(arguments: &AlertsArguments) -> Exit {
    let mut answer = match arguments.fleet.ask("GET", "/v1/alerts", "") {
        Ok(answer) => answer,
        Err(exit) => return exit,
    };
    if let Some(alerts) = answer.as_array_mut() {
        alerts.retain(|alert| is_wanted(alert, arguments.all));
    }
    arguments.fleet.show(&answer, || {
        let lines: Vec<String> = answer.as_array().into_iter().flatten().map(|alert| line(alert) + "\n").collect();
        if lines.is_empty() { "no alerts\n".to_owned() } else { lines.concat() }
    });
    Exit::Done
}

fn follow(arguments: &AlertsArguments) -> Exit {
    let response = match arguments.fleet.request("GET", "/v1/alerts?follow=true", "") {
        Ok(response) => response,
        Err(exit) => return exit,
    };
    for (name, data) in response.events() {
        let Ok(data) = serde_json::from_str::<Value>(&data) else { continue };
        match &*name {
            "lost" => eprint(&format!("warning: {data} changes came faster than they were read, and were lost\n")),
            "alerts" => {
                let alerts = data.as_array().into_iter().flatten().filter(|alert| is_wanted(alert, arguments.all));
                alerts.for_each(|alert| show(alert, alert, arguments));
            }
            _ => show(&data["alert"], &data, arguments),
        }
        if crate::output::has_failed() {
            break;
        }
    }
    Exit::Done
}

fn show(alert: &Value, data: &Value, arguments: &AlertsArguments) {
    match arguments.fleet.format {
        Format::Json => print(&format!("{data}\n")),
        Format::Human => print(&(line(alert) + "\n")),
    }
}

fn is_wanted(alert: &Value, all: bool) -> bool {
    all || (alert["over_s"].is_null() && alert["acknowledged"].is_null())
}

fn acknowledge(arguments: &AckArguments) -> Exit {
    let ids = arguments.ids.iter().map(u64::to_string).collect::<Vec<_>>().join(" ");
    let answer = match arguments.fleet.ask("POST", &format!("/v1/alerts/ack{}", by()), &ids) {
        Ok(answer) => answer,
        Err(exit) => return exit,
    };
    arguments.fleet.show(&answer, || {
        let ids = answer["acknowledged"].as_array().into_iter().flatten().map(Value::to_string);
        match ids.collect::<Vec<_>>().join(", ") {
            ids if ids.is_empty() => "no alert to acknowledge\n".to_owned(),
            ids => format!("acknowledged: {ids}\n"),
        }
    });
    Exit::Done
}

/// An alert as one line.
pub(super) fn line(alert: &Value) -> String {
    let Ok(Alert { id, kind, component, text, time_s, over_s, acknowledged, .. }) =
        serde_json::from_value(alert.clone())
    else {
        return String::new();
    };
    let who = component.map(|component| format!("{}: ", one_line(&component))).unwrap_or_default();
    let over = over_s.map(|time| format!(" (over since {time:.3} s)")).unwrap_or_default();
    let taken = acknowledged.map(|one| format!(" (acknowledged by {})", one_line(&one.by))).unwrap_or_default();
    format!("alert {id} [{time_s:.3} s] {}: {who}{}{over}{taken}", one_line(&kind), one_line(&text))
}
