//! Rule: a world that crashes and starts again has forgotten its robots and its luggage.

use std::ops::Range;

use saoms_api::event::fault::{FaultCall, FaultKind, names_component};
use saoms_api::extension::LineFault;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::{Environment, EventSpec, Scenario};
use crate::messages::ENVIRONMENT;
use crate::world::World;

const HELP: &str = "add `<property name=\"restart\">onFailure</property>` to it: it saves then what it goes on with";

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5031",
        name: "forgetful-world",
        meaning: "A scenario or `--faults` crashes a world and starts it again, but the world has no `restart`, so that it saves \
            nothing: it begins anew without the robots and the luggage on its floor.",
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
            let worlds = forgetful(fleet, &line.event);
            let Some(world) = worlds.into_iter().find(|one| components[*one].topic(ENVIRONMENT.name()) == events)
            else {
                continue;
            };
            let place = Place::property("scenario").part(line.text as usize, line.bytes.clone()).in_component(index);
            findings.push(
                Finding::new(place, message(fleet, world)).label(Place::component(world), "the world").help(HELP),
            );
        }
    }
    findings
}

/// Judges an event that does not stand in a scenario. Places are bytes of its text.
///
/// # Errors
/// It is a crash of a world that forgets all.
pub(crate) fn judge_crash(fleet: &FleetView<'_>, event: &EventSpec, bytes: Range<usize>) -> Result<(), LineFault> {
    match forgetful(fleet, event).first() {
        Some(world) => Err(LineFault::new(bytes, message(fleet, *world)).help(HELP).code(&RULE.code)),
        None => Ok(()),
    }
}

fn message(fleet: &FleetView<'_>, world: usize) -> String {
    let path = fleet.components()[world].path;
    format!("`{path}` has forgotten its robots and its luggage when it starts again: it has no `restart`")
}

/// The worlds that an event crashes and starts again, and that save nothing.
fn forgetful(fleet: &FleetView<'_>, event: &EventSpec) -> Vec<usize> {
    let EventSpec::Raised(text) = event else { return Vec::new() };
    let call = FaultCall::is_one(text).then(|| FaultCall::read(text).ok()).flatten();
    let Some(call) = call.filter(|call| matches!(call.kind, FaultKind::Crash { restart: Some(_) })) else {
        return Vec::new();
    };
    let is_meant = |world: &usize| {
        let one = &fleet.components()[*world];
        !one.restarts && call.to.iter().any(|name| names_component(&name.text, one.path, one.node))
    };
    fleet.indices::<World>().filter(is_meant).collect()
}
