//! Rule: a robot breaks down that is broken already or gone, or is gone twice.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::time::Duration;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::{Environment, EventSpec, Line, Scenario};
use crate::messages::FAULT;
use crate::rules::hearing::{events, passed_on};
use crate::rules::robots::robots;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5015",
        name: "broken-twice",
        meaning: "A scenario breaks one robot twice, or has an event for a robot that is gone, but robots are never repaired \
                  or brought back.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    // A robot that another component schedules anew is repaired by that.
    let scheduled = fleet.components().iter().flat_map(|one| one.wires.iter().map(|(_, target)| *target));
    let scheduled: HashSet<usize> = scheduled.collect();
    let robots = robots(fleet);
    let repaired = robots.iter().filter(|robot| scheduled.contains(&robot.index));
    let repaired = repaired.map(|robot| (robot.number, fleet.components()[robot.index].topic(FAULT.name())));
    let repaired: HashSet<(u32, &str)> = repaired.collect();
    let mut heard: HashMap<&str, BTreeSet<&str>> = HashMap::new();
    let mut findings = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        let mut first: HashMap<(u32, bool), Place> = HashMap::new();
        let events = events(fleet, index);
        let heard = heard.entry(events).or_insert_with(|| passed_on(fleet, events, FAULT.name()));
        for line in in_order(&scenario) {
            let (robot, is_gone) = match &line.event {
                EventSpec::Breakdown(robot) => (robot, false),
                EventSpec::Gone(robot) => (robot, true),
                _ => continue,
            };
            let number = robot.value.least;
            // Of several robots one is drawn.
            if number != robot.value.most || heard.iter().any(|name| repaired.contains(&(number, *name))) {
                continue;
            }
            let place = Place::property("scenario").part(line.text as usize, robot.bytes.clone()).in_component(index);
            let help = match is_gone || first.contains_key(&(number, true)) {
                false => "remove this event, or choose another robot: a broken robot is never repaired",
                true => "remove this event, or choose another robot: nothing brings the robot back",
            };
            // A broken robot can still be taken off the floor.
            let earlier = first.get(&(number, true)).map(|place| (place, true));
            let earlier = earlier.or_else(|| Some((first.get(&(number, false)).filter(|_| !is_gone)?, false)));
            if let Some((other, was_gone)) = earlier {
                let (message, label) = match (was_gone, is_gone) {
                    (true, true) => ("is gone twice: the second time has no effect", "gone here"),
                    (true, false) => ("breaks down after it is gone: that has no effect", "gone here"),
                    (false, _) => ("breaks down twice: the second breakdown has no effect", "the other breakdown"),
                };
                let message = format!("robot {number} {message}");
                findings.push(Finding::new(place, message).label(other.clone(), label).help(help));
                continue;
            }
            if line.times != Some(1) {
                let message = match is_gone {
                    true => format!("robot {number} is gone repeatedly: only the first time has an effect"),
                    false => format!("robot {number} breaks down repeatedly: only the first breakdown has an effect"),
                };
                findings.push(Finding::new(place.clone(), message).help(help));
            }
            first.insert((number, is_gone), place);
        }
    }
    findings
}

/// The lines in the order of their first events.
fn in_order(scenario: &Scenario) -> Vec<&Line> {
    let mut last = Duration::ZERO;
    let timed = scenario.lines().iter().map(|line| {
        last = if line.follows { last.saturating_add(line.time.least) } else { line.time.least };
        (last, line)
    });
    let mut timed: Vec<(Duration, &Line)> = timed.collect();
    timed.sort_by_key(|(at, _)| *at);
    timed.into_iter().map(|(_, line)| line).collect()
}
