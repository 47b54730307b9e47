//! Who goes where next.
//!
//! A robot says which block beside its own it wants. It enters in an execution in which nobody else holds that block or wants it, as far as
//! was heard since it said so. Of two robots that want one block at least one hears of the other before it enters, so they never both do,
//! however late messages are; the one with the lower priority then wants something else.
//!
//! Wanting a block that is held asks its holder to make way. The holder of lower priority does, with the priority of the asking robot, and so
//! on along a line of robots: the priority inheritance of PIBT (Okumura, Machida, Défago, Tamura, "Priority Inheritance with
//! Backtracking for Iterative Multi-agent Path Finding", 2019), here without common steps. A robot that gets nowhere tries another way.

use std::cmp::Reverse;

use saoms_api::Chance;

use crate::grid::{Block, MOVE, UNREACHABLE};
use crate::messages::{IMMOVABLE, Position, Priority};
use crate::robot::{Peers, Routes};

/// A robot that waited for so many executions for others to make way tries another way.
const PATIENCE: u32 = 8;

/// The same for a robot that nobody makes way for.
const SHORT_PATIENCE: u32 = 3;

/// A robot's view of the robots around it, and what it wants.
#[derive(Debug, Default)]
pub(crate) struct Traffic {
    near: Vec<Position>,
    wanted: Option<Block>,
    /// The block that it left last: not the first choice when another one is as good.
    previous: Option<Block>,
    waited: u32,
    /// The block that it does not try again while the same robot holds it.
    avoided: Option<(Block, u32)>,
}

/// What a robot brings to the choice of its next block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Claim {
    pub(super) robot: u32,
    /// The block from which it goes on.
    pub(super) at: Block,
    pub(super) goal: Option<Block>,
    /// Whether to go along y first where both ways are as short.
    pub(super) y_first: bool,
    pub(super) priority: Priority,
    /// How many executions others may take for what this robot does in one; 0 while it moves and so waits for nobody.
    pub(super) tempo: u32,
}

/// How a block stands, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Standing {
    /// Nobody holds it.
    Free,
    /// Its holder goes on.
    Leaving,
    /// Its holder has to make way.
    Yielding,
}

impl Standing {
    /// What waiting for the block is worth, in parts of a move.
    fn delay(self) -> u32 {
        match self {
            Standing::Free => 0,
            Standing::Leaving => 1,
            Standing::Yielding => MOVE,
        }
    }
}

impl Traffic {
    /// Looks around: only robots close to this block matter.
    pub(super) fn look(&mut self, peers: &Peers, at: Block) {
        self.near.clear();
        self.near.extend(peers.all().filter(|peer| peer.block.distance(at) <= 3).cloned());
    }

    /// What the robot said that it wants, if that is not to stay.
    pub(super) fn wanted(&self, at: Block) -> Option<Block> {
        self.wanted.filter(|wanted| *wanted != at)
    }

    /// Wants nothing but the block that it holds.
    pub(super) fn stay(&mut self, at: Block) {
        self.wanted = Some(at);
        self.previous = None;
        self.waited = 0;
    }

    /// Another robot that holds the block, or wants it.
    pub(super) fn in_the_way(&self, block: Block) -> Option<u32> {
        self.near.iter().find(|peer| peer.holds(block) || peer.wanted == block).map(|peer| peer.robot)
    }

    /// For how many executions the robot wanted to go on and could not.
    pub(super) fn waited(&self) -> u32 {
        self.waited
    }

    /// Takes in that the robot goes to what it wanted.
    pub(super) fn went(&mut self, from: Block) {
        self.previous = Some(from);
        self.waited = 0;
    }

    /// The robot's own priority, or that of the robot for which it has to make way.
    pub(super) fn inherited(&self, own: Priority, at: Block) -> Priority {
        let asking = self.near.iter().filter(|peer| peer.wanted == at && !peer.holds(at));
        asking.map(|peer| peer.priority).max().map_or(own, |asked| asked.max(own))
    }

    /// Decides which block to want from now on.
    pub(super) fn choose(
        &mut self,
        claim: &Claim,
        own: Priority,
        routes: &Routes,
        chance: &mut Chance,
    ) -> Block {
        let Claim { at, goal, .. } = *claim;
        let makes_way = claim.priority > own;
        let on_the_way = goal.is_some_and(|goal| goal != at);
        if !makes_way && !on_the_way {
            self.stay(at);
            return at;
        }
        self.waited += u32::from(claim.tempo > 0);
        self.avoided = self.avoided.filter(|(block, robot)| self.holder(*block) == Some(*robot));
        let patience = if self.wanted(at).is_some() { PATIENCE } else { SHORT_PATIENCE };
        let impatient = claim.tempo > 0
            && (self.waited > patience.saturating_mul(claim.tempo) || self.is_stuck_for(claim));
        if impatient {
            self.give_up(claim, routes, chance);
        }
        let here = goal.map_or(0, |goal| routes.to_goal(at, goal));
        let ahead = self.ahead_of_asker(at);
        let best = at
            .neighbours()
            .into_iter()
            .filter(|block| {
                routes.is_free(*block) && self.avoided.is_none_or(|(avoided, _)| avoided != *block)
            })
            .filter_map(|block| {
                let standing = self.standing(block, claim)?;
                let cost = goal.map_or(0, |goal| routes.to_goal(block, goal));
                let goes_back = Some(block) == self.previous;
                let aside = impatient && standing == Standing::Free;
                if !makes_way
                    && (cost == UNREACHABLE
                        || (cost >= here && !aside)
                        || (goes_back && self.avoided.is_some()))
                {
                    return None;
                }
                let rank = if makes_way {
                    // Straight ahead is where the asking robot is likely to want to go next.
                    let ahead = if ahead == Some(block) { 2 * MOVE } else { 0 };
                    // Others may have to reach theirs in time.
                    let charger = if routes.is_charger(block) { 2 * MOVE } else { 0 };
                    (standing as u32, cost.saturating_add(ahead).saturating_add(charger))
                } else {
                    (cost.saturating_add(standing.delay()), 0)
                };
                let settled = Some(block) != self.wanted;
                let turned = (block.x == at.x) != claim.y_first;
                Some(((rank, settled, goes_back, turned), block))
            })
            .min_by_key(|(score, _)| *score);
        let wanted = best.map_or(at, |(_, block)| block);
        self.wanted = Some(wanted);
        wanted
    }

    /// After waiting in vain: not the same block again while the same robot holds it, unless there was no other way.
    fn give_up(&mut self, claim: &Claim, routes: &Routes, chance: &mut Chance) {
        // Two robots in each other's way must not give up at the same time for ever.
        self.waited = u32::try_from(chance.below(u64::from(SHORT_PATIENCE))).unwrap_or(0);
        if self.wanted(claim.at).is_none() && self.avoided.take().is_some() {
            // Its holder only makes way for who asks again.
            return;
        }
        let toward = |block: &Block| claim.goal.map_or(0, |goal| routes.to_goal(*block, goal));
        let first =
            || claim.at.neighbours().into_iter().filter(|block| routes.is_free(*block)).min_by_key(toward);
        let blocked = self.wanted(claim.at).or_else(first);
        self.avoided = blocked.and_then(|block| Some((block, self.holder(block)?)));
        self.wanted = None;
    }

    /// Whether the robot that should make way heard of it, as its priority shows, and cannot.
    fn is_stuck_for(&self, claim: &Claim) -> bool {
        self.wanted(claim.at).is_some_and(|wanted| {
            let stays =
                |peer: &&Position| peer.block == wanted && peer.next == wanted && peer.wanted == wanted;
            self.near.iter().find(stays).is_some_and(|peer| peer.priority == claim.priority)
        })
    }

    /// The block on the other side of the robot that asks for this one with the most right.
    fn ahead_of_asker(&self, at: Block) -> Option<Block> {
        let asking = self.near.iter().filter(|peer| peer.wanted == at && !peer.holds(at));
        let asker = asking.max_by_key(|peer| peer.priority)?.next;
        Some(Block::new(2 * at.x - asker.x, 2 * at.y - asker.y))
    }

    /// A robot that holds a block.
    fn holder(&self, block: Block) -> Option<u32> {
        self.near.iter().find(|peer| peer.holds(block)).map(|peer| peer.robot)
    }

    /// How a block stands; `None` where the robot cannot have it.
    fn standing(&self, block: Block, claim: &Claim) -> Option<Standing> {
        let right = |priority: Priority, robot: u32| (priority, Reverse(robot));
        let mine = right(claim.priority, claim.robot);
        let mut standing = Standing::Free;
        for peer in &self.near {
            if peer.holds(block) {
                let comes_here = peer.wanted == claim.at || peer.next == claim.at;
                let leaves = peer.next != block || (peer.wanted != block && !comes_here);
                standing = if leaves && peer.priority != IMMOVABLE {
                    Standing::Leaving
                } else if peer.priority < claim.priority {
                    Standing::Yielding
                } else {
                    return None;
                };
            } else if peer.wanted == block && right(peer.priority, peer.robot) > mine {
                return None;
            }
        }
        Some(standing)
    }
}

impl Position {
    /// Whether the robot holds a block.
    pub(super) fn holds(&self, block: Block) -> bool {
        self.block == block || self.next == block
    }
}
