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

/// Costs of the ways from the blocks of a map to one block, found by Dijkstra's algorithm with Dial's buckets (1969).
///
/// A search goes on only as far as the blocks that somebody asks about are away: on a large map most ways are short.
///
/// Rows and columns are lanes with alternating directions. A move against its lane costs a little more, so that of
/// equally short ways robots choose the one with less oncoming traffic. Such lanes are the highways of Cohen, Uras and
/// Koenig ("Feasibility Study: Using Highways for Bounded-Suboptimal Multi-Agent Path Finding", 2015).
///
/// The buffers are kept from one search to the next, so that searches do not allocate.
///
/// ```
/// use saoms_components::grid::{Block, Distances, MOVE, Map};
///
/// let (map, none) = (Map::new(5, 3), Map::new(5, 3));
/// let mut distances = Distances::default();
/// distances.search(&map, Block::new(4, 1));
/// assert!(distances.of(&map, &none, Block::new(0, 1)) >= 4 * MOVE);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Distances {
    to: Option<Block>,
    start: u32,
    /// The search that found it in the upper bits, and the cost in the others; row by row, with a border of one block
    /// around the map, so that every block has four neighbours.
    found: Vec<u32>,
    /// Number of the present search, from 1 on.
    search: u32,
    /// Distance from one row to the next in `found`.
    stride: u32,
    frontier: [Vec<Cell>; RING],
    /// Cost of the bucket that is looked at next: lower costs are final.
    cost: u32,
    /// Number of buckets before it that were empty.
    empty: usize,
}

/// Number of bits of a cost.
const COST_BITS: u32 = 24;

/// Greatest cost of a way: of more than a million blocks, whatever they cost.
const MOST: u32 = (1 << COST_BITS) - 1;

/// Number of searches after which the buffer is cleared.
const SEARCHES: u32 = (1 << (32 - COST_BITS)) - 1;

/// A block and its index in `found`.
#[derive(Clone, Copy, Debug)]
struct Cell {
    x: u16,
    y: u16,
    at: u32,
}

impl Distances {
    /// Begins to search the ways to a block.
    pub fn search(&mut self, map: &Map, to: Block) {
        let start = if map.is_free(to) { Some(to) } else { None };
        self.begin(map, to, start);
    }

    /// The same for a block that may be blocked: ways end next to it.
    pub fn search_beside(&mut self, map: &Map, to: Block) {
        let start = if map.contains(to) { Some(to) } else { None };
        self.begin(map, to, start);
    }

    fn begin(&mut self, map: &Map, to: Block, start: Option<Block>) {
        self.to = Some(to);
        self.stride = map.width() + 2;
        let size = self.stride as usize * (map.height() as usize + 2);
        if self.found.len() != size || self.search >= SEARCHES {
            self.found.clear();
            self.found.resize(size, 0);
            self.search = 0;
        }
        self.search += 1;
        self.frontier.iter_mut().for_each(Vec::clear);
        (self.cost, self.empty) = (0, RING);
        if let Some(start) = start.and_then(|start| self.at(start)) {
            self.start = start.at;
            self.note(start.at, 0);
            self.frontier[0].push(start);
            self.empty = 0;
        }
    }

    /// Cost of a place as it is known so far.
    fn known(&self, at: u32) -> u32 {
        let found = self.found.get(at as usize).copied().unwrap_or(0);
        if found >> COST_BITS == self.search { found & MOST } else { UNREACHABLE }
    }

    fn note(&mut self, at: u32, cost: u32) {
        self.found[at as usize] = self.search << COST_BITS | cost;
    }

    /// Looks at the next bucket.
    fn advance(&mut self, map: &Map, costly: &Map) {
        let bucket = self.cost as usize % RING;
        let mut places = std::mem::take(&mut self.frontier[bucket]);
        self.empty = if places.is_empty() { self.empty + 1 } else { 0 };
        for place in places.drain(..) {
            if self.known(place.at) == self.cost {
                let is_costly = place.at != self.start && !costly.is_free(place.block());
                self.spread(map, place, is_costly);
            }
        }
        self.frontier[bucket] = places;
        self.cost += 1;
    }

    /// Updates the neighbours of a block whose cost is known.
    fn spread(&mut self, map: &Map, place: Cell, is_costly: bool) {
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
            let reached = self.cost + if is_costly { COSTLY } else { lane };
            if reached < self.known(from.at) && reached <= MOST && map.is_free(from.block()) {
                self.note(from.at, reached);
                self.frontier[reached as usize % RING].push(from);
            }
        }
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

    /// Cost of the way from a block; [`UNREACHABLE`] if there is none. Both maps are the same from the beginning of the
    /// search on: the searched one, and one whose blocked blocks are entered only if the way around them is long.
    #[inline]
    pub fn of(&mut self, map: &Map, costly: &Map, block: Block) -> u32 {
        let Some(place) = self.at(block).filter(|_| map.is_free(block)) else { return UNREACHABLE };
        loop {
            let known = self.known(place.at);
            if known <= self.cost || self.empty >= RING {
                return known;
            }
            self.advance(map, costly);
        }
    }
}

impl Cell {
    fn block(self) -> Block {
        Block::new(i32::from(self.x), i32::from(self.y))
    }
}
