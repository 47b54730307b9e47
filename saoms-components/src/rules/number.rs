//! Rule: two robots have the same number.

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::robots::{FleetRobot, robots, sharing};
use crate::messages::{CRITICAL_SITUATION, EVENT_LUGGAGE, POSITION, ROBOT_LIST};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5004",
        name: "robot-number",
        meaning: "Two robots have the same number. It comes from the property `number`, the class name or the ID.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: true,
    check,
};

/// Topics on which robots say their numbers to each other.
const SHARED: [&str; 4] = [ROBOT_LIST.name(), POSITION.name(), EVENT_LUGGAGE.name(), CRITICAL_SITUATION.name()];

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let mut findings = Vec::new();
    let components = fleet.components();
    // Robots of two sites have numbers of their own, unless they hear each other or share a world.
    let mut pairs = sharing(&robots, |robot| {
        (robot.number, robot.world.filter(|_| robot.other_world(fleet).is_none()).ok_or(robot.index))
    });
    for topic in SHARED {
        pairs.extend(sharing(&robots, |robot| (robot.number, components[robot.index].topic(topic))));
    }
    pairs.sort_by_key(|(robot, other)| (robot.index, other.index));
    pairs.dedup_by_key(|(robot, _)| robot.index);
    for (robot, other) in pairs {
        let name = |robot: &FleetRobot| fleet.components()[robot.index].path;
        let message = format!("robots `{}` and `{}` both have the number {}", name(other), name(robot), robot.number);
        // If both have the same ID, the ID has to change. The checker reports that itself, unless the composite allows
        // it.
        let is_same_id = robot.properties.id.trim() == other.properties.id.trim();
        let place = match is_same_id {
            true => Place::property("ID").in_component(robot.index),
            false => robot.number_place(fleet),
        };
        findings.push(Finding::new(place, message).label(other.number_place(fleet), "the first robot").help(
            "give one of the robots another `number`; without `number`, the digits at the end of the ID are the \
            robot's number",
        ));
    }
    findings
}
