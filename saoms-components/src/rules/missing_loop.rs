//! Rule: a robot has no loop for a part of its work.

use std::collections::HashSet;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::{Environment, EventSpec, Scenario};
use crate::messages::{CRITICAL_SITUATION, ROBOT_LIST};
use crate::robot::Robot;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5017",
        name: "missing-loop",
        meaning: "A robot has no loop for a part of its work: it never moves, takes no luggage, cannot handle it, \
            drives into other robots, is unknown to them, or cannot be helped by them.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

/// A part of a robot's work.
struct Part {
    /// The last part of the names of its loops.
    name: &'static str,
    /// What a robot without the loop does, where `{}` is the robot.
    without: &'static str,
    /// What a loop in its place has to do.
    instead: &'static str,
    /// The fleets in which the loop is needed.
    needed: Needed,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Needed {
    Always,
    /// Where there are other robots.
    Together,
    /// Where robots break down, or stop at the end of a shift.
    InTrouble,
}

const MOVES: Part = Part {
    name: "PathFollowerMS",
    without: "nothing moves {}",
    instead: "sets `drive` and `next`",
    needed: Needed::Always,
};

/// The parts of a robot that moves.
const PARTS: [Part; 5] = [
    Part {
        name: "EventLuggageMS",
        without: "{} never takes waiting luggage",
        instead: "sets `job`",
        needed: Needed::Always,
    },
    Part {
        name: "GripperMS",
        without: "{} neither collects nor deposits luggage",
        instead: "sets `grip`",
        needed: Needed::Always,
    },
    Part {
        name: "CollisionMS",
        without: "{} drives into other robots",
        instead: "sets `stopAPeriod`",
        needed: Needed::Together,
    },
    Part {
        name: "RobotListMS",
        without: "other robots do not know of {}",
        instead: "publishes on `RLMSTOPIC`",
        needed: Needed::Together,
    },
    Part {
        name: "CriticalSituationMS",
        without: "{} neither calls for help nor helps other robots",
        instead: "publishes on `CSMSTOPIC`",
        needed: Needed::InTrouble,
    },
];

/// The loop of the policy `classic` that also moves the gripper.
pub(super) const CLASSIC_PATH_FOLLOWER: &str = "saoms.classic.PathFollowerMS";

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots: Vec<usize> = fleet.indices::<Robot>().collect();
    let in_trouble = robots.len() > 1 && has_trouble(fleet, &robots);
    let is_needed = |part: &Part| match part.needed {
        Needed::Always => true,
        Needed::Together => robots.len() > 1,
        Needed::InTrouble => in_trouble,
    };
    robots.iter().flat_map(|index| findings(fleet, *index, is_needed)).collect()
}

fn findings(fleet: &FleetView<'_>, index: usize, is_needed: impl Fn(&Part) -> bool) -> Vec<Finding> {
    let component = &fleet.components()[index];
    let class = &component.class;
    // A loop of another crate may do the work.
    if class.loops.iter().any(|name| !name.starts_with("saoms.")) {
        return Vec::new();
    }
    let has = |part: &Part| match part.name {
        "GripperMS" if class.loops.contains(&CLASSIC_PATH_FOLLOWER) => true,
        "RobotListMS" if class.publishes.contains(&ROBOT_LIST.name()) => true,
        "CriticalSituationMS" if class.publishes.contains(&CRITICAL_SITUATION.name()) => true,
        own => class.loops.iter().any(|name| name.rsplit('.').next() == Some(own)),
    };
    let finding = |part: &Part| {
        let without = part.without.replace("{}", &format!("`{}`", component.path));
        Finding::new(Place::component(index), format!("{without}: it has no loop `{}`", part.name))
            .help(format!("keep `{}`, or add a loop that {} in its place", part.name, part.instead))
    };
    // A robot that never moves does nothing else either.
    if !has(&MOVES) {
        return vec![finding(&MOVES)];
    }
    PARTS.iter().filter(|part| is_needed(part) && !has(part)).map(finding).collect()
}

/// True if a robot breaks down by a scenario, or starts and stops with shifts.
fn has_trouble(fleet: &FleetView<'_>, robots: &[usize]) -> bool {
    let scheduled: HashSet<usize> =
        fleet.components().iter().flat_map(|one| one.wires.iter().map(|(_, target)| *target)).collect();
    robots.iter().any(|index| scheduled.contains(index))
        || fleet.all::<Environment>().any(|(_, properties)| {
            let (scenario, _) = Scenario::read_partly(&properties.scenario);
            scenario.lines().iter().any(|line| matches!(line.event, EventSpec::Breakdown(_)))
        })
}
