//! Rule: a robot starts, or has its charger, on a block that no robot can enter.

use saoms_api::Finding;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};

use super::map::{WorldMap, areas};
use super::robots::{FleetRobot, robots};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5002",
        name: "charger-place",
        meaning: "The charger of a robot, or the block where it starts, is outside the map of its world, or blocked.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: true,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let mut inside: Vec<(usize, &FleetRobot)> =
        robots.iter().filter_map(|robot| Some((robot.ground?, robot))).collect();
    inside.sort_by_key(|(world, _)| *world);
    let mut findings = Vec::new();
    if robots.is_empty() {
        return findings;
    }
    for area in areas(fleet) {
        let first = inside.partition_point(|(world, _)| *world < area.index);
        for (_, robot) in inside[first..].iter().take_while(|(world, _)| *world == area.index) {
            // One that is not wired drives on the blocks all the same.
            let severity = if robot.world.is_some() { Severity::Error } else { Severity::Warning };
            let found = on_map(fleet, &area, robot).into_iter().chain(starts_on_map(fleet, &area, robot));
            findings.extend(found.map(|finding| finding.severity(severity)));
        }
    }
    findings
}

/// A finding if the robot cannot be at its charger.
fn on_map(fleet: &FleetView<'_>, area: &WorldMap, robot: &FleetRobot) -> Option<Finding> {
    let problem = area.problem(robot.charger)?;
    let message = format!("the charger of robot {} is at {}, {problem}", robot.number, robot.charger);
    let in_columns = u32::try_from(robot.charger.x).is_ok_and(|column| column < area.map.width());
    let place = if in_columns { robot.charger_place(fleet) } else { robot.column_place(fleet) };
    let help = "choose a free block: `chargeX` is the column of the charger, `chargeY` is its row (by default the \
        robot's number)";
    Some(area.explain(Finding::new(place, message).help(help), robot.charger))
}

/// A finding if the robot cannot be where it starts, which is not its charger.
fn starts_on_map(fleet: &FleetView<'_>, area: &WorldMap, robot: &FleetRobot) -> Option<Finding> {
    let problem = area.problem(robot.start).filter(|_| robot.start != robot.charger)?;
    let message = format!("robot {} starts at {}, {problem}", robot.number, robot.start);
    let help = "choose a free block: `startX` is its column, `startY` is its row";
    Some(area.explain(Finding::new(robot.start_place(fleet), message).help(help), robot.start))
}
