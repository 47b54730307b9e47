//! Where a map falls apart: moves and blocks without which robots cannot get from one part of it to another.

use std::collections::HashSet;
use std::ops::Range;

use crate::grid::{Block, Map};

/// A search through all blocks of a map, depth first (Tarjan, "Depth-First Search and Linear Graph Algorithms", 1972).
pub(super) struct Cuts<'m> {
    map: &'m Map,
    /// What the search found at each block.
    found: Vec<Found>,
}

/// What the search found at a block. Blocks are numbered in the order in which the search reached them.
#[derive(Clone, Copy)]
struct Found {
    order: u32,
    /// Number after the last block that was reached by way of this one.
    end: u32,
    /// Least number of a block beside this one and those that were reached by way of it, apart from the moves between
    /// these.
    low: u32,
    /// Place of the block from which it was reached.
    before: u32,
    /// Place of the block where the search began.
    root: u32,
}

const NONE: u32 = u32::MAX;

/// The parts into which a map falls without a block.
pub(super) struct Parts {
    /// The block.
    without: Block,
    /// Where the search began.
    root: u32,
    /// The numbers of the blocks of each part but one.
    parts: Vec<Range<u32>>,
    /// Number of blocks in none of these.
    rest: u32,
}

impl<'m> Cuts<'m> {
    /// The cuts of the free blocks of a map.
    pub(super) fn of(map: &'m Map, is_free: impl Fn(Block) -> bool) -> Cuts<'m> {
        let unknown = Found { order: NONE, end: 0, low: NONE, before: NONE, root: NONE };
        let mut found = vec![unknown; map.size()];
        let mut count = 0;
        // Places on the way from where the search began, each with the next of its neighbours to look at.
        let mut way: Vec<(usize, usize)> = Vec::new();
        for start in 0..map.size() {
            if found[start].order != NONE || !is_free(map.block(start)) {
                continue;
            }
            let root = start as u32;
            found[start] = Found { order: count, end: 0, low: count, before: NONE, root };
            count += 1;
            way.push((start, 0));
            while let Some((place, next)) = way.last_mut() {
                let (place, before) = (*place, found[*place].before);
                let Some(to) = map.block(place).neighbours().get(*next).copied() else {
                    way.pop();
                    found[place].end = count;
                    if before != NONE {
                        let low = found[place].low;
                        let before = &mut found[before as usize];
                        before.low = before.low.min(low);
                    }
                    continue;
                };
                *next += 1;
                let to = map.place(to).filter(|to| is_free(map.block(*to)) && *to as u32 != before);
                let Some(to) = to else { continue };
                if found[to].order == NONE {
                    found[to] = Found { order: count, end: 0, low: count, before: place as u32, root };
                    count += 1;
                    way.push((to, 0));
                } else {
                    found[place].low = found[place].low.min(found[to].order);
                }
            }
        }
        Cuts { map, found }
    }

    /// The moves without which one of both blocks cannot be reached from the other: where robots cannot get past each
    /// other.
    pub(super) fn bridges(&self) -> HashSet<(Block, Block)> {
        let reached = self.found.iter().enumerate().filter(|(_, found)| found.before != NONE);
        let bridges = reached.filter(|(_, found)| found.low > self.found[found.before as usize].order);
        let ends = bridges.map(|(place, found)| (self.map.block(place), self.map.block(found.before as usize)));
        ends.map(|(one, other)| (one.min(other), one.max(other))).collect()
    }

    /// The parts into which the map falls without a block; `None` if all ways lead around it.
    pub(super) fn without(&self, block: Block) -> Option<Parts> {
        let place = self.map.place(block)?;
        let Found { order, before, root, .. } = self.found[place];
        let behind = block.neighbours().into_iter().filter_map(|beside| {
            let found = self.found[self.map.place(beside)?];
            (found.before == place as u32 && found.low >= order).then_some(found.order..found.end)
        });
        let parts: Vec<Range<u32>> = behind.collect();
        let all = self.found.get(root as usize)?;
        let rest = all.end - all.order - 1 - parts.iter().map(|part| part.end - part.start).sum::<u32>();
        let is_cut = parts.len() > usize::from(before == NONE);
        is_cut.then_some(Parts { without: block, root, parts, rest })
    }

    /// True if a block is cut off from the largest of the parts into which the map falls without another block.
    pub(super) fn is_cut_off(&self, block: Block, parts: &Parts) -> bool {
        let Some(found) = self.map.place(block).map(|place| self.found[place]) else { return false };
        let largest = parts.parts.iter().max_by_key(|part| part.len()).filter(|part| part.len() > parts.rest as usize);
        let own = parts.parts.iter().find(|part| part.contains(&found.order));
        found.root == parts.root && block != parts.without && own != largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cuts(map: &Map) -> Cuts<'_> {
        Cuts::of(map, |block| map.is_free(block))
    }

    #[test]
    fn bridges_are_where_robots_cannot_get_past_each_other() {
        let narrow = |text: &str| {
            let map = Map::read(text).unwrap();
            let bridges = cuts(&map).bridges();
            let mut found: Vec<String> = bridges.into_iter().map(|(one, other)| format!("{one}-{other}")).collect();
            found.sort();
            found.join(" ")
        };
        assert_eq!(narrow("...\n..."), "");
        assert_eq!(narrow("..."), "(0,0)-(1,0) (1,0)-(2,0)");
        assert_eq!(narrow("..@..\n.....\n..@.."), "(1,1)-(2,1) (2,1)-(3,1)");
        assert_eq!(narrow("...\n.@.\n..."), "", "a ring");
    }

    #[test]
    fn without_a_block_of_its_only_way_a_part_is_cut_off() {
        let map = Map::read("...@.\n.....\n...@.\n@@@@.\n@@@@.\n..@@@").unwrap();
        let cuts = cuts(&map);
        let block = Block::new;
        for (x, y) in [(0, 0), (4, 0), (1, 1), (4, 4), (0, 5)] {
            assert!(cuts.without(block(x, y)).is_none(), "({x},{y})");
        }
        let is_cut_off = |without: Block, of: Block| cuts.is_cut_off(of, &cuts.without(without).unwrap());
        // The door of the first room: the room is the larger part.
        assert!(!is_cut_off(block(3, 1), block(0, 0)) && is_cut_off(block(3, 1), block(4, 4)));
        assert!(is_cut_off(block(4, 1), block(4, 0)) && is_cut_off(block(4, 1), block(4, 2)));
        assert!(!is_cut_off(block(3, 1), block(3, 1)), "the block itself");
        assert!(!is_cut_off(block(4, 1), block(2, 2)) && !is_cut_off(block(4, 1), block(0, 5)), "elsewhere");
    }
}
