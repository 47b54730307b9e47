//! Rule: the parts of a map are not connected.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use saoms_api::Finding;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};

use super::budget::Budget;
use super::map::{LuggageLine, WorldMap, area, by_events, rows};
use super::robots::{FleetRobot, may_be_others, robots, unless_elsewhere};
use crate::environment::{Spanned, Spot};
use crate::grid::{Block, Map};

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5007",
        name: "map-divided",
        meaning: "The map has no path that connects a charger, the start of the luggage and its destination.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    if may_be_others(fleet) {
        return Vec::new();
    }
    let robots = robots(fleet);
    let all = by_events(fleet);
    let findings = all.iter().flat_map(|(events, luggage)| check_luggage(fleet, &robots, events, luggage)).collect();
    unless_elsewhere(fleet, findings)
}

/// The findings about luggage of one name of the events on the bus.
fn check_luggage(fleet: &FleetView<'_>, robots: &[FleetRobot], events: &str, luggage: &[LuggageLine]) -> Vec<Finding> {
    let Some(area) = area(fleet, events) else { return Vec::new() };
    let robots: Vec<&FleetRobot> = robots.iter().filter(|robot| robot.world == Some(area.index)).collect();
    if area.map.is_open() || robots.is_empty() {
        return Vec::new();
    }
    let parts = Parts::of(&area.map);
    // A charger on a block that no robot can enter is reported by another rule; its part is unknown.
    let chargers: Option<HashSet<u32>> = robots.iter().map(|robot| parts.part(robot.charger)).collect();
    let Some(chargers) = chargers else { return Vec::new() };
    let mut reached = Reached { area: &area, parts: &parts, chargers: &chargers, budget: Budget::default() };
    luggage.iter().flat_map(|piece| check_piece(&mut reached, piece)).collect()
}

/// Parts of the map that robots reach.
struct Reached<'a> {
    area: &'a WorldMap,
    parts: &'a Parts,
    /// Parts with chargers.
    chargers: &'a HashSet<u32>,
    budget: Budget,
}

fn check_piece(reached: &mut Reached<'_>, piece: &LuggageLine) -> Vec<Finding> {
    let mut findings: Vec<Finding> =
        [&piece.from, &piece.to].into_iter().filter_map(|spot| cut_off(reached, piece, spot)).collect();
    let parts = reached.parts;
    let ends = [&piece.from, &piece.to].map(|spot| spot.value.block().and_then(|block| parts.part(block)));
    if let [Some(from), Some(to)] = ends
        && from != to
        && findings.is_empty()
    {
        let message = "the map has no path from the start of this luggage to its destination";
        findings.push(
            Finding::new(piece.place(&piece.to), message)
                .label(piece.place(&piece.from), "the luggage starts here")
                .help(
                    "choose two blocks that a path connects with a charger, or open a path through the blocked blocks",
                ),
        );
    }
    findings
}

/// A finding if no robot can reach this spot from its charger.
fn cut_off(reached: &mut Reached<'_>, piece: &LuggageLine, spot: &Spanned<Spot>) -> Option<Finding> {
    const HELP: &str = "open a path through the blocked blocks, or add a robot with a charger in this part of the map";
    let Reached { area, parts, chargers, budget } = reached;
    if let Some(block) = spot.value.block() {
        let message = format!("the map has no path from any robot's charger to {block}");
        let is_cut = parts.part(block).is_some_and(|part| !chargers.contains(&part));
        return is_cut.then(|| Finding::new(piece.place(spot), message).help(HELP));
    }
    let (first, last) = spot.value.corners(Some(&area.map))?;
    let (mut cut, mut all) = (0, 0);
    let (rows, columns) = rows(first, last, &area.map);
    for row in rows {
        for part in parts.between(row, &columns) {
            let free = part.end.min(columns.end) - part.start.max(columns.start);
            all += free;
            cut += if chargers.contains(&part.part) { 0 } else { free };
            if !budget.admit(1) {
                return None;
            }
        }
        if !budget.admit(1) {
            return None;
        }
    }
    let message = format!("the map has no path from any robot's charger to {cut} of these {all} free blocks");
    let severity = if cut == all { Severity::Error } else { Severity::Warning };
    (cut > 0).then(|| Finding::new(piece.place(spot), message).severity(severity).help(HELP))
}

/// Connected parts of a map.
pub(super) struct Parts {
    /// Ranges of adjacent free blocks, row by row.
    ranges: Vec<FreeRange>,
    /// Index of each row's first range, and of the end of the last row.
    rows: Vec<usize>,
}

/// A range of adjacent free blocks in a row.
#[derive(Clone, Copy, Debug)]
struct FreeRange {
    start: u32,
    end: u32,
    /// Index of a range of the same part (union-find parent).
    part: u32,
}

impl Parts {
    /// Joins ranges that touch from row to row. The time depends on the number of blocked blocks and rows, not on the
    /// number of free blocks.
    pub(super) fn of(map: &Map) -> Parts {
        let (mut ranges, mut rows): (Vec<FreeRange>, Vec<usize>) = (Vec::new(), vec![0]);
        for row in 0..map.height() {
            let (mut above, end) = (rows.len().checked_sub(2).map_or(0, |row| rows[row]), ranges.len());
            for Range { start, end: own_end } in map.free_ranges(row, 0..map.width()) {
                let own = ranges.len();
                ranges.push(FreeRange { start, end: own_end, part: own as u32 });
                // A range that ends before this one touches none that comes later.
                while above < end && ranges[above].end <= start {
                    above += 1;
                }
                let mut other = above;
                while other < end && ranges[other].start < own_end {
                    let (one, two) = (root(&mut ranges, own), root(&mut ranges, other));
                    ranges[one.max(two)].part = one.min(two) as u32;
                    other += 1;
                }
            }
            rows.push(ranges.len());
        }
        for range in 0..ranges.len() {
            ranges[range].part = root(&mut ranges, range) as u32;
        }
        Parts { ranges, rows }
    }

    /// The ranges of a row with blocks in these columns.
    fn between(&self, row: u32, columns: &Range<u32>) -> &[FreeRange] {
        let row = row as usize;
        let (Some(start), Some(end)) = (self.rows.get(row), self.rows.get(row + 1)) else { return &[] };
        let all = &self.ranges[*start..*end];
        let from = all.partition_point(|range| range.end <= columns.start);
        let to = all.partition_point(|range| range.start < columns.end);
        &all[from..to.max(from)]
    }

    /// The part of a block; `None` if it is blocked, or outside the map.
    pub(super) fn part(&self, block: Block) -> Option<u32> {
        let (column, row) = (u32::try_from(block.x).ok()?, u32::try_from(block.y).ok()?);
        self.between(row, &(column..column + 1)).first().map(|range| range.part)
    }

    /// Number of blocks of each part.
    pub(super) fn sizes(&self) -> HashMap<u32, usize> {
        let mut sizes = HashMap::new();
        for range in &self.ranges {
            *sizes.entry(range.part).or_default() += (range.end - range.start) as usize;
        }
        sizes
    }
}

/// Root of a range's part, with path halving (Tarjan and van Leeuwen, "Worst-case Analysis of Set Union Algorithms",
/// 1984).
fn root(ranges: &mut [FreeRange], mut range: usize) -> usize {
    while ranges[range].part as usize != range {
        let above = ranges[range].part as usize;
        ranges[range].part = ranges[above].part;
        range = above;
    }
    range
}

#[cfg(test)]
mod tests {
    use saoms_api::Chance;

    use super::*;

    /// The part of each block, found by flood fill.
    fn flooded(map: &Map) -> HashMap<Block, Block> {
        let mut parts = HashMap::new();
        for start in (0..map.size()).map(|place| map.block(place)) {
            let mut open = vec![start];
            while let Some(block) = open.pop() {
                if map.is_free(block) && !parts.contains_key(&block) {
                    parts.insert(block, start);
                    open.extend(block.neighbours());
                }
            }
        }
        parts
    }

    #[test]
    fn two_blocks_are_in_one_part_where_a_way_leads_from_one_to_the_other() {
        let mut chance = Chance::new(7);
        for (width, height) in [(1, 1), (1, 9), (9, 1), (5, 4), (12, 9), (70, 5), (130, 12)] {
            for _ in 0..20 {
                let mut map = Map::new(width, height);
                for place in 0..map.size() {
                    if chance.range(0..=99) < 40 {
                        map.set_blocked(map.block(place));
                    }
                }
                let (parts, known) = (Parts::of(&map), flooded(&map));
                let mut names = HashMap::new();
                for block in (0..map.size()).map(|place| map.block(place)) {
                    let (part, known) = (parts.part(block), known.get(&block));
                    assert_eq!(part.is_some(), known.is_some(), "{block} of {map:?}");
                    if let (Some(part), Some(known)) = (part, known) {
                        assert_eq!(names.entry(known).or_insert(part), &part, "{block} of {map:?}");
                    }
                }
                let different: HashSet<u32> = names.values().copied().collect();
                assert_eq!(different.len(), names.len(), "{map:?}");
            }
        }
    }
}
