//! Rule: a master of the environment crashes for good, and nobody takes its place.

use std::ops::Range;

use saoms_api::event::fault::{FaultCall, FaultKind, names_component};
use saoms_api::extension::LineFault;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::{Environment, EventSpec, Scenario};
use crate::master::MasterEnvironment;
use crate::messages::ENVIRONMENT;

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
    let components = fleet.components();
    let mut findings = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let events = components[index].topic(ENVIRONMENT.name());
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        for line in scenario.lines() {
            let mut masters = ended(fleet, &line.event).into_iter();
            let Some(master) = masters.find(|one| components[*one].topic(ENVIRONMENT.name()) == events) else {
                continue;
            };
            let place = Place::property("scenario").part(line.text as usize, line.bytes.clone()).in_component(index);
            let finding = Finding::new(place, message(fleet, master));
            findings.push(finding.label(Place::component(master), "the master").help(HELP));
        }
    }
    findings
}

/// Judges an event that does not stand in a scenario. Places are bytes of its text.
///
/// # Errors
/// It is a crash of a master that does not start again.
pub(crate) fn judge_end(fleet: &FleetView<'_>, event: &EventSpec, bytes: Range<usize>) -> Result<(), LineFault> {
    match ended(fleet, event).first() {
        Some(master) => Err(LineFault::new(bytes, message(fleet, *master)).help(HELP).code(&RULE.code)),
        None => Ok(()),
    }
}

fn message(fleet: &FleetView<'_>, master: usize) -> String {
    let path = fleet.components()[master].path;
    format!("`{path}` does not start again, and nobody takes its place: what robots have not heard of waits for ever")
}

/// The masters of the environment that an event crashes for good.
fn ended(fleet: &FleetView<'_>, event: &EventSpec) -> Vec<usize> {
    let EventSpec::Raised(text) = event else { return Vec::new() };
    let call = FaultCall::is_one(text).then(|| FaultCall::read(text).ok()).flatten();
    let Some(call) = call.filter(|call| matches!(call.kind, FaultKind::Crash { restart: None })) else {
        return Vec::new();
    };
    let is_meant = |master: &usize| {
        let one = &fleet.components()[*master];
        call.to.iter().any(|name| names_component(&name.text, one.path, one.node))
    };
    fleet.indices::<MasterEnvironment>().filter(is_meant).collect()
}
