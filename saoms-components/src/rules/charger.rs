//! Chargers where no robot can be.

use std::collections::HashMap;

use saoms_api::{Code, Finding, FleetRule, FleetView, Severity};

use super::map::areas;
use super::robots::{Known, robots};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5002",
        name: "charger-place",
        meaning: "The charger of a robot is outside the map of its world, or on a blocked block.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: true,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let mut by_world: HashMap<usize, Vec<&Known>> = HashMap::new();
    for robot in robots.iter() {
        if let Some(world) = robot.world {
            by_world.entry(world).or_default().push(robot);
        }
    }
    let mut findings = Vec::new();
    if by_world.is_empty() {
        return findings;
    }
    for area in areas(fleet) {
        for robot in by_world.get(&area.index).into_iter().flatten() {
            let Some(problem) = area.problem(robot.charger) else { continue };
            let message = format!("the charger of robot {} is at {}, {problem}", robot.number, robot.charger);
            let in_columns = u32::try_from(robot.charger.x).is_ok_and(|column| column < area.map.width());
            let place = if in_columns { robot.charger_place(fleet) } else { robot.column_place(fleet) };
            let finding = Finding::new(place, message);
            let help = "give it a free block: `chargeX` is its column, `chargeY` its row, by default the robot's number";
            findings.push(area.explain(finding.help(help), robot.charger));
        }
    }
    findings
}
