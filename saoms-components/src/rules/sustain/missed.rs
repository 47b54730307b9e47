//! Blocks that are farther away than any full battery lasts.

use std::cmp::Reverse;

use super::Range;
use super::reach::SEARCHED;
use crate::environment::Spot;
use crate::grid::{Block, Map};
use crate::rules::budget::Budget;
use crate::rules::map::{WorldMap, rows};

/// Free blocks of the map that no robot can go to and come back from.
pub(super) struct Missed {
    /// The other blocks are blocked.
    missed: Map,
    /// The blocks to which no way leads, which another rule reports; `None` on an open map.
    unconnected: Option<Map>,
}

impl Missed {
    /// The missed blocks; `None` if the map is too large to tell.
    pub(super) fn on(map: &Map, ranges: &[Range]) -> Option<Missed> {
        let reach = ranges.iter().map(|range| (range.most(), range.charger)).collect();
        let missed = left_over(map, reach)?;
        let endless = || ranges.iter().map(|range| (u32::MAX, range.charger)).collect();
        let unconnected = if map.is_open() { None } else { Some(left_over(map, endless())?) };
        Some(Missed { missed, unconnected })
    }

    /// The missed blocks and all free blocks of a spot, and the first missed one; `None` if none is missed.
    pub(super) fn count(&self, area: &WorldMap, spot: Spot, budget: &mut Budget) -> Option<(u32, u32, Block)> {
        let (corner, last) = spot.corners(Some(&area.map))?;
        let (rows, columns) = rows(corner, last, &area.map);
        let (mut cut, mut all, mut first) = (0, 0, None);
        for row in rows {
            if !budget.admit(1 + columns.len() / 16) {
                return None;
            }
            all += area.map.free_ranges(row, columns.clone()).map(|range| range.len()).sum::<usize>();
            for range in self.missed.free_ranges(row, columns.clone()) {
                for column in range {
                    let block = Block::new(column.cast_signed(), row.cast_signed());
                    if self.unconnected.as_ref().is_none_or(|map| !map.is_free(block)) {
                        cut += 1;
                        first.get_or_insert(block);
                    }
                }
            }
        }
        Some((cut, u32::try_from(all).ok()?, first?))
    }
}

/// The map with the blocks blocked that are within a number of moves from one of the sources, each with its number.
fn left_over(map: &Map, mut sources: Vec<(u32, Block)>) -> Option<Map> {
    sources.sort_unstable_by_key(|(moves, _)| Reverse(*moves));
    let mut sources = sources.into_iter().peekable();
    let (mut left_over, mut searched) = (map.clone(), 0);
    let (mut open, mut next) = (Vec::new(), Vec::new());
    // Moves that are left at the open blocks: the most first, so that each block is reached with as many as possible.
    let mut moves = 0;
    loop {
        if open.is_empty() {
            let Some((most, _)) = sources.peek() else { return Some(left_over) };
            moves = *most;
        }
        while let Some((_, start)) = sources.next_if(|(most, _)| *most == moves) {
            if left_over.is_free(start) {
                left_over.set_blocked(start);
                open.push(start);
            }
        }
        searched += open.len();
        if searched > SEARCHED {
            return None;
        }
        for block in open.drain(..).filter(|_| moves > 0) {
            for beside in block.neighbours() {
                if left_over.is_free(beside) {
                    left_over.set_blocked(beside);
                    next.push(beside);
                }
            }
        }
        std::mem::swap(&mut open, &mut next);
        moves = moves.saturating_sub(1);
    }
}

#[cfg(test)]
mod tests {
    use saoms_api::Chance;

    use super::super::reach::Ways;
    use super::*;

    #[test]
    fn a_block_is_left_over_where_no_source_has_enough_moves() {
        let mut chance = Chance::new(7);
        for (width, height) in [(1, 1), (9, 1), (5, 4), (12, 9)] {
            for _ in 0..40 {
                let mut map = Map::new(width, height);
                for place in 0..map.size() {
                    if chance.range(0..=99) < 25 {
                        map.set_blocked(map.block(place));
                    }
                }
                let mut source = || (chance.range(0..=6), Block::new(chance.range(0..=11), chance.range(0..=9)));
                let sources = [source(), source(), source()];
                let mut ways = Ways::on(&map, sources.iter().map(|(_, block)| *block));
                let left_over = left_over(&map, sources.to_vec()).unwrap();
                for block in (0..map.size()).map(|place| map.block(place)).filter(|block| map.is_free(*block)) {
                    let reaches = |(most, start): &(u32, Block)| {
                        map.is_free(*start) && ways.moves(*start, block).flatten().is_some_and(|moves| moves <= *most)
                    };
                    assert_eq!(
                        left_over.is_free(block),
                        !sources.iter().any(reaches),
                        "{block} of {map:?}, {sources:?}"
                    );
                }
            }
        }
    }
}
