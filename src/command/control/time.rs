//! `saoms pause`, `resume`, `step` and `speed`: the time of a running fleet.

use std::time::Duration;

use clap::Args;
use saoms_api::host::format_duration;

use super::fleet::{RunningFleetArguments, escape};
use crate::Exit;
use crate::arguments::duration;

const PAUSE_CODES: &str = "\
Exit codes:
  0  the fleet pauses
  2  the run ends, no fleet runs, or it is not clear which one is meant";

/// Pause a running fleet: no component executes, and the time of the run stands still
#[derive(Debug, Args)]
#[command(after_help = PAUSE_CODES)]
pub(crate) struct PauseArguments {
    #[command(flatten)]
    fleet: RunningFleetArguments,
}

const RESUME_CODES: &str = "\
Exit codes:
  0  the fleet runs again
  2  the run ends, no fleet runs, or it is not clear which one is meant";

/// Resume a paused fleet
#[derive(Debug, Args)]
#[command(after_help = RESUME_CODES)]
pub(crate) struct ResumeArguments {
    #[command(flatten)]
    fleet: RunningFleetArguments,
}

const STEP_CODES: &str = "\
Exit codes:
  0  the fleet advances, then pauses
  2  it runs in real time, the run ends, no fleet runs, or it is not clear which one is meant";

/// Advance a fleet in virtual time by a duration, then pause it
#[derive(Debug, Args)]
#[command(after_help = STEP_CODES)]
pub(crate) struct StepArguments {
    /// The time (a bare number is milliseconds; units us, ms, s, min, h); without it, through the next instant at which
    /// something is due
    #[arg(value_name = "DURATION", value_parser = duration)]
    time: Option<Duration>,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

const SPEED_CODES: &str = "\
Exit codes:
  0  the speed is set
  2  the fleet runs in real time, the factor is wrong, the run ends, no fleet runs, or it is not clear which one is
     meant";

/// Set how fast virtual time passes in a running fleet
#[derive(Debug, Args)]
#[command(after_help = SPEED_CODES)]
pub(crate) struct SpeedArguments {
    /// Seconds of virtual time in a second, such as `1`, `10` or `0.5`; `max` is as fast as the machine allows
    #[arg(value_name = "FACTOR|max")]
    speed: String,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

pub(crate) fn pause(arguments: &PauseArguments) -> Exit {
    order(&arguments.fleet, "POST", "/v1/pause", "", |at| format!("paused at {at}\n"))
}

pub(crate) fn resume(arguments: &ResumeArguments) -> Exit {
    order(&arguments.fleet, "POST", "/v1/resume", "", |_| "resumed\n".to_owned())
}

pub(crate) fn step(arguments: &StepArguments) -> Exit {
    let query = arguments.time.map(|time| format!("?for={}", escape(&format_duration(time)))).unwrap_or_default();
    order(&arguments.fleet, "POST", &format!("/v1/step{query}"), "", |at| format!("advances to {at}\n"))
}

pub(crate) fn speed(arguments: &SpeedArguments) -> Exit {
    let speed = &arguments.speed;
    order(&arguments.fleet, "PUT", "/v1/speed", speed, |_| format!("the speed is {speed}\n"))
}

/// Gives an order about time, whose answer may have the time at which the fleet stands then.
fn order(
    fleet: &RunningFleetArguments,
    method: &str,
    path: &str,
    body: &str,
    said: impl FnOnce(String) -> String,
) -> Exit {
    match fleet.ask(method, path, body) {
        Ok(answer) => {
            let at = format!("{:.3} s", answer["time_s"].as_f64().unwrap_or_default());
            fleet.show(&answer, || said(at));
            Exit::Done
        }
        Err(exit) => exit,
    }
}
