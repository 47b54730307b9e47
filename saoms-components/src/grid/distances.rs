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
    /// The costs row by row, with a border of one block around, so that every block has four neighbours. Blocked blocks cost 0 here, and so
    /// are never reached for less.
    costs: Vec<u32>,
    /// From one row to the next in `costs`.
    stride: u32,
    frontier: [Vec<Place>; RING],
}

/// A block, and where its cost stands.
#[derive(Clone, Copy, Debug)]
struct Place {
    x: u16,
    y: u16,
    at: u32,
}

impl Distances {
    /// Searches the ways to a block. What `costly` marks as blocked is entered only where the way around is long.
    pub fn search(&mut self, map: &Map, to: Block, costly: &Map) {
        let start = if map.is_free(to) { Some(to) } else { None };
        self.search_from(map, to, start, costly);
    }

    /// The same for a block that may be blocked: the ways end beside it.
    pub fn search_beside(&mut self, map: &Map, to: Block, costly: &Map) {
        let start = if map.contains(to) { Some(to) } else { None };
        self.search_from(map, to, start, costly);
    }

    fn search_from(&mut self, map: &Map, to: Block, start: Option<Block>, costly: &Map) {
        self.to = Some(to);
        self.prepare(map);
        let Some(start) = start.and_then(|start| self.at(start)) else { return };
        self.costs[start.at as usize] = 0;
        self.frontier[0].push(start);
        let (mut cost, mut empty) = (0, 0);
        while empty < RING {
            let mut places = std::mem::take(&mut self.frontier[cost as usize % RING]);
            empty = if places.is_empty() { empty + 1 } else { 0 };
            for place in places.drain(..) {
                if self.costs[place.at as usize] == cost {
                    let dear = place.at != start.at && !costly.is_free(place.block());
                    self.spread(place, cost, dear);
                }
            }
            self.frontier[cost as usize % RING] = places;
            cost += 1;
        }
    }

    /// Costs that any way is better than, and none for blocked blocks and the border.
    fn prepare(&mut self, map: &Map) {
        self.stride = map.width() + 2;
        let size = self.stride as usize * (map.height() as usize + 2);
        self.costs.clear();
        self.costs.resize(size, 0);
        for (row, y) in self.costs.chunks_exact_mut(self.stride as usize).skip(1).zip(0..map.height()) {
            for (cost, x) in row[1..].iter_mut().zip(0..map.width()) {
                *cost = if map.is_free(block(x, y)) { UNREACHABLE } else { 0 };
            }
        }
    }

    /// Reaches the blocks beside a place from which it costs so much.
    fn spread(&mut self, place: Place, cost: u32, dear: bool) {
        let Place { x, y, at } = place;
        // Even rows lead to the right and even columns up in y; the moves here come to the place from its neighbours.
        let (right, left) = if y % 2 == 0 { (MOVE, AGAINST) } else { (AGAINST, MOVE) };
        let (up, down) = if x % 2 == 0 { (MOVE, AGAINST) } else { (AGAINST, MOVE) };
        let neighbours = [
            (Place { x: x.wrapping_sub(1), y, at: at - 1 }, right),
            (Place { x: x + 1, y, at: at + 1 }, left),
            (Place { x, y: y.wrapping_sub(1), at: at - self.stride }, up),
            (Place { x, y: y + 1, at: at + self.stride }, down),
        ];
        for (from, lane) in neighbours {
            let reached = cost + if dear { COSTLY } else { lane };
            let known = &mut self.costs[from.at as usize];
            if reached < *known {
                *known = reached;
                self.frontier[reached as usize % RING].push(from);
            }
        }
    }

    fn place(&self, map: &Map, block: Block) -> Option<Place> {
        if map.is_free(block) { self.at(block) } else { None }
    }

    fn at(&self, block: Block) -> Option<Place> {
        let (x, y) = (u16::try_from(block.x).ok()?, u16::try_from(block.y).ok()?);
        Some(Place { x, y, at: (u32::from(y) + 1) * self.stride + u32::from(x) + 1 })
    }

    /// The block that the present costs lead to.
    pub fn to(&self) -> Option<Block> {
        self.to
    }

    /// Forgets the search.
    pub fn clear(&mut self) {
        self.to = None;
    }

    /// The cost from a block of the map that was searched, [`UNREACHABLE`] where no way leads.
    #[inline]
    pub fn of(&self, map: &Map, block: Block) -> u32 {
        self.place(map, block)
            .and_then(|place| self.costs.get(place.at as usize))
            .copied()
            .unwrap_or(UNREACHABLE)
    }
}

impl Place {
    fn block(self) -> Block {
        Block::new(i32::from(self.x), i32::from(self.y))
    }
}

#[expect(clippy::cast_possible_wrap, reason = "both are below `Map::LONGEST`")]
fn block(x: u32, y: u32) -> Block {
    Block::new(x as i32, y as i32)
}
