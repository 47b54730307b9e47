use std::cell::RefCell;

use saoms_api::Field;

use crate::grid::{Block, Distances, MOVE, Map, UNREACHABLE};

/// A robot's view of the area, and the ways through it.
///
/// Ways avoid the chargers of other robots, where a robot may stay for long, and lead around robots that do not move
/// any more. A way to the block of such a robot ends beside it. Without a map the area is open and as large as its
/// coordinates; so is a very large map without blocked blocks, where a search would take longer than it saves.
#[derive(Debug, Default)]
pub struct Routes {
    area: Option<Area>,
    /// Robots that do not move any more, and their blocks: several for one that may be on any of them.
    obstacles: Vec<(u32, Block)>,
    /// Robots that have failed and start again soon.
    returning: Vec<u32>,
    /// Cached searches: [`WAYS`] of them, once one was needed. Asking about a block continues a search.
    ways: RefCell<Vec<Way>>,
    /// Counter of lookups, for the age of cached searches.
    clock: u32,
    /// Index in `ways` of the search for the current goal.
    heading: usize,
    /// Number of changes of the map that make other ways possible or necessary.
    changes: u32,
}

/// What a robot that goes on knows of the area beside the map, which its hardware tells again.
#[derive(Clone, Debug, Field)]
pub(super) struct RoutesMemory {
    obstacles: Vec<Obstacle>,
    returning: Vec<u32>,
    changes: u32,
}

/// A robot that does not move any more.
#[derive(Clone, Copy, Debug, Field)]
struct Obstacle {
    robot: u32,
    block: Block,
}

/// Number of cached searches: for the charger, the two ends of the job, and a goal under consideration.
const WAYS: usize = 4;

/// Ways to one block.
#[derive(Debug, Default)]
struct Way {
    distances: Distances,
    /// Value of the clock at the last use.
    asked: u32,
}

#[derive(Debug)]
struct Area {
    /// The map, with obstacles as blocked blocks.
    map: Map,
    /// The map without obstacles, if there are any.
    empty: Option<Map>,
    /// Chargers of other robots, as blocked blocks of a map, where ways are searched.
    chargers: Map,
    /// The same, the newest last, where they are not: such a map can be very large.
    charger_list: Vec<Block>,
    charge_block: Block,
    searched: bool,
}

/// Maximum number of blocks of an open map that is searched.
const SEARCHED: usize = 16_384;

/// Maximum number of chargers that are known of a map that is not searched.
const LISTED: usize = 256;

impl Area {
    fn is_charger(&self, block: Block) -> bool {
        match self.searched {
            true => self.chargers.contains(block) && !self.chargers.is_free(block),
            false => self.charger_list.contains(&block),
        }
    }

    /// Adds a charger; true if other ways become better.
    fn learn_charger(&mut self, charger: Block) -> bool {
        if self.searched {
            return self.chargers.set_blocked(charger);
        }
        if self.charger_list.len() >= LISTED {
            self.charger_list.remove(0);
        }
        self.charger_list.push(charger);
        false
    }
}

impl Routes {
    /// Sets the map and the block of the charger.
    pub fn learn(&mut self, map: Map, charge_block: Block) {
        let searched = !map.is_open() || map.size() <= SEARCHED;
        let chargers = Map::new(map.width(), map.height());
        let mut area = Area { map, empty: None, chargers, charger_list: Vec::new(), charge_block, searched };
        if !self.obstacles.is_empty() {
            area.empty = Some(area.map.clone());
            self.obstacles.iter().for_each(|(_, block)| _ = area.map.set_blocked(*block));
        }
        self.area = Some(area);
    }

    /// Learns the map for a robot that goes on, with the chargers that it knew.
    pub(super) fn learn_again(&mut self, map: Map, charge_block: Block, chargers: &[Block]) {
        let changes = self.changes;
        self.learn(map, charge_block);
        chargers.iter().for_each(|charger| self.learn_charger(*charger));
        // Its loops have seen these changes.
        self.changes = changes;
    }

    /// True if the map is known.
    pub(super) fn knows_area(&self) -> bool {
        self.area.is_some()
    }

    pub(super) fn memory(&self) -> RoutesMemory {
        let obstacles = self.obstacles.iter().map(|&(robot, block)| Obstacle { robot, block });
        RoutesMemory { obstacles: obstacles.collect(), returning: self.returning.clone(), changes: self.changes }
    }

    /// Restores what is known beside the map.
    pub(super) fn restore(&mut self, memory: &RoutesMemory) {
        self.obstacles = memory.obstacles.iter().map(|obstacle| (obstacle.robot, obstacle.block)).collect();
        self.returning.clone_from(&memory.returning);
        self.changes = memory.changes;
    }

    /// Adds the charger of another robot.
    pub fn learn_charger(&mut self, charger: Block) {
        if let Some(area) = &mut self.area
            && charger != area.charge_block
            && !area.is_charger(charger)
            && area.learn_charger(charger)
        {
            self.forget_searches();
        }
    }

    /// Replaces the robot's charger, and the chargers of the others.
    pub fn use_charger(&mut self, charge_block: Block, others: impl Iterator<Item = Block>) {
        if let Some(area) = &mut self.area {
            area.charge_block = charge_block;
            area.chargers = Map::new(area.map.width(), area.map.height());
            area.charger_list.clear();
            for charger in others.filter(|charger| *charger != charge_block) {
                area.learn_charger(charger);
            }
            self.forget_searches();
        }
    }

    /// The robot's charger, if the map is known.
    pub fn charge_block(&self) -> Option<Block> {
        self.area.as_ref().map(|area| area.charge_block)
    }

    /// Adds a robot that does not move any more as an obstacle: it is on one of these blocks, which may be the same.
    pub fn learn_obstacle(&mut self, robot: u32, blocks: [Block; 3]) {
        let mut blocks = blocks.to_vec();
        blocks.dedup();
        if self
            .obstacles
            .iter()
            .filter(|(known, _)| *known == robot)
            .map(|(_, block)| *block)
            .eq(blocks.iter().copied())
        {
            return;
        }
        self.remove_obstacle(robot);
        self.obstacles.extend(blocks.iter().map(|block| (robot, *block)));
        if let Some(area) = &mut self.area {
            area.empty.get_or_insert_with(|| area.map.clone());
            for block in blocks {
                area.map.set_blocked(block);
            }
        }
        self.forget_searches();
    }

    /// Notes whether a robot that has failed starts again: a way that only such robots close is open again then.
    pub fn note_failure(&mut self, robot: u32, returns: bool) {
        let was_returning = self.returning.contains(&robot);
        self.returning.retain(|known| *known != robot);
        if returns {
            self.returning.push(robot);
        } else if was_returning {
            self.changes = self.changes.wrapping_add(1);
        }
    }

    /// Removes an obstacle: the robot moves again.
    pub fn forget_obstacle(&mut self, robot: u32) {
        self.returning.retain(|known| *known != robot);
        self.remove_obstacle(robot);
    }

    fn remove_obstacle(&mut self, robot: u32) {
        let known = self.obstacles.len();
        self.obstacles.retain(|(other, _)| *other != robot);
        if self.obstacles.len() == known {
            return;
        }
        if let Some(area) = &mut self.area
            && let Some(empty) = &area.empty
        {
            area.map.clone_from(empty);
            for (_, block) in &self.obstacles {
                area.map.set_blocked(*block);
            }
        }
        self.forget_searches();
    }

    /// True if a robot that does not move any more is on the block.
    pub fn is_obstacle(&self, block: Block) -> bool {
        self.obstacles.iter().any(|(_, obstacle)| *obstacle == block)
    }

    /// True if the block is the charger of another robot.
    pub fn is_charger(&self, block: Block) -> bool {
        self.area.as_ref().is_some_and(|area| area.is_charger(block))
    }

    /// Number of changes that made other ways possible or necessary.
    pub fn changes(&self) -> u32 {
        self.changes
    }

    fn forget_searches(&mut self) {
        self.changes = self.changes.wrapping_add(1);
        for way in self.ways.get_mut() {
            way.distances.clear();
        }
    }

    /// The map without obstacles, if it is known.
    pub(super) fn map(&self) -> Option<&Map> {
        self.area.as_ref().map(|area| area.empty.as_ref().unwrap_or(&area.map))
    }

    /// True if a robot can be on the block.
    #[inline]
    pub fn is_free(&self, block: Block) -> bool {
        match &self.area {
            Some(area) => area.map.is_free(block),
            None => block.x >= 0 && block.y >= 0 && !self.is_obstacle(block),
        }
    }

    /// Number of moves from one block to another.
    pub fn between(&mut self, from: Block, to: Block) -> u32 {
        let place = self.way_to(to);
        let cost = if from != to && self.is_obstacle(from) {
            // The way starts at a neighbour.
            let beside = from.neighbours().into_iter().filter(|block| self.is_free(*block));
            beside.map(|block| self.cost(place, block, to)).min().unwrap_or(UNREACHABLE)
        } else {
            self.cost(place, from, to)
        };
        if cost == UNREACHABLE { UNREACHABLE } else { cost / MOVE }
    }

    /// True if there is a way from one block to another once the robots have started again that failed and are about
    /// to.
    pub fn may_open(&self, from: Block, to: Block) -> bool {
        let Some(area) = &self.area else { return false };
        let (soon, stay): (Vec<_>, Vec<_>) =
            self.obstacles.iter().partition(|(robot, _)| self.returning.contains(robot));
        let Some(empty) = area.empty.as_ref().filter(|_| !soon.is_empty()) else { return false };
        if !area.searched {
            // Such a map has no blocked blocks: only a robot on the first or the last one can be in the way.
            return true;
        }
        let mut map = empty.clone();
        stay.iter().for_each(|(_, block)| _ = map.set_blocked(*block));
        let mut ways = Distances::default();
        let beside = stay.iter().any(|(_, obstacle)| *obstacle == to);
        let search = if beside { Distances::search_beside } else { Distances::search };
        search(&mut ways, &map, to);
        ways.of(&map, &area.chargers, from) != UNREACHABLE
    }

    /// Prepares [`to_goal`](Routes::to_goal) for this block.
    pub fn head_for(&mut self, goal: Block) {
        self.heading = self.way_to(goal);
    }

    /// Cost of the way to the goal of [`head_for`](Routes::head_for), in parts of [`MOVE`].
    #[inline]
    pub fn to_goal(&self, from: Block, goal: Block) -> u32 {
        self.cost(self.heading, from, goal)
    }

    #[inline]
    fn cost(&self, place: usize, from: Block, to: Block) -> u32 {
        match &self.area {
            Some(area) if area.searched => {
                let mut ways = self.ways.borrow_mut();
                ways.get_mut(place).map_or(UNREACHABLE, |way| way.distances.of(&area.map, &area.chargers, from))
            }
            _ if self.is_free(from) && (self.is_free(to) || self.is_obstacle(to)) => {
                from.distance(to).saturating_mul(MOVE)
            }
            _ => UNREACHABLE,
        }
    }

    /// Index in `ways` of the ways to a block. Unknown ways are searched and replace those that were not used for the
    /// longest time.
    fn way_to(&mut self, to: Block) -> usize {
        let Some(area) = self.area.as_ref().filter(|area| area.searched) else { return 0 };
        self.clock = self.clock.wrapping_add(1);
        let (clock, ways) = (self.clock, self.ways.get_mut());
        ways.resize_with(WAYS, Way::default);
        let known = ways.iter().position(|way| way.distances.to() == Some(to));
        let oldest = || {
            let ages = ways.iter().enumerate().map(|(place, way)| (clock.wrapping_sub(way.asked), place));
            ages.max().map_or(0, |(_, place)| place)
        };
        let place = known.unwrap_or_else(oldest);
        let beside = self.obstacles.iter().any(|(_, obstacle)| *obstacle == to);
        let way = &mut ways[place];
        way.asked = clock;
        if known.is_none() {
            let search = if beside { Distances::search_beside } else { Distances::search };
            search(&mut way.distances, &area.map, to);
        }
        place
    }
}
