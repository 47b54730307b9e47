//! Rule: so many robots are on a map that some do not get to their chargers in time.

use std::collections::BTreeMap;
use std::time::Duration;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::robot::safe::RESERVE;
use crate::robot::{Battery, Policy};
use crate::rules::divided::Parts;
use crate::rules::map::{WorldMap, areas};
use crate::rules::robots::{FleetRobot, robots};

use super::Range;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5029",
        name: "crowded",
        meaning: "Six robots or more, of the policy `safe` and with batteries that discharge, have five free blocks of \
            the map each, or fewer; or they have 25, and six or more have batteries that last for less than 42 moves. \
            They are in each other's way to the chargers, and some may be stranded, however many chargers there are.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

/// Number of robots below which there is no crowd: each one gets away as soon as one of the others moves.
const LEAST: usize = 6;

/// Number of free blocks for each robot up to which they are a crowd. Of random sites with no more than that, two of
/// three had stranded robots in some runs; of those with more, one of eight.
const BLOCKS: usize = 5;

/// The same for robots with small batteries. Of random sites of six to sixteen blocks for each robot, all but a few had
/// stranded robots in some runs; with batteries for 50 moves, one of six in one run of ten.
const BLOCKS_OF_SMALL: usize = 25;

/// Number of moves that a battery has to last so that it is no small one: a robot keeps a third of it at most for
/// waiting, and needs the usual reserve.
const LEAST_MOVES: u32 = 3 * RESERVE;

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let all = robots(fleet);
    let mut of_worlds: BTreeMap<usize, Vec<&FleetRobot>> = BTreeMap::new();
    for robot in all.iter().filter(|robot| may_be_stranded(fleet, robot)) {
        if let Some(world) = robot.ground {
            of_worlds.entry(world).or_default().push(robot);
        }
    }
    of_worlds.retain(|_, robots| robots.len() >= LEAST);
    if of_worlds.is_empty() {
        return Vec::new();
    }
    areas(fleet).filter_map(|area| crowd(fleet, &area, of_worlds.get(&area.index)?)).collect()
}

/// True if a robot stays where it is once its battery is empty, and it can be.
fn may_be_stranded(fleet: &FleetView<'_>, robot: &FleetRobot) -> bool {
    let Ok(consumption) = robot.properties.consumption() else { return false };
    let period = fleet.components()[robot.index].period.unwrap_or(Duration::from_secs(1));
    robot.properties.policy == Policy::Safe
        && Battery::new(100.0, consumption).executions_when_full(period, 1) < u32::MAX
}

/// The finding about the most crowded of the connected parts of a map, or about one where batteries are small.
fn crowd(fleet: &FleetView<'_>, area: &WorldMap, robots: &[&FleetRobot]) -> Option<Finding> {
    let parts = Parts::of(&area.map);
    let sizes = parts.sizes();
    let mut in_parts: BTreeMap<u32, Vec<&FleetRobot>> = BTreeMap::new();
    for robot in robots {
        // A robot that starts where none can be is told of elsewhere.
        if let Some(part) = parts.part(robot.start) {
            in_parts.entry(part).or_default().push(robot);
        }
    }
    let crowds = in_parts.into_iter().filter(|(_, robots)| robots.len() >= LEAST);
    let mut crowds: Vec<Crowd<'_>> = crowds
        .filter_map(|(part, robots)| Some(Crowd { blocks: *sizes.get(&part)?, robots, is_whole: sizes.len() == 1 }))
        .collect();
    crowds.sort_by(|one, other| (one.blocks * other.robots.len()).cmp(&(other.blocks * one.robots.len())));
    let first = crowds.first()?;
    if first.blocks <= first.robots.len() * BLOCKS {
        return Some(first.crowded(fleet, area));
    }
    let dense = crowds.iter().take_while(|crowd| crowd.blocks <= crowd.robots.len() * BLOCKS_OF_SMALL);
    dense.into_iter().find_map(|crowd| crowd.with_small_batteries(fleet, area))
}

/// Robots in a connected part of a map.
struct Crowd<'f> {
    /// Number of its free blocks.
    blocks: usize,
    robots: Vec<&'f FleetRobot>,
    /// True if the map has no other part.
    is_whole: bool,
}

impl Crowd<'_> {
    fn crowded(&self, fleet: &FleetView<'_>, area: &WorldMap) -> Finding {
        let (blocks, count) = (self.blocks, self.robots.len());
        let where_to = self.name();
        let message = format!(
            "{count} robots with batteries share {blocks} free blocks: they may be in each other's way to the \
            chargers until some are stranded"
        );
        let given = |name: &str| fleet.components()[area.index].values.iter().any(|(given, _)| given == name);
        let place = ["map", "width", "height"]
            .into_iter()
            .find(|name| given(name))
            .map_or_else(Place::default, Place::property);
        let enough = count * BLOCKS + 1;
        let most = (blocks.saturating_sub(1) / BLOCKS).max(LEAST - 1);
        let discharge = self.discharge();
        let help = format!(
            "make {where_to} larger, {enough} free blocks or more, or have {most} robots or fewer there; or let \
            batteries last for ever, with {discharge} 0; or accept this with `saoms:severity`"
        );
        let first = self.robots.first().map(|first| first.index).unwrap_or_default();
        Finding::new(place.in_component(area.index), message)
            .label(Place::component(first), format!("the first of these {count} robots"))
            .help(help)
    }

    /// The finding at the robot with the smallest battery, if there are many small ones.
    fn with_small_batteries(&self, fleet: &FleetView<'_>, area: &WorldMap) -> Option<Finding> {
        let (blocks, count) = (self.blocks, self.robots.len());
        let moves = |robot: &FleetRobot| Range::of(fleet, area, robot).map(|range| range.full / range.moving.max(1));
        let small = self.robots.iter().filter_map(|robot| Some((moves(robot)?, robot.index)));
        let small: Vec<(u32, usize)> = small.filter(|(moves, _)| *moves < LEAST_MOVES).collect();
        // A few of them get away, since those that can wait make way for them.
        let (moves, index) = small.iter().min().copied().filter(|_| small.len() >= LEAST)?;
        let message = format!(
            "a full battery lasts for {moves} moves, and {count} robots share {blocks} free blocks: too little is left \
            for waiting on the way to the charger, and some may be stranded"
        );
        let given = |name: &str| fleet.components()[index].values.iter().any(|(given, _)| given == name);
        let names = ["discharge", "dischargePerBlock", "dischargePerSecond"];
        let place = names.into_iter().find(|name| given(name)).map_or_else(Place::default, Place::property);
        let help = format!(
            "let batteries last for {LEAST_MOVES} moves or more, with less {} or a shorter `moveTime`, make {} larger, \
            {} free blocks or more, or have {} robots or fewer there; or accept this with `saoms:severity`",
            self.discharge(),
            self.name(),
            count * BLOCKS_OF_SMALL + 1,
            (blocks.saturating_sub(1) / BLOCKS_OF_SMALL).max(LEAST - 1),
        );
        Some(Finding::new(place.in_component(index), message).help(help))
    }

    fn name(&self) -> &'static str {
        if self.is_whole { "the map" } else { "this part of the map" }
    }

    /// The properties that say how fast batteries discharge.
    fn discharge(&self) -> &'static str {
        let is_physical = self.robots.iter().any(|robot| robot.properties.charge_per_second.is_some());
        if is_physical { "`dischargePerBlock` and `dischargePerSecond`" } else { "`discharge`" }
    }
}
