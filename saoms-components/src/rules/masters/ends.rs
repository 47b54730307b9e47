//! Rule: a master of the environment crashes for good, and nobody takes its place.

use std::ops::Range;

use saoms_api::extension::LineFault;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::EventSpec;
use crate::master::MasterEnvironment;
use crate::rules::crash::{crashed, crashes};

const HELP: &str = "write `restart 2s` behind its name, unless that is what you want to see";

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5032",
        name: "ended-master",
        meaning: "A scenario or `--faults` crashes a master of the environment, which does not start again. Nobody takes its \
            place: what it has not passed on to the robots waits for ever.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let found = crashes(fleet, |event| ended(fleet, event)).into_iter();
    let found = found.map(|(master, place)| {
        Finding::new(place, message(fleet, master)).label(Place::component(master), "the master").help(HELP)
    });
    found.collect()
}

/// Judges an event that does not stand in a scenario. Places are bytes of its text.
///
/// # Errors
/// It is a crash of a master that does not start again.
pub(crate) fn judge_end(fleet: &FleetView<'_>, event: &EventSpec, bytes: Range<usize>) -> Result<(), LineFault> {
    match ended(fleet, event).next() {
        Some(master) => Err(LineFault::new(bytes, message(fleet, master)).help(HELP).code(&RULE.code)),
        None => Ok(()),
    }
}

fn message(fleet: &FleetView<'_>, master: usize) -> String {
    let path = fleet.components()[master].path;
    format!("`{path}` does not start again, and nobody takes its place: what robots have not heard of waits for ever")
}

/// The masters of the environment that an event crashes for good.
fn ended<'f, 'v>(fleet: &'f FleetView<'v>, event: &EventSpec) -> impl Iterator<Item = usize> + use<'f, 'v> {
    crashed::<MasterEnvironment>(fleet, event, false)
}
