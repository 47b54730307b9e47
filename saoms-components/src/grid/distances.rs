use std::collections::VecDeque;

use super::{Block, Map};

/// The distance to a block that cannot be reached.
pub const UNREACHABLE: u32 = u32::MAX;

/// How many moves each block of a map is away from one block, by breadth-first search.
///
/// It keeps its memory from one search to the next, so that a robot that goes from goal to goal does not allocate.
#[derive(Clone, Debug, Default)]
pub struct Distances {
    to: Option<Block>,
    moves: Vec<u32>,
    frontier: VecDeque<Block>,
}

impl Distances {
    /// Searches from `to`, around the map's blocked blocks and those of `avoid`.
    pub fn search(&mut self, map: &Map, to: Block, avoid: &[Block]) {
        self.to = Some(to);
        self.moves.clear();
        self.moves.resize(map.size(), UNREACHABLE);
        self.frontier.clear();
        let Some(start) = map.place(to) else { return };
        if !map.is_free(to) {
            return;
        }
        self.moves[start] = 0;
        self.frontier.push_back(to);
        while let Some(block) = self.frontier.pop_front() {
            let moves = self.of(map, block);
            for neighbour in block.neighbours() {
                if !map.is_free(neighbour) || avoid.contains(&neighbour) {
                    continue;
                }
                if let Some(place) = map.place(neighbour)
                    && self.moves[place] == UNREACHABLE
                {
                    self.moves[place] = moves + 1;
                    self.frontier.push_back(neighbour);
                }
            }
        }
    }

    /// The block that the present distances lead to.
    pub fn to(&self) -> Option<Block> {
        self.to
    }

    /// Forgets the search.
    pub fn clear(&mut self) {
        self.to = None;
    }

    /// The distance of a block, [`UNREACHABLE`] where no way leads.
    #[inline]
    pub fn of(&self, map: &Map, block: Block) -> u32 {
        map.place(block).and_then(|place| self.moves.get(place)).copied().unwrap_or(UNREACHABLE)
    }
}
