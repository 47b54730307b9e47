//! Rule: zones do not fit each other, the map or the robots.

pub(super) mod corridors;
mod maps;
pub(super) mod nodes;

use saoms_api::rule::{Code, ComponentView, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::grid::{Block, Map};
use crate::messages::{GRANT, GRANT_REQUEST, POSITION, ROBOT_LIST, Territory};
use crate::rules::missing_loop::CLASSIC_PATH_FOLLOWER;
use crate::rules::robots::robots;
use crate::world::World;
use crate::zone::{Zone, ZoneProperties};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5023",
        name: "zones",
        meaning: "Zones overlap, leave free blocks of the map out, or have blocks outside the map, or another map \
            than the world of their robots. Or a component of their site drives without their grants: a robot of the policy `classic`, or one of a class \
            that does not ask for grants.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: true,
    prevents_start: true,
    check,
};

/// A zone with its blocks.
pub(super) struct ZoneOfSite<'f> {
    index: usize,
    /// The name on the bus of the topic of its grants: zones that share it are zones of one site.
    grants: &'f str,
    /// Index of its world.
    world: Option<usize>,
    pub(super) map: Map,
    pub(super) territory: Territory,
}

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut zones = Vec::new();
    for (index, properties) in fleet.all::<Zone>() {
        match ZoneOfSite::of(fleet, index, &properties) {
            Ok(zone) => zones.extend(zone),
            Err(finding) => findings.push(*finding),
        }
        findings.extend(without_map(fleet, index, &properties));
    }
    findings.extend(zones.iter().filter_map(|zone| maps::differing(fleet, zone)));
    // What is missing of a zone with a fault is told once.
    if findings.is_empty() && !fleet.misses::<Zone>() {
        for (place, zone) in zones.iter().enumerate() {
            let same = |other: &&ZoneOfSite<'_>| other.grants == zone.grants;
            match zones[..place].iter().find(same) {
                Some(_) => findings.extend(overlap(fleet, &zones[..place], zone)),
                None => findings.extend(left_out(&zones, zone)),
            }
        }
    }
    findings.extend(without_grants(fleet));
    findings
}

impl<'f> ZoneOfSite<'f> {
    /// The zone; `None` where its map is told to be wrong elsewhere.
    pub(super) fn of(
        fleet: &FleetView<'f>,
        index: usize,
        properties: &ZoneProperties,
    ) -> Result<Option<ZoneOfSite<'f>>, Box<Finding>> {
        let component = &fleet.components()[index];
        let world = component.target("world");
        let map = match world {
            Some(world) => match fleet.components()[world].properties::<World>() {
                Some(properties) => properties.map().ok(),
                // Hardware of another class has a map of its own.
                None => return Ok(None),
            },
            // A zone without a map does not start. Its reference may lead nowhere, which is told where it stands.
            None => properties.map().ok().flatten(),
        };
        let Some(map) = map else { return Ok(None) };
        let territory = properties.territory(1, &map).map_err(|finding| Box::new(finding.in_component(index)))?;
        let grants = component.topic(GRANT.name());
        Ok(Some(ZoneOfSite { index, grants, world, map, territory }))
    }

    /// True if another zone grants blocks of the same map.
    pub(super) fn is_beside(&self, other: &ZoneOfSite<'_>) -> bool {
        (self.grants, self.world) == (other.grants, other.world) && self.index != other.index
    }

    /// True if a component asks the zones of its site.
    fn is_asked_by(&self, component: &ComponentView<'_>) -> bool {
        component.topic(GRANT.name()) == self.grants
    }

    pub(super) fn place(&self) -> Place {
        Place::component(self.index)
    }
}

/// A zone that no reference gives a map, and no property.
fn without_map(fleet: &FleetView<'_>, index: usize, properties: &ZoneProperties) -> Option<Finding> {
    let is_without =
        properties.map.is_none() && fleet.components()[index].target("world").is_none() && !fleet.misses::<Zone>();
    is_without.then(|| {
        Finding::new(Place::component(index), "the zone has no map")
            .help("wire its reference `world` to a world, or give it the property `map`")
    })
}

/// An earlier zone of the same site that has blocks of this zone.
fn overlap(fleet: &FleetView<'_>, earlier: &[ZoneOfSite<'_>], zone: &ZoneOfSite<'_>) -> Option<Finding> {
    let other = earlier.iter().find(|other| {
        other.grants == zone.grants && other.world == zone.world && shared(&other.territory, &zone.territory).is_some()
    })?;
    let block = shared(&other.territory, &zone.territory)?;
    let message = format!("two zones grant the block {block}: `{}` has it, too", fleet.components()[other.index].path);
    Some(
        Finding::new(zone.place(), message)
            .label(other.place(), "the first zone with this block")
            .help("give the zones `x`, `y`, `width` and `height` with which each block of the map is in one zone"),
    )
}

/// The first block that two territories share.
fn shared(one: &Territory, other: &Territory) -> Option<Block> {
    let corner = Block::new(one.corner.x.max(other.corner.x), one.corner.y.max(other.corner.y));
    (one.contains(corner) && other.contains(corner)).then_some(corner)
}

/// Free blocks that no zone of a site grants.
fn left_out(zones: &[ZoneOfSite<'_>], first: &ZoneOfSite<'_>) -> Option<Finding> {
    let of_site = || zones.iter().filter(|zone| zone.grants == first.grants && zone.world == first.world);
    let is_left_out = |block: &Block| !of_site().any(|zone| zone.territory.contains(*block));
    let free = (0..first.map.size()).map(|place| first.map.block(place)).filter(|block| first.map.is_free(*block));
    let mut left_out = free.filter(is_left_out);
    let block = left_out.next()?;
    let blocks = left_out.count() + 1;
    let (noun, verb) = if blocks == 1 { ("block", "is") } else { ("blocks", "are") };
    let message = format!("{blocks} free {noun} of the map {verb} in no zone, {block} first: no robot could enter");
    Some(Finding::new(first.place(), message).help(
        "give the zones `x`, `y`, `width` and `height` with which each block of the map is in one zone; a single zone \
         without them has all",
    ))
}

/// Components of sites with zones that drive without grants.
fn without_grants(fleet: &FleetView<'_>) -> Vec<Finding> {
    let components = fleet.components();
    let zone_of = |index: usize| {
        let grants = components[index].topic(GRANT.name());
        fleet.indices::<Zone>().find(|zone| components[*zone].topic(GRANT.name()) == grants)
    };
    let mut findings = Vec::new();
    if fleet.indices::<Zone>().next().is_none() {
        return findings;
    }
    for robot in robots(fleet).iter() {
        if components[robot.index].class.loops.contains(&CLASSIC_PATH_FOLLOWER)
            && let Some(zone) = zone_of(robot.index)
        {
            let message = "a robot of the policy `classic` asks no zone, and its site has zones";
            findings.push(
                Finding::new(Place::property("policy").in_component(robot.index), message)
                    .label(Place::component(zone), "a zone of its site")
                    .help("use the policy `safe`, or remove the zones"),
            );
        }
    }
    for (index, component) in components.iter().enumerate() {
        let publishes = |topic: &str| component.class.publishes.contains(&topic);
        let drives = publishes(POSITION.name()) || publishes(ROBOT_LIST.name());
        let (asks, hears) = (publishes(GRANT_REQUEST.name()), component.class.subscribes.contains(&GRANT.name()));
        if !drives || asks && hears {
            continue;
        }
        let Some(zone) = zone_of(index) else { continue };
        let fault = if asks { "hears no grants of its zone" } else { "asks no zone for grants" };
        let message = format!("`{}` is a robot that {fault}", component.path);
        findings.push(
            Finding::new(Place::component(index), message).label(Place::component(zone), "a zone of its site").help(
                "let its class extend `saoms.Robot`, or publish `GRANTREQUESTTOPIC` and read `GRANTTOPIC` as \
                     docs/zones.md describes; or remove the zones",
            ),
        );
    }
    findings
}
