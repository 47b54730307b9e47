//! `saoms estop` and `saoms release`: robots and other machines stop at once, and go on.

use clap::Args;
use saoms_api::host::one_line;
use serde_json::Value;

use super::fleet::{RunningFleetArguments, escape};
use super::over_network::{Programs, UrlArguments};
use crate::Exit;

const STOP_CODES: &str = "\
Exit codes:
  0  the components are stopped
  1  a program on the network of `--url` does not answer: nothing of it may be stopped
  2  there is no such component, no fleet runs, or it is not clear which one is meant";

/// Emergency stop: stop machines of a running fleet at once, until `saoms release`
///
/// The stop functions of their hardware are called even if the code of a component hangs, and the heartbeat of the
/// hardware ends.
#[derive(Debug, Args)]
#[command(after_help = STOP_CODES)]
pub(crate) struct EmergencyStopArguments {
    /// The paths of the components; without any, all components that an emergency stop affects
    #[arg(value_name = "COMPONENT")]
    components: Vec<String>,

    #[command(flatten)]
    fleet: RunningFleetArguments,

    #[command(flatten)]
    network: UrlArguments,
}

const RELEASE_CODES: &str = "\
Exit codes:
  0  the components are released
  2  there is no such component, no fleet runs here, or it is not clear which one is meant";

/// Release machines of a running fleet that `saoms estop` stopped
#[derive(Debug, Args)]
#[command(after_help = RELEASE_CODES)]
pub(crate) struct ReleaseArguments {
    /// The paths of the components; without any, all stopped components
    #[arg(value_name = "COMPONENT")]
    components: Vec<String>,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

pub(crate) fn estop(arguments: &EmergencyStopArguments) -> Exit {
    if let Some(programs) = arguments.network.open(&arguments.fleet) {
        let stopped = programs.and_then(|mut programs| stop_over_network(arguments, &mut programs));
        return stopped.unwrap_or_else(|exit| exit);
    }
    give(&arguments.fleet, "estop", &arguments.components, "stopped")
}

pub(crate) fn release(arguments: &ReleaseArguments) -> Exit {
    give(&arguments.fleet, "release", &arguments.components, "released")
}

/// Who gives the command; whoever can order something may also name somebody else.
pub(super) fn user() -> Option<String> {
    std::env::var("USER").or_else(|_| std::env::var("LOGNAME")).ok().filter(|user| !user.is_empty())
}

/// The query that says who it is.
pub(super) fn by() -> String {
    user().map(|user| format!("?by={}", escape(&user))).unwrap_or_default()
}

/// Stops components in all programs of a network.
fn stop_over_network(arguments: &EmergencyStopArguments, programs: &mut Programs<'_>) -> Result<Exit, Exit> {
    let path = format!("/v1/estop{}", by());
    let (mut stopped, mut is_silent, mut first) = (Vec::<(String, Value)>::new(), false, None);
    // Each component is in one of them.
    let each: Vec<&str> = match arguments.components.as_slice() {
        [] => vec![""],
        components => components.iter().map(String::as_str).collect(),
    };
    for components in each {
        match programs.answers(("POST", &path, components), |_| true) {
            Ok((answers, silent)) => {
                is_silent |= silent;
                stopped.extend(answers);
            }
            Err(exit) => _ = first.get_or_insert(exit),
        }
    }
    if !stopped.is_empty() {
        programs.print(&stopped, |answer| said(answer, "stopped"));
    }
    match first {
        Some(exit) => Err(exit),
        None => Ok(if is_silent { Exit::Failed } else { Exit::Done }),
    }
}

fn give(fleet: &RunningFleetArguments, order: &str, components: &[String], done: &str) -> Exit {
    let query = by();
    let answer = match fleet.ask("POST", &format!("/v1/{order}{query}"), &components.join(" ")) {
        Ok(answer) => answer,
        Err(exit) => return exit,
    };
    fleet.show(&answer, || said(&answer, done));
    Exit::Done
}

/// What an answer says for people.
fn said(answer: &Value, done: &str) -> String {
    let names = answer["reply"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let names: Vec<String> = names.map(|name| one_line(name).into_owned()).collect();
    match names.is_empty() {
        true => format!("nothing is {done}\n"),
        false => format!("{done}: {}\n", names.join(", ")),
    }
}
