//! Rule: a charger is on a block that no robot can enter.

use saoms_api::Finding;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};

use super::map::areas;
use super::robots::{by_world, robots};

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
    let by_world = by_world(&robots);
    let mut findings = Vec::new();
    if by_world.is_empty() {
        return findings;
    }
    for area in areas(fleet) {
        let first = by_world.partition_point(|(world, _)| *world < area.index);
        let inside = by_world[first..].iter().take_while(|(world, _)| *world == area.index);
        for (_, robot) in inside {
            let Some(problem) = area.problem(robot.charger) else { continue };
            let message = format!("the charger of robot {} is at {}, {problem}", robot.number, robot.charger);
            let in_columns = u32::try_from(robot.charger.x).is_ok_and(|column| column < area.map.width());
            let place = if in_columns { robot.charger_place(fleet) } else { robot.column_place(fleet) };
            let finding = Finding::new(place, message);
            let help =
                "give it a free block: `chargeX` is its column, `chargeY` its row, by default the robot's number";
            findings.push(area.explain(finding.help(help), robot.charger));
        }
    }
    findings
}
