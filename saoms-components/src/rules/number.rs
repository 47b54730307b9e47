//! Two robots of one number.

use std::collections::HashMap;

use saoms_api::{Code, Finding, FleetRule, FleetView, Severity};

use super::robots::{Known, robots};

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
    let mut first: HashMap<u32, &Known> = HashMap::new();
    let mut findings = Vec::new();
    for robot in robots.iter() {
        let Some(other) = first.get(&robot.number) else {
            first.insert(robot.number, robot);
            continue;
        };
        // Two that are given outright, and two of one ID, are found by the property itself.
        let is_same_id = robot.properties.id.trim() == other.properties.id.trim();
        if is_same_id || robot.properties.number.is_some() && other.properties.number.is_some() {
            continue;
        }
        let name = |robot: &Known| fleet.components()[robot.index].path;
        let message =
            format!("robots `{}` and `{}` both have the number {}", name(other), name(robot), robot.number);
        findings.push(
            Finding::new(robot.number_place(fleet), message)
                .label(other.number_place(fleet), "the first")
                .help("a robot has the number that its ID ends with, unless its class name or `number` says another: give one of them its own"),
        );
    }
    findings
}
