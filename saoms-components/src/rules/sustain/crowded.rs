//! Rule: so many robots are on a map that some do not get to their chargers in time.

use std::collections::BTreeMap;
use std::time::Duration;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::robot::{Battery, Policy};
use crate::rules::divided::Parts;
use crate::rules::map::{WorldMap, areas};
use crate::rules::robots::{FleetRobot, robots};

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5029",
        name: "crowded",
        meaning: "Six robots or more, of the policy `safe` and with batteries that discharge, have five free blocks of \
            the map each, or fewer. They are in each other's way to the chargers, and some may be stranded, however \
            many chargers there are.",
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

/// The finding about the most crowded of the connected parts of a map.
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
    let sized = crowds.filter_map(|(part, robots)| Some((*sizes.get(&part)?, robots)));
    let crowded = sized.filter(|(blocks, robots)| *blocks <= robots.len() * BLOCKS);
    let (blocks, robots) = crowded.min_by(|(one, few), (other, many)| (one * many.len()).cmp(&(other * few.len())))?;
    let (first, count) = (robots.first()?, robots.len());
    let where_to = if sizes.len() == 1 { "the map" } else { "this part of the map" };
    let message = format!(
        "{count} robots with batteries share {blocks} free blocks: they may be in each other's way to the chargers \
        until some are stranded"
    );
    let given = |name: &str| fleet.components()[area.index].values.iter().any(|(given, _)| given == name);
    let place =
        ["map", "width", "height"].into_iter().find(|name| given(name)).map_or_else(Place::default, Place::property);
    let enough = count * BLOCKS + 1;
    let most = (blocks.saturating_sub(1) / BLOCKS).max(LEAST - 1);
    let is_physical = robots.iter().any(|robot| robot.properties.charge_per_second.is_some());
    let discharge = if is_physical { "`dischargePerBlock` and `dischargePerSecond`" } else { "`discharge`" };
    let help = format!(
        "make {where_to} larger, {enough} free blocks or more, or have {most} robots or fewer there; or let batteries \
        last for ever, with {discharge} 0; or accept this with `saoms:severity`"
    );
    Some(
        Finding::new(place.in_component(area.index), message)
            .label(Place::component(first.index), format!("the first of these {count} robots"))
            .help(help),
    )
}
