//! A zone whose own map differs from that of the world in which its robots drive.

use saoms_api::rule::FleetView;
use saoms_api::{Finding, Place};

use super::ZoneOfSite;
use crate::grid::Map;
use crate::rules::robots::robots;
use crate::world::World;

/// The first difference between the `map` of a zone and the map of a world of its robots.
pub(super) fn differing(fleet: &FleetView<'_>, zone: &ZoneOfSite<'_>) -> Option<Finding> {
    if zone.world.is_some() {
        return None;
    }
    let components = fleet.components();
    let all = robots(fleet);
    let asking = all.iter().filter(|robot| zone.is_asked_by(&components[robot.index]));
    let mut worlds: Vec<usize> = asking.filter_map(|robot| components[robot.index].target("world")).collect();
    worlds.sort_unstable();
    worlds.dedup();
    worlds.into_iter().find_map(|world| {
        let map = components[world].properties::<World>()?.map().ok()?;
        let difference = difference(&zone.map, &map)?;
        let message = format!("the map of the zone is not that of `{}`: {difference}", components[world].path);
        let finding = Finding::new(Place::property("map").in_component(zone.index), message);
        let finding = finding.label(Place::component(world), "robots of its site drive here");
        Some(finding.help("leave `map` out, and wire the reference `world` of the zone to it"))
    })
}

fn difference(own: &Map, other: &Map) -> Option<String> {
    if (own.width(), own.height()) != (other.width(), other.height()) {
        let size = |map: &Map| format!("{} x {}", map.width(), map.height());
        return Some(format!("it has {} blocks, and that one {}", size(own), size(other)));
    }
    let mut blocks = (0..own.size()).map(|place| own.block(place));
    let block = blocks.find(|block| own.is_free(*block) != other.is_free(*block))?;
    let (here, there) = if own.is_free(block) { ("free", "blocked") } else { ("blocked", "free") };
    Some(format!("{block} is {here} here, and {there} there"))
}
