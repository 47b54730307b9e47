//! Rule: no robot reaches both ends of luggage.

use std::collections::BTreeMap;

use saoms_api::Finding;
use saoms_api::rule::Severity;

use super::Range;
use super::reach::Ways;
use crate::environment::Spot;
use crate::grid::{Block, Map};
use crate::rules::map::{LuggageLine, WorldMap, rows};

/// Finding for luggage whose ends are in the reach of some robot each, and of no robot both.
pub(super) fn out_of_one_reach(
    area: &WorldMap,
    ranges: &[Range],
    piece: &LuggageLine,
    ways: &mut Ways<'_>,
) -> Option<Finding> {
    let spots = [piece.from.value, piece.to.value];
    if spots.iter().all(|spot| spot.block().is_some()) {
        let (from, to) = missed_corners(area, ranges, spots, ways)?;
        let message = format!("no robot can bring luggage from {from} to {to}: {TOO_FAR} of the two blocks");
        return Some(Finding::new(piece.whole(), message).severity(Severity::Error).help(CLOSER));
    }
    let (severity, message) = match ways.count(|ways| missed_pairs(&area.map, ranges, spots, ways)) {
        Some(MissedPairs { missed, all, first: (from, to) }) => {
            let severity = if missed == all { Severity::Error } else { Severity::Warning };
            let which = format!("{missed} of the {all} pairs of blocks here, such as {from} and {to}");
            (severity, format!("no robot can bring luggage between {which}: {TOO_FAR} of the two"))
        }
        // Where the pairs are too many to count, one is enough.
        None => {
            let (from, to) = missed_corners(area, ranges, spots, ways)?;
            let message = format!("no robot can bring luggage from {from} to {to}: {TOO_FAR} of the two blocks");
            (Severity::Warning, message)
        }
    };
    Some(Finding::new(piece.whole(), message).severity(severity).help(CLOSER))
}

const TOO_FAR: &str = "the charger of each robot is too far from one";

const CLOSER: &str = "put the charger of a robot closer to both blocks, or reduce the energy that a move needs; each \
    robot uses its own charger";

/// A pair of corners of two spots that no robot brings.
fn missed_corners(area: &WorldMap, ranges: &[Range], spots: [Spot; 2], ways: &mut Ways<'_>) -> Option<(Block, Block)> {
    let [starts, ends] = spots.map(|spot| farthest(area, spot));
    for from in starts {
        for to in ends.iter().filter(|to| **to != from) {
            if !ways.is_brought(ranges, from, *to)? {
                return Some((from, *to));
            }
        }
    }
    None
}

/// The blocks to check: the single block, or the free corners of a rectangle.
fn farthest(area: &WorldMap, spot: Spot) -> Vec<Block> {
    let Some((first, last)) = spot.corners(Some(&area.map)) else { return Vec::new() };
    let corners = [first, last, Block::new(first.x, last.y), Block::new(last.x, first.y)];
    let mut corners: Vec<Block> = corners.into_iter().filter(|block| area.map.is_free(*block)).collect();
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// Maximum number of looks at a robot and a block for one line: beyond it, the pairs are not counted.
const LOOKS: usize = 1_000_000;

/// The pairs that no robot brings.
struct MissedPairs {
    missed: u64,
    all: u64,
    /// One of them.
    first: (Block, Block),
}

/// Blocks that the same robots reach: how many there are, and the first of them.
type Groups = BTreeMap<Robots, (u64, Block)>;

/// Robots, as bits.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Robots {
    /// Those that can go there and back.
    reaching: Vec<u64>,
    /// Those to whose chargers a way leads.
    connected: Vec<u64>,
}

/// Counts the missed pairs of two spots; `None` if there is none, or if it takes too long to tell.
fn missed_pairs(map: &Map, ranges: &[Range], spots: [Spot; 2], ways: &mut Ways<'_>) -> Option<MissedPairs> {
    let [from, to] = spots.map(|spot| blocks(map, spot));
    let (from, to) = (from?, to?);
    let looks = (from.len() + to.len()).checked_mul(ranges.len())?;
    if looks > LOOKS {
        return None;
    }
    let (from, to) = (groups(&from, ranges, ways)?, groups(&to, ranges, ways)?);
    let (mut missed, mut all, mut first) = (0, 0, None);
    for (of_from, (many_from, from)) in &from {
        for (of_to, (many_to, to)) in &to {
            let pairs = many_from.saturating_mul(*many_to);
            all += pairs;
            // What no way connects, another rule reports.
            let meet = |one: &[u64], other: &[u64]| one.iter().zip(other).any(|(one, other)| one & other != 0);
            if meet(&of_from.connected, &of_to.connected) && !meet(&of_from.reaching, &of_to.reaching) {
                missed += pairs;
                first = first.into_iter().chain([(*from, *to)]).min();
            }
        }
    }
    Some(MissedPairs { missed, all, first: first? })
}

/// The free blocks of a spot; `None` if they are too many.
fn blocks(map: &Map, spot: Spot) -> Option<Vec<Block>> {
    let (corner, last) = spot.corners(Some(map))?;
    let (rows, columns) = rows(corner, last, map);
    let mut blocks = Vec::new();
    for row in rows {
        let free = map.free_ranges(row, columns.clone()).flatten();
        blocks.extend(free.map(|column| Block::new(column.cast_signed(), row.cast_signed())));
        if blocks.len() > LOOKS {
            return None;
        }
    }
    Some(blocks)
}

fn groups(blocks: &[Block], ranges: &[Range], ways: &mut Ways<'_>) -> Option<Groups> {
    let mut groups = Groups::new();
    for block in blocks {
        let mut robots = Robots::default();
        for some in ranges.chunks(u64::BITS as usize) {
            let (mut reaching, mut connected) = (0, 0);
            for (place, range) in some.iter().enumerate() {
                let moves = ways.moves_of(range, *block)?;
                connected |= u64::from(moves.is_some()) << place;
                reaching |= u64::from(moves.is_some_and(|moves| range.reaches(moves))) << place;
            }
            robots.reaching.push(reaching);
            robots.connected.push(connected);
        }
        groups.entry(robots).or_insert((0, *block)).0 += 1;
    }
    Some(groups)
}
