//! Rule: two robots start on the same block.

use std::collections::HashSet;

use saoms_api::Finding;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};

use super::map::areas;
use super::robots::{FleetRobot, robots, sharing};
use crate::messages::ROBOT_LIST;
use crate::world::World;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5003",
        name: "start-shared",
        meaning: "Two robots start on the same block. A robot starts at its charger, unless `startX` or `startY` says otherwise.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: true,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    // A robot whose reference to a world is missing may be in another world.
    if fleet.misses::<World>() {
        return Vec::new();
    }
    let robots = robots(fleet);
    let components = fleet.components();
    // Where no world is known, those that hear of each other drive on the same blocks.
    let ground = |robot: &FleetRobot| match robot.ground {
        Some(world) => (Some(world), ""),
        None => (None, components[robot.index].topic(ROBOT_LIST.name())),
    };
    // Robots that cannot be where they start are reported by another rule.
    let off = off_map(fleet, &robots);
    let mut findings = Vec::new();
    for (robot, other) in sharing(&robots, |robot| (ground(robot), robot.start.y, robot.start.x)) {
        // Robots with the same number are reported by another rule.
        if other.number != robot.number && !off.contains(&robot.index) {
            let at_chargers = [other, robot].iter().all(|one| one.start == one.charger);
            let (why, help) = match at_chargers {
                true => (
                    ": their chargers are on the same block",
                    "move the charger of one robot with `chargeX` and `chargeY`",
                ),
                false => ("", "move the start of one robot with `startX` and `startY`"),
            };
            let message = format!("robots {} and {} both start at {}{why}", other.number, robot.number, robot.start);
            findings.push(
                Finding::new(robot.start_place(fleet), message)
                    .label(other.start_place(fleet), "the first robot")
                    .help(help),
            );
        }
    }
    findings
}

/// The robots that start where another one does, and no map has that block.
fn off_map(fleet: &FleetView<'_>, robots: &[FleetRobot]) -> HashSet<usize> {
    let mut off = HashSet::new();
    for area in areas(fleet) {
        let inside = robots.iter().filter(|robot| robot.ground == Some(area.index));
        off.extend(inside.filter(|robot| area.problem(robot.start).is_some()).map(|robot| robot.index));
    }
    off
}
