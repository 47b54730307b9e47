//! Scenarios of which nothing comes, so that a run would wait for ever.

use saoms_api::{Code, Finding, FleetRule, FleetView, Place, Severity};

use super::robots::{Known, may_be_others, publishes_beside_robots, robots};
use crate::environment::{Environment, Happening, Scenario};
use crate::master::MasterRobot;
use crate::messages::{EVENT_LUGGAGE, ROBOT_STATE};
use crate::robot::{Policy, Robot};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5008",
        name: "unserved",
        meaning: "Nothing comes of a scenario: nobody passes its events on, no robot is there, or all of them are classic ones that sleep, and none is awaked.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    if may_be_others(fleet) {
        return Vec::new();
    }
    let scenarios = fleet.all::<Environment>();
    let scenarios: Vec<(usize, Happenings)> =
        scenarios.map(|(index, properties)| (index, Happenings::of(&properties.scenario))).collect();
    let is_awaked = scenarios.iter().any(|(_, has)| has.airplanes);
    let judged = scenarios.iter().filter_map(|(index, has)| {
        let (message, help) = judge(fleet, has, is_awaked).or_else(|| airplanes(fleet, has))?;
        Some(Finding::new(Place::property("scenario").in_component(*index), message).help(help))
    });
    judged.collect()
}

/// What happens in a scenario.
struct Happenings {
    events: bool,
    luggage: bool,
    airplanes: bool,
}

impl Happenings {
    fn of(texts: &[String]) -> Happenings {
        let (scenario, _) = Scenario::read_partly(texts);
        let any = |is: fn(&Happening) -> bool| scenario.lines().iter().any(|line| is(&line.happening));
        Happenings {
            events: any(|one| *one != Happening::End),
            luggage: any(|one| matches!(one, Happening::Luggage { .. })),
            airplanes: any(|one| matches!(one, Happening::Landing(_) | Happening::Takeoff(_))),
        }
    }
}

/// Why nothing comes of a scenario, and what to do.
fn judge(fleet: &FleetView<'_>, has: &Happenings, is_awaked: bool) -> Option<(&'static str, &'static str)> {
    if has.events && !publishes_beside_robots(fleet, EVENT_LUGGAGE.name()) {
        return Some((
            "nobody passes the events of this scenario on to the robots",
            "add a `saoms.MasterEnvironment`",
        ));
    }
    let robots = robots(fleet);
    // Safe robots awake for luggage by themselves, classic ones do not.
    let comes = |robot: &Known| !robot.properties.asleep || robot.properties.policy == Policy::Safe;
    if !has.luggage || robots.iter().any(comes) {
        return None;
    }
    if robots.is_empty() {
        // One with a fault of its own is there, too.
        let is_none = fleet.indices::<Robot>().next().is_none();
        return is_none
            .then_some(("no robot is there to bring the luggage of this scenario", "add a `saoms.Robot`"));
    }
    let message = "all robots sleep, and none is awaked to bring the luggage of this scenario";
    if !publishes_beside_robots(fleet, ROBOT_STATE.name()) {
        let help = "let a robot start awake (`asleep`), or add a `saoms.MasterRobot`, which awakes robots for landings and take-offs";
        return Some((message, help));
    }
    let help =
        "let a robot start awake (`asleep`), or write a landing or take-off, for which robots are awaked";
    (!is_awaked).then_some((message, help))
}

/// Airplanes for which nobody does anything.
fn airplanes(fleet: &FleetView<'_>, has: &Happenings) -> Option<(&'static str, &'static str)> {
    (has.airplanes && fleet.all::<MasterRobot>().next().is_none()).then_some((
        "nobody reacts to the landings and take-offs of this scenario",
        "add a `saoms.MasterRobot`, which awakes robots for them",
    ))
}
