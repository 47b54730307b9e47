//! Rule: zones in which robots cannot get past each other, though their map has room for that, and zones that end in
//! the middle of a corridor.

use saoms_api::Finding;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};

use super::ZoneOfSite;
use crate::grid::Block;
use crate::rules::cuts::Cuts;
use crate::zone::Zone;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5027",
        name: "corridor-zone",
        meaning: "A zone is one block wide somewhere, and the map is not: the other blocks are those of another zone, \
            which grants them. Or the border between two zones is in the middle of a corridor of the map. A zone lets \
            robots make way on its own blocks alone, so that robots that meet there may wait for each other for ever.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let zones: Vec<ZoneOfSite<'_>> = fleet
        .all::<Zone>()
        .filter_map(|(index, properties)| ZoneOfSite::of(fleet, index, &properties).ok().flatten())
        .collect();
    let mut findings: Vec<Finding> =
        zones.iter().filter(|zone| zones.iter().any(|other| zone.is_beside(other))).filter_map(corridor).collect();
    for (place, zone) in zones.iter().enumerate() {
        findings.extend(cut_corridor(fleet, zone, &zones[place + 1..]));
    }
    findings
}

/// The corridors of the map in which a zone ends and a later one begins.
fn cut_corridor(fleet: &FleetView<'_>, zone: &ZoneOfSite<'_>, later: &[ZoneOfSite<'_>]) -> Option<Finding> {
    let map = &zone.map;
    let mut found: Vec<(Block, Block, &ZoneOfSite<'_>)> = Vec::new();
    for other in later.iter().filter(|other| zone.is_beside(other)) {
        // Robots cannot get past each other at either side: there is one way on, in the same zone.
        let is_corridor = |block: Block, side: &ZoneOfSite<'_>| {
            let is_free = |to: &Block| map.is_free(*to) && side.territory.contains(*to);
            is_free(&block) && block.neighbours().iter().filter(|to| is_free(to)).count() == 1
        };
        let ends = (0..map.size()).map(|place| map.block(place)).filter(|block| is_corridor(*block, zone));
        let steps = ends.flat_map(|end| end.neighbours().into_iter().map(move |to| (end, to)));
        found.extend(steps.filter(|(_, to)| is_corridor(*to, other)).map(|(end, to)| (end, to, other)));
    }
    if !found.is_empty() {
        let bridges = Cuts::of(map, |block| map.is_free(block)).bridges();
        found.retain(|(end, to, _)| bridges.contains(&((*end).min(*to), (*end).max(*to))));
    }
    found.sort_by_key(|(end, ..)| (end.y, end.x));
    let (end, to, other) = *found.first()?;
    let more = match found.len() - 1 {
        0 => String::new(),
        1 => " (and in another corridor)".to_owned(),
        more => format!(" (and in {more} other corridors)"),
    };
    let message = format!(
        "the zone ends in the middle of a corridor, between {end} and {to}{more}: robots that meet there may wait for \
         each other for ever"
    );
    Some(
        Finding::new(zone.place(), message)
            .label(other.place(), format!("`{}` goes on from there", fleet.components()[other.index].path))
            .help(
                "move the border, with `x`, `y`, `width` and `height`, to an end of the corridor, or let one zone have \
                 both sides",
            ),
    )
}

/// The blocks of a zone that are a corridor only because of its borders.
fn corridor(zone: &ZoneOfSite<'_>) -> Option<Finding> {
    let map = &zone.map;
    let of_zone = |block: Block| map.is_free(block) && zone.territory.contains(block);
    let mut narrow: Vec<(Block, Block)> = Cuts::of(map, of_zone).bridges().into_iter().collect();
    // A block of its own is no way at all.
    let blocks = || (0..map.size()).map(|place| map.block(place)).filter(|block| of_zone(*block));
    let ways = |block: Block, is_free: &dyn Fn(Block) -> bool| {
        block.neighbours().into_iter().filter(|to| is_free(*to)).count()
    };
    let alone = blocks().filter(|block| ways(*block, &of_zone) == 0 && ways(*block, &|to| map.is_free(to)) > 1);
    let mut found: Vec<Block> = alone.collect();
    if !narrow.is_empty() {
        let everywhere = Cuts::of(map, |block| map.is_free(block)).bridges();
        narrow.retain(|edge| !everywhere.contains(edge));
        found.extend(narrow.into_iter().flat_map(|(one, other)| [one, other]));
    }
    found.sort_unstable_by_key(|block| (block.y, block.x));
    found.dedup();
    let (first, count) = (*found.first()?, found.len());
    let noun = if count == 1 { "block" } else { "blocks" };
    let message = format!(
        "robots cannot get past each other on {count} {noun} of the zone, {first} first: it is one block wide there, \
         and the map is not"
    );
    Some(Finding::new(zone.place(), message).help(
        "move the border, with `x`, `y`, `width` and `height`, so that the zone is at least two blocks wide there, or \
         let one zone have both sides",
    ))
}
