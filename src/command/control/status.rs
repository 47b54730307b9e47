//! `saoms status`: what each component of a running fleet does.

use clap::Args;
use saoms_api::host::one_line;
use serde_json::{Map, Value};

use super::fleet::RunningFleetArguments;
use super::over_network::{Programs, UrlArguments};
use super::table::Table;
use crate::Exit;

const EXIT_CODES: &str = "\
Exit codes:
  0  shown
  1  it could not be written, or a program on the network of `--url` does not answer
  2  no fleet runs, it is not clear which one is meant, or it has no such component";

/// Show what each component of a running fleet does
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct StatusArguments {
    /// Show only these components: their paths or IDs
    #[arg(value_name = "COMPONENT")]
    components: Vec<String>,

    #[command(flatten)]
    fleet: RunningFleetArguments,

    #[command(flatten)]
    network: UrlArguments,
}

pub(crate) fn status(arguments: &StatusArguments) -> Exit {
    if let Some(programs) = arguments.network.open(&arguments.fleet) {
        return programs.and_then(|mut programs| over_network(arguments, &mut programs)).unwrap_or_else(|exit| exit);
    }
    let mut answer = match arguments.fleet.ask("GET", "/v1/status", "") {
        Ok(answer) => answer,
        Err(exit) => return exit,
    };
    if let Err(unknown) = keep(&mut answer, &arguments.components) {
        return arguments.fleet.refuse(&unknown, Exit::WrongInput);
    }
    arguments.fleet.show(&answer, || shown(&answer));
    Exit::Done
}

/// The same for all programs of a network.
fn over_network(arguments: &StatusArguments, programs: &mut Programs<'_>) -> Result<Exit, Exit> {
    let asked = &arguments.components;
    // Each component is in one of them.
    let keep = |answer: &mut Value| {
        let Some(components) = answer["status"]["components"].as_array_mut() else { return asked.is_empty() };
        components
            .retain(|one| asked.is_empty() || asked.iter().any(|name| one["name"] == **name || one["id"] == **name));
        asked.is_empty() || !components.is_empty()
    };
    let (answers, silent) = programs.answers(("GET", "/v1/status", ""), keep)?;
    let has = |name: &String| {
        let components = answers.iter().filter_map(|(_, answer)| answer["status"]["components"].as_array()).flatten();
        components.into_iter().any(|one| one["name"] == **name || one["id"] == **name)
    };
    if let Some(unknown) = asked.iter().find(|name| !has(name)) {
        let message = format!("no program that answers has a component `{}`", one_line(unknown));
        return Err(arguments.fleet.refuse(&message, Exit::WrongInput));
    }
    programs.print(&answers, shown);
    Ok(if silent { Exit::Failed } else { Exit::Done })
}

/// Keeps the components that are asked for.
fn keep(answer: &mut Value, asked: &[String]) -> Result<(), String> {
    let Some(components) = answer["status"]["components"].as_array_mut() else { return Ok(()) };
    let is_of = |component: &Value, name: &str| component["name"] == name || component["id"] == name;
    if let Some(unknown) = asked.iter().find(|name| !components.iter().any(|one| is_of(one, name))) {
        let names = components.iter().filter_map(|one| one["name"].as_str());
        let near = saoms_api::rule::nearest(unknown, names);
        let near = near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
        return Err(format!("the fleet has no component `{unknown}`{near}"));
    }
    if !asked.is_empty() {
        components.retain(|one| asked.iter().any(|name| is_of(one, name)));
    }
    Ok(())
}

fn word(value: &Value) -> String {
    one_line(value.as_str().unwrap_or_default()).into_owned()
}

/// What a snapshot says of the fleet, in a line.
pub(super) fn headline(answer: &Value) -> String {
    let (fleet, status) = (&answer["fleet"], &answer["status"]);
    let mut text = format!(
        "{} (process {}): {}, {:.3} s",
        word(&fleet["name"]),
        fleet["pid"],
        if status["paused"] == true { "paused".to_owned() } else { word(&status["phase"]) },
        status["time_s"].as_f64().unwrap_or_default()
    );
    for summary in status["summaries"].as_array().into_iter().flatten() {
        text.push_str(&format!(", {}", word(summary)));
    }
    text
}

/// The state of a component, or what is more important.
pub(super) fn state(component: &Value) -> String {
    match component["in_code_s"].as_f64() {
        _ if component["emergency_stop"] == true => "emergency stop".to_owned(),
        Some(seconds) if seconds >= 1.0 => format!("in its code for {seconds:.0} s"),
        _ => word(&component["state"]),
    }
}

/// A snapshot for people.
fn shown(answer: &Value) -> String {
    let mut table = Table::new(&["COMPONENT", "STATE", "EXECUTIONS", "MISSED", "FAILURES", "DETAILS"]);
    for component in answer["status"]["components"].as_array().into_iter().flatten() {
        let number = |field: &str| component[field].to_string();
        table.row([
            word(&component["name"]),
            state(component),
            number("executions"),
            number("missed"),
            number("failures"),
            said(component),
        ]);
    }
    let alerts = answer["alerts"].as_array().into_iter().flatten();
    let alerts: String = alerts.map(|alert| format!("\n{}", super::alerts::line(alert))).collect();
    format!("{}{alerts}\n\n{table}", headline(answer))
}

/// What a component says of itself.
pub(super) fn said(component: &Value) -> String {
    let none = Map::new();
    let values = component["values"].as_object().unwrap_or(&none);
    // A state says enough by itself.
    let state = values.get("state").map(value);
    let others = values.iter().filter(|(name, one)| *name != "state" && !one.is_null());
    let others = others.map(|(name, one)| format!("{} {}", one_line(&name.replace('_', " ")), value(one)));
    let waits = component["waits_for"].as_str().map(|what| format!("waits for {}", one_line(what)));
    state.into_iter().chain(others).chain(waits).collect::<Vec<_>>().join(" · ")
}

/// A value for people.
fn value(value: &Value) -> String {
    match value {
        Value::Null => "none".to_owned(),
        Value::Bool(true) => "yes".to_owned(),
        Value::Bool(false) => "no".to_owned(),
        Value::Number(number) => match number.as_f64().filter(|_| number.is_f64()) {
            Some(number) => format!("{}", (number * 1000.0).round() / 1000.0),
            None => number.to_string(),
        },
        Value::String(text) => one_line(text).into_owned(),
        Value::Array(values) if values.len() <= 3 && values.iter().all(Value::is_number) => {
            format!("({})", values.iter().map(self::value).collect::<Vec<_>>().join(","))
        }
        Value::Array(values) => values.len().to_string(),
        Value::Object(values) => {
            let parts = values.iter().map(|(name, one)| format!("{} {}", one_line(name), self::value(one)));
            parts.collect::<Vec<_>>().join(" ")
        }
    }
}
