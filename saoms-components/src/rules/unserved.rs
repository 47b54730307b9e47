//! Rule: a scenario has events that no component handles, so that a run would wait for ever.

use std::ops::Range;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::robots::{FleetRobot, may_be_others, publishes_beside_robots, robots, unless_elsewhere};
use crate::environment::{Environment, EventSpec, Scenario};
use crate::master::MasterRobot;
use crate::messages::{EVENT_LUGGAGE, ROBOT_STATE};
use crate::robot::{Policy, Robot};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5008",
        name: "unserved",
        meaning: "A scenario has no effect: no component passes its events on, there is no robot, or all robots are \
            classic ones that sleep, and none is woken.",
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
    let scenarios: Vec<(usize, FirstEvents)> =
        scenarios.map(|(index, properties)| (index, FirstEvents::of(&properties.scenario))).collect();
    let is_woken = scenarios.iter().any(|(_, has)| has.airplanes.is_some());
    let judged = scenarios.iter().filter_map(|(index, has)| {
        let (first, message, help) = find_mistake(fleet, has, is_woken).or_else(|| airplanes(fleet, has))?;
        let place = Place::property("scenario").part(first.0, first.1.clone()).in_component(*index);
        Some(Finding::new(place, message).help(help))
    });
    unless_elsewhere(fleet, judged.collect())
}

/// Index of the text and byte range of the word at which a scenario first has a kind of event.
type First = (usize, Range<usize>);

/// First event of each kind in a scenario.
struct FirstEvents {
    events: Option<First>,
    luggage: Option<First>,
    airplanes: Option<First>,
}

/// Place of the mistake, message, and help.
type Mistake<'h> = (&'h First, &'static str, &'static str);

impl FirstEvents {
    fn of(texts: &[String]) -> FirstEvents {
        let (scenario, _) = Scenario::read_partly(texts);
        let first = |is: fn(&EventSpec) -> bool| {
            let line = scenario.lines().iter().find(|line| is(&line.event))?;
            Some((line.text, line.bytes.clone()))
        };
        FirstEvents {
            events: first(|one| *one != EventSpec::End),
            luggage: first(|one| matches!(one, EventSpec::Luggage { .. })),
            airplanes: first(|one| matches!(one, EventSpec::Landing(_) | EventSpec::Takeoff(_))),
        }
    }
}

/// Reason why no component handles the events of a scenario, and help.
fn find_mistake<'h>(fleet: &FleetView<'_>, has: &'h FirstEvents, is_woken: bool) -> Option<Mistake<'h>> {
    if let Some(first) = &has.events
        && !publishes_beside_robots(fleet, EVENT_LUGGAGE.name())
    {
        return Some((
            first,
            "no component passes the events of this scenario on to the robots",
            "add a `saoms.MasterEnvironment`",
        ));
    }
    let robots = robots(fleet);
    // Safe robots wake for luggage by themselves, classic robots do not.
    let comes = |robot: &FleetRobot| !robot.properties.asleep || robot.properties.policy == Policy::Safe;
    let first = has.luggage.as_ref()?;
    if robots.iter().any(comes) {
        return None;
    }
    if robots.is_empty() {
        // A robot with a fault of its own counts as well.
        let is_none = fleet.indices::<Robot>().next().is_none();
        return is_none.then_some((
            first,
            "there is no robot to bring the luggage of this scenario",
            "add a `saoms.Robot`",
        ));
    }
    let message = "all robots sleep, and none is woken to bring the luggage of this scenario";
    if !publishes_beside_robots(fleet, ROBOT_STATE.name()) {
        let help = "let a robot start awake (`asleep`), or add a `saoms.MasterRobot`, which awakes robots for \
            landings and take-offs";
        return Some((first, message, help));
    }
    let help = "let a robot start awake (`asleep`), or write a landing or take-off, for which robots are woken";
    (!is_woken).then_some((first, message, help))
}

/// Landings and take-offs that no component handles.
fn airplanes<'h>(fleet: &FleetView<'_>, has: &'h FirstEvents) -> Option<Mistake<'h>> {
    let first = has.airplanes.as_ref()?;
    fleet.all::<MasterRobot>().next().is_none().then_some((
        first,
        "no component reacts to the landings and take-offs of this scenario",
        "add a `saoms.MasterRobot`, which awakes robots for them",
    ))
}
