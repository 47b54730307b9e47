//! Scenarios of which nothing comes, so that a run would wait for ever.

use std::ops::Range;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

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
    let is_awaked = scenarios.iter().any(|(_, has)| has.airplanes.is_some());
    let judged = scenarios.iter().filter_map(|(index, has)| {
        let (first, message, help) = judge(fleet, has, is_awaked).or_else(|| airplanes(fleet, has))?;
        let place = Place::property("scenario").part(first.0, first.1.clone()).in_component(*index);
        Some(Finding::new(place, message).help(help))
    });
    judged.collect()
}

/// Where a scenario says first that something happens: which of its texts, and the bytes of the word.
type First = (usize, Range<usize>);

/// What happens in a scenario.
struct Happenings {
    events: Option<First>,
    luggage: Option<First>,
    airplanes: Option<First>,
}

/// What is wrong, where, and what to do.
type Judged<'h> = (&'h First, &'static str, &'static str);

impl Happenings {
    fn of(texts: &[String]) -> Happenings {
        let (scenario, _) = Scenario::read_partly(texts);
        let first = |is: fn(&Happening) -> bool| {
            let line = scenario.lines().iter().find(|line| is(&line.happening))?;
            Some((line.text, line.bytes.clone()))
        };
        Happenings {
            events: first(|one| *one != Happening::End),
            luggage: first(|one| matches!(one, Happening::Luggage { .. })),
            airplanes: first(|one| matches!(one, Happening::Landing(_) | Happening::Takeoff(_))),
        }
    }
}

/// Why nothing comes of a scenario, and what to do.
fn judge<'h>(fleet: &FleetView<'_>, has: &'h Happenings, is_awaked: bool) -> Option<Judged<'h>> {
    if let Some(first) = &has.events
        && !publishes_beside_robots(fleet, EVENT_LUGGAGE.name())
    {
        return Some((
            first,
            "nobody passes the events of this scenario on to the robots",
            "add a `saoms.MasterEnvironment`",
        ));
    }
    let robots = robots(fleet);
    // Safe robots awake for luggage by themselves, classic ones do not.
    let comes = |robot: &Known| !robot.properties.asleep || robot.properties.policy == Policy::Safe;
    let first = has.luggage.as_ref()?;
    if robots.iter().any(comes) {
        return None;
    }
    if robots.is_empty() {
        // One with a fault of its own is there, too.
        let is_none = fleet.indices::<Robot>().next().is_none();
        return is_none.then_some((
            first,
            "no robot is there to bring the luggage of this scenario",
            "add a `saoms.Robot`",
        ));
    }
    let message = "all robots sleep, and none is awaked to bring the luggage of this scenario";
    if !publishes_beside_robots(fleet, ROBOT_STATE.name()) {
        let help = "let a robot start awake (`asleep`), or add a `saoms.MasterRobot`, which awakes robots for landings and take-offs";
        return Some((first, message, help));
    }
    let help =
        "let a robot start awake (`asleep`), or write a landing or take-off, for which robots are awaked";
    (!is_awaked).then_some((first, message, help))
}

/// Airplanes for which nobody does anything.
fn airplanes<'h>(fleet: &FleetView<'_>, has: &'h Happenings) -> Option<Judged<'h>> {
    let first = has.airplanes.as_ref()?;
    fleet.all::<MasterRobot>().next().is_none().then_some((
        first,
        "nobody reacts to the landings and take-offs of this scenario",
        "add a `saoms.MasterRobot`, which awakes robots for them",
    ))
}
