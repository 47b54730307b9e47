//! Moves that let robots past each other where no single one can make way: in dead ends and narrow passages.
//!
//! Where the robots around one that cannot get on are all at rest, a search over their places finds the moves after
//! which that robot is as close to its goal as it gets nearby. It is a weighted A* over single moves into free blocks,
//! so that the moves can be granted one after the other, as every other grant.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap, HashMap, VecDeque};

use super::ground::Ground;
use super::ledger::{Ledger, Member};
use crate::grid::{Block, UNREACHABLE};
use crate::messages::Standing;

/// Moves that are granted in this order, and to nobody else meanwhile.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Maneuver {
    moves: VecDeque<Move>,
    /// The robots that move in it.
    robots: BTreeSet<u32>,
    /// The robot that gets on, and its rank.
    robot: u32,
    rank: u64,
    /// True if a robot has moved, or may.
    has_begun: bool,
    /// Number of rounds for which a move into another zone has been waiting.
    waited: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Move {
    robot: u32,
    from: Block,
    to: Block,
}

/// Numbers of blocks around a robot among which moves are looked for: the fewer, the fewer states there are.
const REGIONS: [usize; 3] = [14, 28, 64];

/// Maximum number of robots that move.
const CROWD: usize = 7;

/// Maximum number of states that a search looks at.
const STATES: usize = 8_000;

/// Number of rounds after which a move that another zone has to grant is given up.
const OVER_EDGE: u32 = 30;

/// Weight of the way that is left against the number of moves so far: moves are found sooner, with a few more of them.
const WEIGHT: u32 = 2;

/// Places of the robots of a search, as indices of the region; the first is that of the robot that has to get on.
type Places = [u8; CROWD];

impl Maneuver {
    /// The robots that take part, and the blocks that they are going to enter.
    pub(crate) fn concerns(&self) -> impl Iterator<Item = (u32, Block)> {
        self.moves.iter().map(|one| (one.robot, one.to))
    }

    /// The robots that take part, also those that have made all of their moves.
    pub(crate) fn robots(&self) -> impl Iterator<Item = u32> {
        self.robots.iter().copied()
    }

    /// The robot that gets on.
    pub(crate) fn robot(&self) -> u32 {
        self.robot
    }

    /// True if a robot has moved, or may.
    pub(crate) fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Grants the moves that are due, and adds the robots to the list. A robot that has to move into another zone is
    /// told to ask for that. False when it is over, or cannot go on: a robot is not where it should be, or does not
    /// make way any more, another zone does not grant its block for long, or another robot is on that block.
    pub(crate) fn go_on(&mut self, ledger: &mut Ledger, granted: &mut BTreeSet<u32>) -> bool {
        let rank = self.rank;
        // The zones where they are do not send them elsewhere meanwhile.
        for robot in &self.robots {
            let is_outside = |member: &Member| !ledger.territory().contains(member.end());
            if ledger.member(*robot).is_some_and(is_outside)
                && let Some(member) = ledger.member_mut(*robot)
            {
                member.aside = Some((member.end(), rank));
            }
        }
        while let Some(&Move { robot, from, to }) = self.moves.front() {
            let is_inside = ledger.territory().contains(to);
            let Some(member) = ledger.member_mut(robot) else { return false };
            if !is_inside && member.end() == to {
                self.waited = 0;
                self.has_begun = true;
                self.moves.pop_front();
                continue;
            }
            if member.end() != from || member.request.standing != Standing::MakesWay {
                return false;
            }
            if !is_inside {
                member.aside = Some((to, rank));
                self.waited += 1;
                // One that takes no part came in between.
                let is_taken = |(other, member): (&u32, &Member)| {
                    !self.robots.contains(other) && [member.request.block, member.end()].contains(&to)
                };
                return self.waited < OVER_EDGE && !ledger.members().iter().any(is_taken);
            }
            if !ledger.grant(robot, to) {
                // Its holder is one of the robots that have to leave first, unless another one came in between.
                let holder = ledger.holder(to).and_then(|holder| ledger.member(holder));
                return holder.is_some_and(|holder| holder.end() != to && !holder.is_obstacle());
            }
            granted.insert(robot);
            self.has_begun = true;
            self.moves.pop_front();
        }
        false
    }

    /// Looks for moves that bring a robot closer to its goal; `None` if there are none nearby, or robots around it are
    /// still moving.
    pub(crate) fn find(
        robot: u32,
        (ledger, outside): (&Ledger, &BTreeMap<Block, u32>),
        ground: &mut Ground,
        taken: &BTreeSet<Block>,
    ) -> Option<Maneuver> {
        // The fewer robots move, the sooner the moves are found: the others are in the way first.
        let tried = (2..=CROWD).flat_map(|crowd| REGIONS.map(|blocks| (crowd, blocks)));
        let mut found =
            tried.filter_map(|size| Region::around(robot, size, (ledger, outside), ground, taken)?.search());
        let rank = ledger.member(robot)?.request.rank;
        let moves = found.next()?;
        let robots: BTreeSet<u32> = moves.iter().map(|one| one.robot).collect();
        // Where nobody has to make way, the robot can drive by itself.
        let others_move = robots.iter().any(|other| *other != robot);
        others_move.then(|| Maneuver { moves: moves.into(), robots, robot, rank, has_begun: false, waited: 0 })
    }
}

/// The blocks around a robot, and the robots on them.
struct Region {
    blocks: Vec<Block>,
    /// For each block, the indices of those beside it.
    beside: Vec<Vec<u8>>,
    robots: Vec<u32>,
    start: Places,
    /// For each block, the number of moves to the block where the first robot has to go.
    left: Vec<u32>,
}

impl Region {
    /// The region of a robot, with as many robots and blocks: those closest to it.
    fn around(
        robot: u32,
        (crowd, size): (usize, usize),
        (ledger, outside): (&Ledger, &BTreeMap<Block, u32>),
        ground: &mut Ground,
        taken: &BTreeSet<Block>,
    ) -> Option<Region> {
        let first = ledger.member(robot)?;
        let (start, goal) = (first.end(), first.request.goal);
        let mut blocks = vec![start];
        let mut known: BTreeMap<Block, u8> = BTreeMap::from([(start, 0)]);
        let mut robots = vec![robot];
        let mut places: Places = [u8::MAX; CROWD];
        places[0] = 0;
        let mut next = 0;
        while next < blocks.len() && blocks.len() < size {
            for block in blocks[next].neighbours() {
                if known.contains_key(&block)
                    || blocks.len() >= size
                    || !ground.is_free(block)
                    || !(ledger.territory().contains(block) || ledger.is_near(block))
                    || taken.contains(&block)
                {
                    continue;
                }
                let place = u8::try_from(blocks.len()).ok()?;
                if let Some(holder) = ledger.holder(block).or_else(|| outside.get(&block).copied()) {
                    let member = ledger.member(holder)?;
                    if member.is_obstacle() {
                        continue;
                    }
                    if !member.is_at_rest() {
                        return None;
                    }
                    if member.request.standing != Standing::MakesWay || robots.len() == crowd {
                        continue;
                    }
                    places[robots.len()] = place;
                    robots.push(holder);
                }
                known.insert(block, place);
                blocks.push(block);
            }
            next += 1;
        }
        let place_of = |block: &Block| known.get(block).copied();
        let beside: Vec<Vec<u8>> =
            blocks.iter().map(|block| block.neighbours().iter().filter_map(place_of).collect()).collect();
        let costs: Vec<u32> = blocks.iter().map(|block| ground.cost(*block, goal)).collect();
        let (target, least) = costs.iter().enumerate().min_by_key(|(_, cost)| **cost)?;
        if *least >= costs[0] || *least == UNREACHABLE {
            return None;
        }
        let left = distances(&beside, target);
        Some(Region { blocks, beside, robots, start: places, left })
    }

    /// The moves after which the first robot is at its target.
    fn search(&self) -> Option<Vec<Move>> {
        let robots = self.robots.len();
        let mut states = vec![(self.start, 0_u32, usize::MAX)];
        let mut known: HashMap<Places, usize> = HashMap::from([(self.start, 0)]);
        let mut open = BinaryHeap::from([Reverse((self.rank(&self.start, 0), 0_usize))]);
        while let Some(Reverse((_, number))) = open.pop() {
            let (places, moves, _) = states[number];
            if self.left[usize::from(places[0])] == 0 {
                return Some(self.moves(&states, number));
            }
            if states.len() > STATES {
                return None;
            }
            for robot in 0..robots {
                for &to in &self.beside[usize::from(places[robot])] {
                    if places[..robots].contains(&to) {
                        continue;
                    }
                    let mut next = places;
                    next[robot] = to;
                    let count = states.len();
                    if *known.entry(next).or_insert(count) != count {
                        continue;
                    }
                    states.push((next, moves + 1, number));
                    open.push(Reverse((self.rank(&next, moves + 1), count)));
                }
            }
        }
        None
    }

    fn rank(&self, places: &Places, moves: u32) -> u32 {
        self.left[usize::from(places[0])].saturating_mul(WEIGHT).saturating_add(moves)
    }

    /// The moves that led to a state.
    fn moves(&self, states: &[(Places, u32, usize)], last: usize) -> Vec<Move> {
        let mut moves = Vec::new();
        let mut number = last;
        while let (places, _, before) = states[number]
            && before != usize::MAX
        {
            let earlier = states[before].0;
            let moved = (0..self.robots.len()).find(|robot| places[*robot] != earlier[*robot]);
            moves.extend(moved.map(|robot| Move {
                robot: self.robots[robot],
                from: self.blocks[usize::from(earlier[robot])],
                to: self.blocks[usize::from(places[robot])],
            }));
            number = before;
        }
        moves.reverse();
        moves
    }
}

/// Number of moves from each block of a region to one of them.
fn distances(beside: &[Vec<u8>], target: usize) -> Vec<u32> {
    let mut left = vec![u32::MAX; beside.len()];
    left[target] = 0;
    let mut queue = VecDeque::from([target]);
    while let Some(place) = queue.pop_front() {
        for &next in &beside[place] {
            let next = usize::from(next);
            if left[next] == u32::MAX {
                left[next] = left[place] + 1;
                queue.push_back(next);
            }
        }
    }
    left
}
