//! Rule: a world has no robots.

use std::collections::{HashMap, HashSet};

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::Environment;
use crate::messages::{AREA, ROBOT_LIST};
use crate::robot::Robot;
use crate::rules::hearing::site_of;
use crate::rules::map::{WorldMap, areas};
use crate::rules::robots::{FleetRobot, by_world, may_be_others, robots};
use crate::world::World;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5009",
        name: "unused-world",
        meaning: "A fleet has a world, but some or all robots are not wired to it: the world does not check what \
            they do. A robot of another site counts if the world receives its messages.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let robots = robots(fleet);
    // A wire with a fault may lead to a world.
    if may_be_others(fleet) || fleet.misses::<Robot>() {
        return Vec::new();
    }
    if fleet.indices::<Robot>().next().is_none() {
        return alone(fleet).collect();
    }
    if robots.is_empty() {
        return Vec::new();
    }
    // The first robot of each world; below, other components that are wired to a world.
    let mut first = by_world(&robots);
    first.dedup_by_key(|(world, _)| *world);
    let wires = fleet.components().iter().flat_map(|one| one.wires.iter().map(|(_, target)| *target));
    let mut used: Vec<usize> = wires.collect();
    // Another rule reports robots that are wired to the wrong one.
    used.extend(robots.iter().filter_map(|robot| robot.other_world(fleet)));
    used.sort_unstable();
    let mut findings = Vec::new();
    // Robots that a world does not hear of are not those that it is for.
    let list = |index: usize| fleet.components()[index].topic(ROBOT_LIST.name());
    let known: HashSet<&str> = robots.iter().map(|robot| list(robot.index)).collect();
    // The last world to which robots of each composite are wired, by the common prefix of their paths.
    let mut around: Around<'_> = HashMap::new();
    for area in areas(fleet) {
        let index = area.index;
        if used.binary_search(&index).is_err() && known.contains(list(index)) {
            findings.push(without_robots(fleet, &area, &robots));
        } else if let Ok(place) = first.binary_search_by_key(&index, |(world, _)| *world) {
            let (_, robot) = first[place];
            around.insert((composite(fleet.components()[index].path), list(robot.index)), (index, robot));
        }
    }
    let lost = robots.iter().filter(|robot| robot.world.is_none());
    findings.extend(lost.filter_map(|robot| beside(fleet, robot, &around)));
    findings
}

/// The findings about worlds that no component is wired to and no environment has events for, in a fleet or a site
/// without robots. That luggage has no robot is reported by another rule.
fn alone<'f>(fleet: &'f FleetView<'_>) -> impl Iterator<Item = Finding> + use<'f> {
    // Composites that others use may have a world alone.
    let has_events = !fleet.is_site_of_several() || fleet.indices::<Environment>().next().is_some();
    let is_used = |world: usize| {
        let mut wires = fleet.components().iter().flat_map(|one| one.wires.iter());
        wires.any(|(_, target)| *target == world)
    };
    let worlds = fleet.indices::<World>().filter(move |world| !has_events && !is_used(*world));
    worlds.map(|world| {
        let component = &fleet.components()[world];
        let message = match site_of(AREA.name(), component.topic(AREA.name())).unwrap_or("") {
            "" => "no robot is in this world: it is in no site, or the fleet has no robot there".to_owned(),
            site => format!("no robot is in this world: the site `{site}` has none"),
        };
        Finding::new(Place::component(world), message)
            .help("move it to its robots, add a `saoms.Robot` with a reference `world` to it, or remove it")
    })
}

/// The worlds of robots, each with one of them, by composites and the names on the bus of the lists of robots.
type Around<'r> = HashMap<(&'r str, &'r str), (usize, &'r FleetRobot)>;

/// Path of a component's composite, with the slash at its end.
fn composite(path: &str) -> &str {
    path.rfind('/').map_or("", |at| &path[..=at])
}

/// The finding at the first robot that is wired to no world; if there is none, at the world.
fn without_robots(fleet: &FleetView<'_>, area: &WorldMap, robots: &[FleetRobot]) -> Finding {
    let effect = match area.map.is_open() {
        true => "the world sees no robots and no delivered luggage",
        false => "the robots ignore its blocked blocks",
    };
    let path = fleet.components()[area.index].path;
    let around = composite(path);
    let list = |index: usize| fleet.components()[index].topic(ROBOT_LIST.name());
    let unwired = || robots.iter().filter(|robot| robot.world.is_none() && list(robot.index) == list(area.index));
    let is_beside = |robot: &FleetRobot| composite(fleet.components()[robot.index].path) == around;
    let help = match robots.iter().filter(|robot| robot.world.is_none()).find(|robot| !is_beside(robot)) {
        // A target leads to what is in the same composite.
        Some(robot) if !robots.iter().any(is_beside) => between(fleet.components()[robot.index].path, path),
        _ => format!("give each robot `<reference name=\"world\" target=\"{}\"/>`", &path[around.len()..]),
    };
    let Some(robot) = unwired().next() else {
        let message = format!("no robot is wired to this world, so {effect}");
        return Finding::new(Place::component(area.index), message).help(help);
    };
    let robot_path = fleet.components()[robot.index].path;
    let more: Vec<&FleetRobot> = unwired().skip(1).collect();
    let who = match &more[..] {
        [] => format!("robot `{robot_path}` is"),
        [other] => format!("robots `{robot_path}` and `{}` are", fleet.components()[other.index].path),
        more => format!("`{robot_path}` and {} other robots are", more.len()),
    };
    let message = format!("{who} not wired to the world, so {effect}");
    Finding::new(Place::property("world").in_component(robot.index), message)
        .label(Place::component(area.index), "the world")
        .help(help)
}

/// How a wire leads from a robot to a world in another composite: the outermost components that differ are wired, and
/// those around the two promote.
fn between(robot: &str, world: &str) -> String {
    let both = robot.split('/').zip(world.split('/')).take_while(|(robot, world)| robot == world);
    let shared: usize = both.map(|(name, _)| name.len() + 1).sum();
    let ends = |path: &str| {
        let (outer, inner) = path[shared..].split_once('/').unwrap_or((&path[shared..], ""));
        (path[..shared].to_owned() + outer, inner.to_owned())
    };
    let ((robot, of_robot), (world, of_world)) = (ends(robot), ends(world));
    let promotes = |outer: &str, inner: &str, what: &str| match inner {
        "" => None,
        inner => Some(format!("let `{outer}` promote the {what} of `{inner}`, unless it does already")),
    };
    let promotes =
        [promotes(&robot, &of_robot, "reference `world`"), promotes(&world, &of_world, "service `hardware`")];
    let promotes: Vec<String> = promotes.into_iter().flatten().collect();
    let target = &world[shared..];
    format!("add `<reference name=\"world\" target=\"{target}\"/>` to `{robot}`, and {}", promotes.join(", and "))
}

/// A finding for a robot without a world if other robots in its composite have one; the innermost composite counts.
fn beside(fleet: &FleetView<'_>, robot: &FleetRobot, around: &Around<'_>) -> Option<Finding> {
    let component = &fleet.components()[robot.index];
    let (own, list) = (composite(component.path), component.topic(ROBOT_LIST.name()));
    let mut outer = std::iter::successors(Some(own), |path| Some(composite(path.strip_suffix('/')?)));
    let (world, other) = outer.find_map(|path| around.get(&(path, list)))?;
    let path = fleet.components()[*world].path;
    let message =
        "this robot is not wired to a world, but others are: the world and the other robots do not know where it is";
    let finding = Finding::new(Place::component(robot.index), message);
    // A robot of another use of the composite is written in the same place.
    let finding = match composite(fleet.components()[other.index].path) == own {
        true => finding.label(Place::component(other.index), "this robot is wired"),
        false => finding,
    };
    Some(finding.help(match composite(path) == own {
        true => format!("add `<reference name=\"world\" target=\"{}\"/>` to this robot", &path[own.len()..]),
        false => between(component.path, path),
    }))
}
