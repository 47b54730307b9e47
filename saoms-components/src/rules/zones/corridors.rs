//! Rule: zones in which robots cannot get past each other, though their map has room for that.

use std::collections::HashSet;

use saoms_api::Finding;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};

use super::ZoneOfSite;
use crate::grid::{Block, Map};
use crate::zone::Zone;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5027",
        name: "corridor-zone",
        meaning: "A zone is one block wide somewhere, and the map is not: the other blocks are those of another zone, \
            which grants them. A zone lets robots make way on its own blocks alone, so that robots that meet there may \
            wait for each other for ever.",
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
    zones.iter().filter(|zone| zones.iter().any(|other| zone.is_beside(other))).filter_map(corridor).collect()
}

/// The blocks of a zone that are a corridor only because of its borders.
fn corridor(zone: &ZoneOfSite<'_>) -> Option<Finding> {
    let map = &zone.map;
    let of_zone = |block: Block| map.is_free(block) && zone.territory.contains(block);
    let narrow = bridges(map, of_zone);
    let mut narrow: Vec<(Block, Block)> = narrow.into_iter().collect();
    // A block of its own is no way at all.
    let blocks = || (0..map.size()).map(|place| map.block(place)).filter(|block| of_zone(*block));
    let ways = |block: Block, is_free: &dyn Fn(Block) -> bool| {
        block.neighbours().into_iter().filter(|to| is_free(*to)).count()
    };
    let alone = blocks().filter(|block| ways(*block, &of_zone) == 0 && ways(*block, &|to| map.is_free(to)) > 1);
    let mut found: Vec<Block> = alone.collect();
    if !narrow.is_empty() {
        let everywhere = bridges(map, |block| map.is_free(block));
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

/// The moves between free blocks without which one of both cannot be reached from the other: where robots cannot get
/// past each other.
fn bridges(map: &Map, is_free: impl Fn(Block) -> bool) -> HashSet<(Block, Block)> {
    /// A block of the search, the one before, and the next of its neighbours to look at.
    struct Visit {
        place: usize,
        before: usize,
        next: usize,
    }
    const NONE: usize = usize::MAX;
    let mut found = HashSet::new();
    let mut order = vec![NONE; map.size()];
    let mut low = order.clone();
    let mut count = 0;
    for start in 0..map.size() {
        if order[start] != NONE || !is_free(map.block(start)) {
            continue;
        }
        let mut stack = vec![Visit { place: start, before: NONE, next: 0 }];
        (order[start], low[start]) = (count, count);
        count += 1;
        while let Some(Visit { place, before, next }) = stack.last_mut() {
            let (place, before) = (*place, *before);
            let neighbours = map.block(place).neighbours();
            let Some(to) = neighbours.get(*next).copied() else {
                stack.pop();
                if before != NONE {
                    low[before] = low[before].min(low[place]);
                    if low[place] > order[before] {
                        let (one, other) = (map.block(before), map.block(place));
                        found.insert((one.min(other), one.max(other)));
                    }
                }
                continue;
            };
            *next += 1;
            let Some(to) = map.place(to).filter(|_| is_free(to)).filter(|to| *to != before) else { continue };
            if order[to] == NONE {
                (order[to], low[to]) = (count, count);
                count += 1;
                stack.push(Visit { place: to, before: place, next: 0 });
            } else {
                low[place] = low[place].min(order[to]);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bridges_are_where_robots_cannot_get_past_each_other() {
        let narrow = |text: &str| {
            let map = Map::read(text).unwrap();
            let mut found: Vec<String> = bridges(&map, |block| map.is_free(block))
                .into_iter()
                .map(|(one, other)| format!("{one}-{other}"))
                .collect();
            found.sort();
            found.join(" ")
        };
        assert_eq!(narrow("...\n..."), "");
        assert_eq!(narrow("..."), "(0,0)-(1,0) (1,0)-(2,0)");
        assert_eq!(narrow("..@..\n.....\n..@.."), "(1,1)-(2,1) (2,1)-(3,1)");
        assert_eq!(narrow("...\n.@.\n..."), "", "a ring");
    }
}
