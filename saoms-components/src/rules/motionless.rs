//! Rule: a robot has no loop that moves it.

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::robot::Robot;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5017",
        name: "motionless",
        meaning: "A robot has no loop that moves it: it never leaves its charger.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    // A loop of another crate may move the robot.
    let stands = |name: &str| name.starts_with("saoms.") && !name.ends_with(".PathFollowerMS");
    let robots = fleet.indices::<Robot>();
    let standing = robots.filter(|index| fleet.components()[*index].class.loops.iter().all(|name| stands(name)));
    let finding = |index: usize| {
        let message = format!("nothing moves `{}`: it has no loop `PathFollowerMS`", fleet.components()[index].path);
        Finding::new(Place::component(index), message)
            .help("keep `PathFollowerMS`, or add a loop that changes `block` and `next` in its place")
    };
    standing.map(finding).collect()
}
