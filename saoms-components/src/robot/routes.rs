use crate::grid::{Block, Distances, Map, UNREACHABLE};

/// The area as a robot knows it, and the ways through it.
///
/// Without a map the area is open and as large as its coordinates, and on a map without blocked blocks every way is as long as it looks; only
/// a map with blocked blocks has to be searched.
#[derive(Debug, Default)]
pub struct Routes {
    map: Option<Map>,
    searched: bool,
    home: Distances,
    goal: Distances,
    other: Distances,
}

impl Routes {
    /// Learns the map, and the ways to the charger.
    pub fn learn(&mut self, map: Map, charge_block: Block) {
        self.searched = !map.is_open();
        if self.searched {
            self.home.search(&map, charge_block, &[]);
        }
        self.map = Some(map);
    }

    /// Whether a robot can stand on the block.
    #[inline]
    pub fn is_free(&self, block: Block) -> bool {
        match &self.map {
            Some(map) => map.is_free(block),
            None => block.x >= 0 && block.y >= 0,
        }
    }

    /// How many moves lead to the charger from a block.
    pub fn to_charger(&self, from: Block, charge_block: Block) -> u32 {
        match &self.map {
            Some(map) if self.searched => self.home.of(map, from),
            _ => self.straight(from, charge_block),
        }
    }

    /// How many moves lead from one block to another, on any errand but the present one.
    pub fn between(&mut self, from: Block, to: Block) -> u32 {
        match &self.map {
            Some(map) if self.searched => {
                if self.other.to() != Some(to) {
                    self.other.search(map, to, &[]);
                }
                self.other.of(map, from)
            }
            _ => self.straight(from, to),
        }
    }

    /// Makes sure that [`to_goal`](Routes::to_goal) leads to this block.
    pub fn head_for(&mut self, goal: Block) {
        if self.searched
            && self.goal.to() != Some(goal)
            && let Some(map) = &self.map
        {
            self.goal.search(map, goal, &[]);
        }
    }

    /// How many moves lead to the goal that was headed for.
    #[inline]
    pub fn to_goal(&self, from: Block, goal: Block) -> u32 {
        match &self.map {
            Some(map) if self.searched => self.goal.of(map, from),
            _ => self.straight(from, goal),
        }
    }

    fn straight(&self, from: Block, to: Block) -> u32 {
        if self.is_free(from) && self.is_free(to) { from.distance(to) } else { UNREACHABLE }
    }
}
