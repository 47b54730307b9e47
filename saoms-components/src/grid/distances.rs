use super::{Block, Map};

/// Cost of a block that cannot be reached.
pub const UNREACHABLE: u32 = u32::MAX;

/// Cost of a move in the direction of its lane.
pub const MOVE: u32 = 4;

/// Cost of a move against the direction of its lane.
const AGAINST: u32 = 5;

/// Cost of a move to a block that robots should avoid.
const COSTLY: u32 = 4 * MOVE - 1;

/// Number of buckets in the ring: costs in use differ at most by the most expensive move.
const RING: usize = COSTLY as usize + 1;

/// Costs of the ways from all blocks of a map to one block, found by Dijkstra's algorithm with Dial's buckets (1969).
///
/// Rows and columns are lanes with alternating directions. A move against its lane costs a little more, so that of
/// equally short ways robots choose the one with less oncoming traffic. Such lanes are the highways of Cohen, Uras and
/// Koenig ("Feasibility Study: Using Highways for Bounded-Suboptimal Multi-Agent Path Finding", 2015).
///
/// The buffers are kept from one search to the next, so that searches do not allocate.
#[derive(Clone, Debug, Default)]
pub struct Distances {
    to: Option<Block>,
    /// Costs row by row, with a border of one block around the map, so that every block has four neighbours. Blocked
    /// blocks have cost 0: no way can improve that, so the search never enters them.
    costs: Vec<u32>,
    /// Distance from one row to the next in `costs`.
    stride: u32,
    frontier: [Vec<Cell>; RING],
}

/// A block and its index in `costs`.
#[derive(Clone, Copy, Debug)]
struct Cell {
    x: u16,
    y: u16,
    at: u32,
}

impl Distances {
    /// Searches the ways to a block. Blocks that are blocked in `costly` are entered only if the way around them is
    /// long.
    pub fn search(&mut self, map: &Map, to: Block, costly: &Map) {
        let start = if map.is_free(to) { Some(to) } else { None };
        self.search_from(map, to, start, costly);
    }

    /// The same for a block that may be blocked: ways end next to it.
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
                    let is_costly = place.at != start.at && !costly.is_free(place.block());
                    self.spread(place, cost, is_costly);
                }
            }
            self.frontier[cost as usize % RING] = places;
            cost += 1;
        }
    }

    /// Sets all costs to unreachable, and those of blocked blocks and the border to 0.
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

    /// Updates the neighbours of a block whose cost is known.
    fn spread(&mut self, place: Cell, cost: u32, is_costly: bool) {
        let Cell { x, y, at } = place;
        // Even rows lead to the right and even columns up in y. The moves come from the neighbours to this block.
        let (right, left) = if y % 2 == 0 { (MOVE, AGAINST) } else { (AGAINST, MOVE) };
        let (up, down) = if x % 2 == 0 { (MOVE, AGAINST) } else { (AGAINST, MOVE) };
        let neighbours = [
            (Cell { x: x.wrapping_sub(1), y, at: at - 1 }, right),
            (Cell { x: x + 1, y, at: at + 1 }, left),
            (Cell { x, y: y.wrapping_sub(1), at: at - self.stride }, up),
            (Cell { x, y: y + 1, at: at + self.stride }, down),
        ];
        for (from, lane) in neighbours {
            let reached = cost + if is_costly { COSTLY } else { lane };
            let known = &mut self.costs[from.at as usize];
            if reached < *known {
                *known = reached;
                self.frontier[reached as usize % RING].push(from);
            }
        }
    }

    fn place(&self, map: &Map, block: Block) -> Option<Cell> {
        if map.is_free(block) { self.at(block) } else { None }
    }

    fn at(&self, block: Block) -> Option<Cell> {
        let (x, y) = (u16::try_from(block.x).ok()?, u16::try_from(block.y).ok()?);
        Some(Cell { x, y, at: (u32::from(y) + 1) * self.stride + u32::from(x) + 1 })
    }

    /// The goal of the last search.
    pub fn to(&self) -> Option<Block> {
        self.to
    }

    /// Forgets the search.
    pub fn clear(&mut self) {
        self.to = None;
    }

    /// Cost of the way from a block of the searched map; [`UNREACHABLE`] if there is none.
    #[inline]
    pub fn of(&self, map: &Map, block: Block) -> u32 {
        self.place(map, block).and_then(|place| self.costs.get(place.at as usize)).copied().unwrap_or(UNREACHABLE)
    }
}

impl Cell {
    fn block(self) -> Block {
        Block::new(i32::from(self.x), i32::from(self.y))
    }
}

#[expect(clippy::cast_possible_wrap, reason = "both are below `Map::LONGEST`")]
fn block(x: u32, y: u32) -> Block {
    Block::new(x as i32, y as i32)
}
