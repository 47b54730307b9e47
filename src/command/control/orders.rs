//! Orders to a running fleet: `saoms down`, `send`, `start`, `stop`, `set` and `call`.

use std::time::Duration;

use clap::Args;
use saoms_api::host::{format_duration, one_line};
use serde_json::{Map, Value};

use super::fleet::{RunningFleetArguments, escape};
use super::over_network::UrlArguments;
use crate::Exit;
use crate::arguments::duration;

const DOWN_CODES: &str = "\
Exit codes:
  0  the fleet ends
  2  no fleet runs, it is not clear which one is meant, or the command line is wrong";

/// End a running fleet: its components shut down, and its run has the status `stopped`
#[derive(Debug, Args)]
#[command(after_help = DOWN_CODES)]
pub(crate) struct DownArguments {
    #[command(flatten)]
    fleet: RunningFleetArguments,
}

const SEND_CODES: &str = "\
Exit codes:
  0  the event is accepted: it happens at the next instant, or at its time
  2  the line is wrong, no fleet runs, or it is not clear which one is meant";

/// Send an event to a running fleet
#[derive(Debug, Args)]
#[command(after_help = SEND_CODES)]
pub(crate) struct SendArguments {
    /// A line as `saoms run --events` reads it, such as `luggage (3,1) to (3,10)`; without a time it happens at once
    #[arg(value_name = "LINE", required = true, num_args = 1..)]
    line: Vec<String>,

    #[command(flatten)]
    fleet: RunningFleetArguments,

    #[command(flatten)]
    network: UrlArguments,
}

const START_CODES: &str = "\
Exit codes:
  0  the component starts, or runs already
  2  there is no such component, no fleet runs, or it is not clear which one is meant";

/// Start a component of a running fleet
#[derive(Debug, Args)]
#[command(after_help = START_CODES)]
pub(crate) struct StartArguments {
    /// The path of the component
    #[arg(value_name = "COMPONENT")]
    component: String,

    /// Stop the component again after this time (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long = "for", value_name = "DURATION", value_parser = duration)]
    duration: Option<Duration>,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

const STOP_CODES: &str = "\
Exit codes:
  0  the component stops, or has stopped already
  2  there is no such component, no fleet runs, or it is not clear which one is meant";

/// Stop a component of a running fleet
#[derive(Debug, Args)]
#[command(after_help = STOP_CODES)]
pub(crate) struct StopArguments {
    /// The path of the component
    #[arg(value_name = "COMPONENT")]
    component: String,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

const SET_CODES: &str = "\
Exit codes:
  0  the component has accepted the value
  2  it is refused: there is no such component or property, the property cannot change while it runs, or the
     value is wrong; no fleet runs, or it is not clear which one is meant";

/// Change a property of a running component; its class must declare the property as `live`
#[derive(Debug, Args)]
#[command(after_help = SET_CODES)]
pub(crate) struct SetArguments {
    /// The path of the component
    #[arg(value_name = "COMPONENT")]
    component: String,

    /// The property and its value
    #[arg(value_name = "PROPERTY=VALUE", value_parser = pair)]
    value: (String, String),

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

const CALL_CODES: &str = "\
Exit codes:
  0  called; the reply is printed
  2  it is refused or has failed: there is no such component or operation, an argument is wrong, or the component does
     not run; no fleet runs, or it is not clear which one is meant";

/// Call an operation of a service that a running component offers
#[derive(Debug, Args)]
#[command(after_help = CALL_CODES)]
pub(crate) struct CallArguments {
    /// The component and the operation, such as `Gps.where`; where two of its services have it, `Gps/SERVICE.where`
    #[arg(value_name = "COMPONENT.OPERATION", value_parser = operation)]
    operation: (String, String),

    /// The arguments of the operation: values in JSON, or words
    #[arg(value_name = "ARGUMENT=VALUE", value_parser = pair)]
    arguments: Vec<(String, String)>,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

fn operation(text: &str) -> Result<(String, String), String> {
    match text.rsplit_once('.') {
        Some((component, name)) if !component.is_empty() && !name.is_empty() => {
            Ok((component.to_owned(), name.to_owned()))
        }
        _ => Err("expected `COMPONENT.OPERATION`".to_owned()),
    }
}

fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err("expected `PROPERTY=VALUE`".to_owned()),
    }
}

pub(crate) fn down(arguments: &DownArguments) -> Exit {
    order(&arguments.fleet, "POST", "/v1/down", "", || "the fleet ends\n".to_owned())
}

pub(crate) fn send(arguments: &SendArguments) -> Exit {
    let line = arguments.line.join(" ");
    if let Some(programs) = arguments.network.open(&arguments.fleet) {
        let given = programs.and_then(|mut programs| {
            let accepted = programs.give(("POST", "/v1/events", &line))?;
            programs.print(&[accepted], accepted_events);
            Ok(Exit::Done)
        });
        return given.unwrap_or_else(|exit| exit);
    }
    let answer = match arguments.fleet.ask("POST", "/v1/events", &line) {
        Ok(answer) => answer,
        Err(exit) => return exit,
    };
    arguments.fleet.show(&answer, || accepted_events(&answer));
    Exit::Done
}

/// What an answer says for people.
fn accepted_events(answer: &Value) -> String {
    match (answer["events"].as_u64(), &answer["reply"]) {
        (Some(1), _) => "1 event accepted\n".to_owned(),
        (Some(count), _) => format!("{count} events accepted\n"),
        (None, Value::Null) => "done\n".to_owned(),
        (None, reply) => format!("{reply}\n"),
    }
}

pub(crate) fn start(arguments: &StartArguments) -> Exit {
    let component = &arguments.component;
    let until = arguments.duration.map(format_duration);
    let query = until.as_ref().map(|time| format!("?for={}", escape(time))).unwrap_or_default();
    let path = format!("/v1/components/{}/start{query}", escape(component));
    let for_time = until.map(|time| format!(" for {time}")).unwrap_or_default();
    order(&arguments.fleet, "POST", &path, "", || format!("`{}` starts{for_time}\n", one_line(component)))
}

pub(crate) fn stop(arguments: &StopArguments) -> Exit {
    let component = &arguments.component;
    let path = format!("/v1/components/{}/stop", escape(component));
    order(&arguments.fleet, "POST", &path, "", || format!("`{}` stops\n", one_line(component)))
}

pub(crate) fn set(arguments: &SetArguments) -> Exit {
    let (component, (property, value)) = (&arguments.component, &arguments.value);
    let path = format!("/v1/components/{}/properties/{}", escape(component), escape(property));
    let said = || format!("`{}` has {} = {}\n", one_line(component), one_line(property), one_line(value));
    order(&arguments.fleet, "PUT", &path, value, said)
}

pub(crate) fn call(arguments: &CallArguments) -> Exit {
    let (component, operation) = &arguments.operation;
    let path = format!("/v1/components/{}/operations/{}", escape(component), escape(operation));
    let mut given = Map::new();
    for (name, text) in &arguments.arguments {
        let value = serde_json::from_str(text).unwrap_or_else(|_| Value::from(text.as_str()));
        if given.insert(name.clone(), value).is_some() {
            let message = format!("the argument `{}` is given twice", one_line(name));
            return arguments.fleet.refuse(&message, Exit::WrongInput);
        }
    }
    let answer = match arguments.fleet.ask("POST", &path, &Value::Object(given).to_string()) {
        Ok(answer) => answer,
        Err(exit) => return exit,
    };
    arguments.fleet.show(&answer, || match &answer["reply"] {
        Value::Null => "called\n".to_owned(),
        Value::String(text) => format!("{}\n", one_line(text)),
        reply => format!("{reply}\n"),
    });
    Exit::Done
}

/// Gives an order, and says that it was taken.
fn order(fleet: &RunningFleetArguments, method: &str, path: &str, body: &str, said: impl FnOnce() -> String) -> Exit {
    match fleet.ask(method, path, body) {
        Ok(answer) => {
            fleet.show(&answer, said);
            Exit::Done
        }
        Err(exit) => exit,
    }
}
