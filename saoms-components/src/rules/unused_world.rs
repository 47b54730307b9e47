//! Worlds that no robot is in.

use saoms_api::{Code, Finding, FleetRule, FleetView, Place, Severity};

use super::map::{Area, areas};
use super::robots::{Known, may_be_others, robots};
use crate::robot::Robot;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5009",
        name: "unused-world",
        meaning: "A fleet has a world, and robots, all or some of them, are not wired to it: they move, collect and deposit without it.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    // A wire with a fault may be one to a world.
    if robots.is_empty() || may_be_others(fleet) || fleet.misses::<Robot>() {
        return Vec::new();
    }
    let is_used = |area: &Area| {
        fleet.components().iter().any(|one| one.wires.iter().any(|(_, target)| *target == area.index))
    };
    let (used, unused): (Vec<Area>, Vec<Area>) = areas(fleet).into_iter().partition(is_used);
    let mut findings: Vec<Finding> = unused.iter().map(|area| without_robots(fleet, area)).collect();
    findings.extend(robots.iter().filter_map(|robot| beside(fleet, robot, &robots, &used)));
    findings
}

fn without_robots(fleet: &FleetView<'_>, area: &Area) -> Finding {
    let message = match area.map.is_open() {
        true => "no robot is wired to this world, so it sees neither robots nor what they deliver",
        false => "no robot is wired to this world, so robots move through its blocked blocks",
    };
    let path = fleet.components()[area.index].path;
    let help = format!("give each robot in it a `<reference name=\"world\" target=\"{path}\"/>`");
    Finding::new(Place::component(area.index), message).help(help)
}

/// Says that a robot is in no world, where others around it are in one.
fn beside(fleet: &FleetView<'_>, robot: &Known, robots: &[Known], used: &[Area]) -> Option<Finding> {
    if robot.world.is_some() {
        return None;
    }
    let components = fleet.components();
    let around = |path: &str| path.rsplit_once('/').map_or(String::new(), |(around, _)| format!("{around}/"));
    let own = components[robot.index].path;
    // The innermost world that is around it.
    let area = used
        .iter()
        .filter(|area| own.starts_with(&around(components[area.index].path)))
        .max_by_key(|area| around(components[area.index].path).len())?;
    let other = robots.iter().find(|other| other.world == Some(area.index))?;
    let path = components[area.index].path;
    let message =
        "this robot is wired to no world, and others are: neither the world nor they know where it is";
    let finding = Finding::new(Place::component(robot.index), message)
        .label(Place::component(other.index), "this one is wired");
    Some(finding.help(match around(path) == around(own) {
        true => {
            let name = path.rsplit('/').next().unwrap_or(path);
            format!("give it a `<reference name=\"world\" target=\"{name}\"/>`")
        }
        false => format!("wire its reference `world` to `{path}`, through the composites in between"),
    }))
}
