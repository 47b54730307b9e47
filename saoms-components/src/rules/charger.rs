//! Rule: a charger is on a block that no robot can enter.

use saoms_api::Finding;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};

use super::map::{WorldMap, areas};
use super::robots::{FleetRobot, by_world, robots};
use crate::world::World;

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
    if robots.is_empty() {
        return findings;
    }
    // Where there is one world, robots that are not wired to it drive on its blocks, too.
    let is_one = fleet.indices::<World>().nth(1).is_none() && !fleet.misses::<World>();
    for area in areas(fleet) {
        let first = by_world.partition_point(|(world, _)| *world < area.index);
        let inside = by_world[first..].iter().take_while(|(world, _)| *world == area.index);
        let inside = inside.map(|(_, robot)| (*robot, Severity::Error));
        let beside = robots.iter().filter(|robot| is_one && robot.world.is_none());
        for (robot, severity) in inside.chain(beside.map(|robot| (robot, Severity::Warning))) {
            findings.extend(on_map(fleet, &area, robot).map(|finding| finding.severity(severity)));
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
    let help = "give it a free block: `chargeX` is its column, `chargeY` its row, by default the robot's number";
    Some(area.explain(Finding::new(place, message).help(help), robot.charger))
}
