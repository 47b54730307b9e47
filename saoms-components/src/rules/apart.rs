//! Rule: robots of one world use different names of the topics that they share.

use std::collections::{HashMap, HashSet};

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::hearing::site_of;
use super::robots::{FleetRobot, by_world, publishers_beside_robots, robots};
use crate::messages::{CRITICAL_SITUATION, EVENT_LUGGAGE, POSITION, ROBOT_LIST};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5012",
        name: "robot-apart",
        meaning: "A `topicRename` or a site separates a robot from a topic that the other robots of its world use: \
            they collide with it, do not know its state, or it gets no work.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

/// Topics by which the robots of a world know of each other, the most important first, and what happens without. Teams
/// may have their own names of those with warnings: a robot that is alone with its name is in none.
const SHARED: [(&str, Severity, &str); 4] = [
    (POSITION.name(), Severity::Error, "they do not know where it is and collide with it"),
    (EVENT_LUGGAGE.name(), Severity::Warning, "it is never asked to bring luggage"),
    (CRITICAL_SITUATION.name(), Severity::Warning, "no other robot takes over its luggage if it breaks down"),
    (ROBOT_LIST.name(), Severity::Warning, "they do not know its state"),
];

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    let by_world = by_world(&robots);
    let (mut findings, mut told) = (Vec::new(), HashSet::new());
    for (world, robot) in &by_world {
        if let Some(own) = robot.other_world(fleet) {
            told.insert(robot.index);
            findings.push(in_other_world(fleet, robot, *world, own));
        }
    }
    for inside in by_world.chunk_by(|(one, _), (other, _)| one == other) {
        for (topic, severity, effect) in SHARED {
            let name = |robot: &FleetRobot| fleet.components()[robot.index].topic(topic);
            let inside = inside.iter().filter(|(_, robot)| robot.other_world(fleet).is_none());
            let mut counts: HashMap<&str, usize> = HashMap::new();
            for (_, robot) in inside.clone() {
                *counts.entry(name(robot)).or_default() += 1;
            }
            // The first robot with the name that most of them use.
            let most = counts.values().max().copied().unwrap_or_default();
            let Some((_, usual)) = inside.clone().find(|(_, robot)| counts[name(robot)] == most) else { continue };
            let others = name(usual);
            // A master may serve one robot alone.
            let served: HashSet<&str> = match topic == EVENT_LUGGAGE.name() {
                true => publishers_beside_robots(fleet, topic).map(|at| fleet.components()[at].topic(topic)).collect(),
                false => HashSet::new(),
            };
            for (_, robot) in inside {
                let own = name(robot);
                let is_apart = own != others
                    && !served.contains(own)
                    && (severity == Severity::Error || most > 1 && counts[own] == 1);
                if !is_apart || !told.insert(robot.index) {
                    continue;
                }
                let message = format!(
                    "robot {} uses the topic `{own}` where the other robots in its world use `{others}`: {effect}",
                    robot.number
                );
                let of_site = |name| site_of(topic, name).filter(|site| !site.is_empty());
                let help = match others == topic {
                    true if of_site(own).is_some() => {
                        "remove `saoms:site` there: all robots of a world need the same topics".to_owned()
                    }
                    true => format!("remove the pair `{topic},{own}`: all robots of a world need the same topics"),
                    false if others.contains('/') || own.contains('/') => {
                        format!("put all robots of a world into one site, or add the pair `{topic},/{others}`")
                    }
                    false => format!(
                        "add the pair `{topic},{others}` to the `topicRename` of this robot: the other robots have it"
                    ),
                };
                findings.push(
                    Finding::new(Place::topic(topic).in_component(robot.index), message)
                        .severity(severity)
                        .label(Place::topic(topic).in_component(usual.index), "another robot of this world")
                        .help(help),
                );
            }
        }
    }
    findings
}

/// The finding for a robot that is wired to a world other than that which hears of it.
fn in_other_world(fleet: &FleetView<'_>, robot: &FleetRobot, world: usize, own: usize) -> Finding {
    let (components, topic) = (fleet.components(), ROBOT_LIST.name());
    let list = |index: usize| components[index].topic(topic);
    let [path, own_path] = [world, own].map(|index| components[index].path);
    let message = format!(
        "robot {} is wired to `{path}`, which does not receive its messages: it publishes on the topic `{}`, `{path}` listens \
        to `{}`",
        robot.number,
        list(robot.index),
        list(world)
    );
    Finding::new(Place::property("world").in_component(robot.index), message)
        .label(Place::component(own), "this world receives the messages of the robot")
        .help(format!("wire the robot to `{own_path}`, or put it into the site of `{path}`"))
}
