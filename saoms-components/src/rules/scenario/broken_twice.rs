//! Rule: a robot breaks down that is broken already.

use std::collections::{BTreeSet, HashMap, HashSet};

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::{Environment, EventSpec, Scenario};
use crate::messages::FAULT;
use crate::rules::hearing::{events, passed_on};
use crate::rules::robots::robots;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5015",
        name: "broken-twice",
        meaning: "A scenario breaks one robot twice, but a broken robot is never repaired.",
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
        let mut first: HashMap<u32, Place> = HashMap::new();
        let events = events(fleet, index);
        let heard = heard.entry(events).or_insert_with(|| passed_on(fleet, events, FAULT.name()));
        for line in scenario.lines() {
            let EventSpec::Breakdown(robot) = &line.event else { continue };
            let number = robot.value.least;
            // Of several robots one is drawn.
            if number != robot.value.most || heard.iter().any(|name| repaired.contains(&(number, *name))) {
                continue;
            }
            let place = Place::property("scenario").part(line.text, robot.bytes.clone()).in_component(index);
            let help = "remove this event, or choose another robot: a broken robot is never repaired";
            if let Some(other) = first.get(&number) {
                let message = format!("robot {number} breaks down twice: the second breakdown has no effect");
                findings.push(Finding::new(place, message).label(other.clone(), "the other breakdown").help(help));
                continue;
            }
            if line.times != Some(1) {
                let message = format!("robot {number} breaks down repeatedly: only the first breakdown has an effect");
                findings.push(Finding::new(place.clone(), message).help(help));
            }
            first.insert(number, place);
        }
    }
    findings
}
