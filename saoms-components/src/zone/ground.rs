use std::collections::HashMap;

use super::dead_ends::DeadEnds;
use crate::grid::{Block, Distances, MOVE, Map, UNREACHABLE};

/// The map of a zone, with the ways to the goals of its robots.
///
/// It is a cache: all that it answers follows from the map, the obstacles and the chargers.
#[derive(Debug)]
pub(crate) struct Ground {
    map: Map,
    /// The map, with obstacles as blocked blocks.
    passable: Map,
    /// Chargers, as blocked blocks of a map: ways avoid them.
    chargers: Map,
    obstacles: Vec<Block>,
    dead_ends: DeadEnds,
    ways: HashMap<Block, Way>,
    /// Number of the present round, for the age of ways.
    round: u64,
}

#[derive(Debug, Default)]
struct Way {
    distances: Distances,
    used: u64,
}

/// Maximum number of blocks of an open map on which ways are searched; on a larger one a straight line is as good.
const SEARCHED: usize = 16_384;

/// Maximum number of blocks in all ways that are kept: 128 MB.
const KEPT: usize = 32 * 1024 * 1024;

impl Ground {
    pub(crate) fn new(map: Map) -> Ground {
        let chargers = Map::new(map.width(), map.height());
        let (passable, dead_ends) = (map.clone(), DeadEnds::of(&map));
        Ground { passable, map, chargers, obstacles: Vec::new(), dead_ends, ways: HashMap::new(), round: 0 }
    }

    /// The map without obstacles.
    pub(crate) fn map(&self) -> &Map {
        &self.map
    }

    /// The dead ends of the map without obstacles.
    pub(super) fn dead_ends(&self) -> &DeadEnds {
        &self.dead_ends
    }

    /// True if a robot can be on the block.
    pub(crate) fn is_free(&self, block: Block) -> bool {
        self.map.is_free(block)
    }

    /// Notes a charger, where robots stay long: ways avoid it.
    pub(crate) fn add_charger(&mut self, charger: Block) {
        if self.chargers.is_free(charger) {
            self.chargers.set_blocked(charger);
            self.ways.clear();
        }
    }

    /// Begins a round with these obstacles: robots that cannot move. Ways that were not used for long are forgotten.
    pub(crate) fn begin_round(&mut self, obstacles: Vec<Block>) {
        self.round += 1;
        if obstacles != self.obstacles {
            self.passable.clone_from(&self.map);
            obstacles.iter().for_each(|block| _ = self.passable.set_blocked(*block));
            self.obstacles = obstacles;
            self.ways.clear();
        }
        if self.ways.len().saturating_mul(self.passable.size()) > KEPT {
            let round = self.round;
            self.ways.retain(|_, way| way.used + 1 >= round);
        }
    }

    /// Cost of the way from a block to a goal, in parts of [`MOVE`]; [`UNREACHABLE`] if there is none.
    pub(crate) fn cost(&mut self, from: Block, goal: Block) -> u32 {
        if self.passable.is_open() && self.passable.size() > SEARCHED {
            return if self.passable.is_free(from) { from.distance(goal).saturating_mul(MOVE) } else { UNREACHABLE };
        }
        let Ground { passable, chargers, ways, round, .. } = self;
        let way = ways.entry(goal).or_default();
        way.used = *round;
        if way.distances.to() != Some(goal) {
            way.distances.search_beside(passable, goal);
        }
        if from == goal { 0 } else { way.distances.of(passable, chargers, from) }
    }
}
