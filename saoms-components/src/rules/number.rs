//! Rule: two robots have the same number.

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::robots::{FleetRobot, robots, sharing};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5004",
        name: "robot-number",
        meaning: "Two robots have one number, as it follows from an ID or a class name.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: true,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let mut findings = Vec::new();
    for (robot, other) in sharing(&robots, |robot| robot.number) {
        let name = |robot: &FleetRobot| fleet.components()[robot.index].path;
        let message = format!("robots `{}` and `{}` both have the number {}", name(other), name(robot), robot.number);
        // If both have the same ID, the ID has to change. The checker reports that itself, unless the composite allows
        // it.
        let is_same_id = robot.properties.id.trim() == other.properties.id.trim();
        let place = match is_same_id {
            true => Place::property("ID").in_component(robot.index),
            false => robot.number_place(fleet),
        };
        findings.push(Finding::new(place, message).label(other.number_place(fleet), "the first").help(
            "a robot has the number that its ID ends with, unless its class name or `number` says another: \
                    give one of them its own",
        ));
    }
    findings
}
