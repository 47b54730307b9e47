//! Worlds that no robot is in.

use saoms_api::{Code, Finding, FleetRule, FleetView, Place, Severity};

use super::map::areas;
use super::robots::{may_be_others, robots};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5009",
        name: "unused-world",
        meaning: "A fleet has a world, and none of its robots is wired to it: they move, collect and deposit without it.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    if robots.is_empty() || may_be_others(fleet) {
        return Vec::new();
    }
    let is_unused = |index: usize| {
        fleet.components().iter().all(|one| one.wires.iter().all(|(_, target)| *target != index))
    };
    let unused = areas(fleet).into_iter().filter(|area| is_unused(area.index));
    let findings = unused.map(|area| {
        let message = match area.map.is_open() {
            true => "no robot is wired to this world, so it sees neither robots nor what they deliver",
            false => "no robot is wired to this world, so robots move through its blocked blocks",
        };
        let path = fleet.components()[area.index].path;
        let help = format!("give each robot in it a `<reference name=\"world\" target=\"{path}\"/>`");
        Finding::new(Place::component(area.index), message).help(help)
    });
    findings.collect()
}
