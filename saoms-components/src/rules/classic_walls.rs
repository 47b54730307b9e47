//! Rule: robots of the policy `classic` drive on a map with blocked blocks.

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::map::areas;
use super::missing_loop::CLASSIC_PATH_FOLLOWER;
use super::robots::robots;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5021",
        name: "classic-walls",
        meaning: "A robot of the policy `classic` is in a world with blocked blocks. It drives without regard to them, \
            and breaks down at the first one on its way.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let is_classic = |index: usize| fleet.components()[index].class.loops.contains(&CLASSIC_PATH_FOLLOWER);
    let worlds = areas(fleet).filter(|area| !area.map.is_open());
    let findings = worlds.filter_map(|area| {
        let mut classic = robots.iter().filter(|robot| robot.world == Some(area.index) && is_classic(robot.index));
        let first = classic.next()?;
        let others = match classic.count() {
            0 => String::new(),
            more => format!(" (this robot and {more} more)"),
        };
        let message =
            format!("the policy `classic` does not drive around blocked blocks, and this map has some{others}");
        let finding = Finding::new(Place::property("policy").in_component(first.index), message);
        Some(
            finding
                .label(Place::component(area.index), "the world")
                .help("use the policy `safe`, or a map without blocked blocks"),
        )
    });
    findings.collect()
}
