use super::{Block, Map};

/// The cost of a block that cannot be reached.
pub const UNREACHABLE: u32 = u32::MAX;

/// What a move costs in the direction of its lane.
pub const MOVE: u32 = 4;

/// What a move costs against the direction of its lane.
const AGAINST: u32 = 5;

/// What a move to a block that is better left alone costs.
const COSTLY: u32 = 4 * MOVE - 1;

/// A ring of lists that holds all costs from the present one to the dearest move more.
const RING: usize = COSTLY as usize + 1;

/// What it costs to go from each block of a map to one block, by Dijkstra's search with Dial's buckets (1969).
///
/// Rows and columns are lanes, one to one side, the next to the other: moving against them costs a little more, so that of ways that are as
/// short robots choose those where fewer come towards them. Such lanes are the highways of Cohen, Uras and Koenig ("Feasibility Study: Using
/// Highways for Bounded-Suboptimal Multi-Agent Path Finding", 2015).
///
/// It keeps its memory from one search to the next, so that a robot that goes from goal to goal does not allocate.
#[derive(Clone, Debug, Default)]
pub struct Distances {
    to: Option<Block>,
    costs: Vec<u32>,
    frontier: [Vec<Block>; RING],
}

impl Distances {
    /// Searches the ways to a block. What `costly` marks as blocked is entered only where the way around is long.
    pub fn search(&mut self, map: &Map, to: Block, costly: &Map) {
        self.to = Some(to);
        self.costs.clear();
        self.costs.resize(map.size(), UNREACHABLE);
        self.reach(map, to, 0);
        let (mut cost, mut empty) = (0, 0);
        while empty < RING {
            let place = cost as usize % RING;
            let mut blocks = std::mem::take(&mut self.frontier[place]);
            empty = if blocks.is_empty() { empty + 1 } else { 0 };
            for block in blocks.drain(..) {
                if self.of(map, block) == cost {
                    let dear = block != to && !costly.is_free(block);
                    for from in block.neighbours() {
                        let more = if dear { COSTLY } else { lane(from, block) };
                        self.reach(map, from, cost + more);
                    }
                }
            }
            self.frontier[place] = blocks;
            cost += 1;
        }
    }

    fn reach(&mut self, map: &Map, block: Block, cost: u32) {
        if let Some(place) = map.place(block).filter(|_| map.is_free(block))
            && cost < self.costs[place]
        {
            self.costs[place] = cost;
            self.frontier[cost as usize % RING].push(block);
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

    /// The cost from a block, [`UNREACHABLE`] where no way leads.
    #[inline]
    pub fn of(&self, map: &Map, block: Block) -> u32 {
        map.place(block).and_then(|place| self.costs.get(place)).copied().unwrap_or(UNREACHABLE)
    }
}

/// What a move between two blocks beside each other costs by its lane.
const fn lane(from: Block, to: Block) -> u32 {
    let (ahead, lane) = if from.y == to.y { (to.x > from.x, from.y) } else { (to.y > from.y, from.x) };
    if ahead == (lane % 2 == 0) { MOVE } else { AGAINST }
}
