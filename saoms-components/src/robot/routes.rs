use crate::grid::{Block, Distances, MOVE, Map, UNREACHABLE};

/// The area as a robot knows it, and the ways through it.
///
/// Ways keep off the chargers of other robots, where somebody may stay for long. Without a map the area is open and as large as its coordinates;
/// so is a very large map without blocked blocks, where a search would take longer than it saves.
#[derive(Debug, Default)]
pub struct Routes {
    area: Option<Area>,
    home: Distances,
    goal: Distances,
    other: Distances,
}

#[derive(Debug)]
struct Area {
    map: Map,
    /// The chargers of other robots, as blocked blocks of a map.
    chargers: Map,
    charge_block: Block,
    searched: bool,
}

/// Up to so many blocks an open map is searched.
const SEARCHED: usize = 16_384;

impl Routes {
    /// Learns the map, and the ways to the charger.
    pub fn learn(&mut self, map: Map, charge_block: Block) {
        let searched = !map.is_open() || map.size() <= SEARCHED;
        let chargers = Map::new(map.width(), map.height());
        self.area = Some(Area { map, chargers, charge_block, searched });
    }

    /// Learns where another robot's charger is.
    pub fn learn_charger(&mut self, charger: Block) {
        if let Some(area) = &mut self.area
            && area.chargers.is_free(charger)
            && charger != area.charge_block
        {
            area.chargers.set_blocked(charger);
            self.forget_searches();
        }
    }

    /// Learns that nobody gets past a block any more.
    pub fn learn_obstacle(&mut self, block: Block) {
        if let Some(area) = &mut self.area
            && area.map.is_free(block)
        {
            area.map.set_blocked(block);
            self.forget_searches();
        }
    }

    fn forget_searches(&mut self) {
        for distances in [&mut self.home, &mut self.goal, &mut self.other] {
            distances.clear();
        }
    }

    /// Whether a robot can stand on the block.
    #[inline]
    pub fn is_free(&self, block: Block) -> bool {
        match &self.area {
            Some(area) => area.map.is_free(block),
            None => block.x >= 0 && block.y >= 0,
        }
    }

    /// How many moves it is to the charger.
    pub fn to_charger(&mut self, from: Block, charge_block: Block) -> u32 {
        self.area.as_ref().map_or_else(
            || straight(from, charge_block),
            |area| area.distance(&mut self.home, from, charge_block),
        )
    }

    /// How many moves it is from one block to another, on any errand but the present one.
    pub fn between(&mut self, from: Block, to: Block) -> u32 {
        self.area.as_ref().map_or_else(|| straight(from, to), |area| area.distance(&mut self.other, from, to))
    }

    /// Makes sure that [`to_goal`](Routes::to_goal) leads to this block.
    pub fn head_for(&mut self, goal: Block) {
        if let Some(area) = &self.area {
            area.distance(&mut self.goal, goal, goal);
        }
    }

    /// What the way to the goal that was headed for costs, in parts of [`MOVE`].
    #[inline]
    pub fn to_goal(&self, from: Block, goal: Block) -> u32 {
        match &self.area {
            Some(area) if area.searched => self.goal.of(&area.map, from),
            Some(area) if !area.map.is_free(from) => UNREACHABLE,
            _ => straight(from, goal).saturating_mul(MOVE),
        }
    }
}

impl Area {
    fn distance(&self, distances: &mut Distances, from: Block, to: Block) -> u32 {
        if !self.searched {
            let free = self.map.is_free(from) && self.map.is_free(to);
            return if free { from.distance(to) } else { UNREACHABLE };
        }
        if distances.to() != Some(to) {
            distances.search(&self.map, to, &self.chargers);
        }
        match distances.of(&self.map, from) {
            UNREACHABLE => UNREACHABLE,
            cost => cost.div_ceil(MOVE),
        }
    }
}

fn straight(from: Block, to: Block) -> u32 {
    let free = from.x >= 0 && from.y >= 0 && to.x >= 0 && to.y >= 0;
    if free { from.distance(to) } else { UNREACHABLE }
}
