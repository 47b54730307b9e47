//! Lengths of the ways from robots to luggage.

use std::collections::HashMap;

use crate::grid::{Block, Distances, MOVE, Map, UNREACHABLE};

/// Maximum number of blocks of a map on which ways are searched. On others, and where no block is blocked, the distance
/// counts.
const SEARCHED: usize = 16_384;

/// Ways from some blocks, each searched once.
#[derive(Debug)]
pub(super) struct Ways<'a> {
    map: Option<&'a Map>,
    none: Map,
    searched: HashMap<Block, Distances>,
}

impl<'a> Ways<'a> {
    pub(super) fn on(map: Option<&'a Map>) -> Ways<'a> {
        let map = map.filter(|map| !map.is_open() && map.size() <= SEARCHED);
        let none = map.map_or_else(|| Map::new(1, 1), |map| Map::new(map.width(), map.height()));
        Ways { map, none, searched: HashMap::new() }
    }

    /// Number of moves between two blocks; `None` if no way leads there.
    pub(super) fn between(&mut self, from: Block, to: Block) -> Option<u32> {
        let Some(map) = self.map else { return Some(from.distance(to)) };
        let ways = self.searched.entry(from).or_insert_with(|| {
            let mut ways = Distances::default();
            ways.search(map, from);
            ways
        });
        let cost = ways.of(map, &self.none, to);
        (cost != UNREACHABLE).then(|| cost.div_ceil(MOVE))
    }
}
