//! Right of way between robots.
//!
//! A robot announces the adjacent block that it wants. It enters in an execution in which no other robot holds or wants
//! that block, according to the messages since the announcement. Of two robots that want the same block at least one
//! hears of the other before it enters, so they never both enter, however late messages are. The one with the lower
//! priority then wants another block.
//!
//! Wanting a held block asks its holder to make way. A holder of lower priority does, with the priority of the asking
//! robot, and so on along a line of robots. This is the priority inheritance of PIBT (Okumura, Machida, Défago, Tamura,
//! "Priority Inheritance with Backtracking for Iterative Multi-agent Path Finding", 2019), without its common time
//! steps. A robot without progress tries another way. In dead ends who goes out goes first: see `dead_end`.

use std::cmp::Reverse;

use saoms_api::{Chance, Field};

use crate::grid::{Block, MOVE, UNREACHABLE};
use crate::messages::{IMMOVABLE, Position, Priority};
use crate::precedence::Precedence;
use crate::robot::{Peers, Routes};

use super::dead_end::{Leaving, way_out};

/// Number of executions of waiting after which a robot tries another way.
const PATIENCE: u32 = 8;

/// The same for a robot for which no other makes way.
const SHORT_PATIENCE: u32 = 3;

/// A robot's view of the robots around it, and the block that it wants.
#[derive(Debug, Default)]
pub(crate) struct Traffic {
    near: Vec<Position>,
    /// Where it looked last, at which number of changes of the positions.
    looked: Option<(Block, u64)>,
    wanted: Option<Block>,
    /// The same as the entry of the knowledge shows it.
    shown: Option<Block>,
    /// Block that it left last: not the first choice among equally good blocks.
    previous: Option<Block>,
    waited: u32,
    /// Block that it does not try again while the same robot holds it.
    avoided: Option<(Block, u32)>,
    /// The block that it leaves, or has left, to another robot.
    leaving: Option<Leaving>,
}

/// What outlives a failure of the robot; the robots around it are heard again.
#[derive(Clone, Copy, Debug, Field)]
pub(crate) struct TrafficMemory {
    wanted: Option<Block>,
    shown: Option<Block>,
    previous: Option<Block>,
    waited: u32,
    avoided: Option<Avoided>,
    leaving: Option<Leaving>,
}

#[derive(Clone, Copy, Debug, Field)]
struct Avoided {
    block: Block,
    holder: u32,
}

/// Input of a robot to the choice of its next block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Claim {
    pub(super) robot: u32,
    /// Block from which it continues.
    pub(super) at: Block,
    pub(super) goal: Option<Block>,
    /// True if the robot goes along y first when both directions are equally short.
    pub(super) y_first: bool,
    pub(super) priority: Priority,
    /// Number of executions that other robots may take for one execution of this robot; 0 while it moves and so does
    /// not wait.
    pub(super) tempo: u32,
}

/// Availability of a block, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Availability {
    /// No robot holds it.
    Free,
    /// Its holder is leaving.
    Leaving,
    /// Its holder has to make way.
    Yielding,
}

impl Availability {
    /// Cost of waiting for the block, in parts of a move.
    fn delay(self) -> u32 {
        match self {
            Availability::Free => 0,
            Availability::Leaving => 1,
            Availability::Yielding => MOVE,
        }
    }
}

impl Traffic {
    /// Collects the robots near this block; others do not matter.
    pub(in crate::robot) fn look(&mut self, peers: &Peers, at: Block) {
        if self.looked.replace((at, peers.changes())) == Some((at, peers.changes())) {
            return;
        }
        self.near.clear();
        self.near.extend(peers.all().filter(|peer| peer.block.distance(at) <= 3).cloned());
    }

    /// The robots at most three blocks away.
    pub(super) fn near(&self) -> &[Position] {
        &self.near
    }

    pub(in crate::robot) fn memory(&self) -> TrafficMemory {
        let Traffic { wanted, shown, previous, waited, avoided, leaving, .. } = *self;
        let avoided = avoided.map(|(block, holder)| Avoided { block, holder });
        TrafficMemory { wanted, shown, previous, waited, avoided, leaving }
    }

    pub(in crate::robot) fn restore(&mut self, memory: TrafficMemory) {
        let TrafficMemory { wanted, shown, previous, waited, avoided, leaving } = memory;
        (self.wanted, self.shown, self.previous, self.waited) = (wanted, shown, previous, waited);
        self.leaving = leaving;
        self.avoided = avoided.map(|avoided| (avoided.block, avoided.holder));
    }

    /// The block that the robot announced to want, unless it wants to stay.
    pub(in crate::robot) fn wanted(&self, at: Block) -> Option<Block> {
        self.wanted.filter(|wanted| *wanted != at)
    }

    /// Takes over a wish that a loop wrote into the entry of the knowledge, or shows its own there.
    pub(in crate::robot) fn follow(&mut self, entry: &mut Option<Block>, at: Block) {
        if *entry == self.shown {
            *entry = self.wanted(at);
        } else {
            self.wanted = Some(entry.unwrap_or(at));
        }
        self.shown = *entry;
    }

    /// Wants only the block that it holds.
    pub(super) fn stay(&mut self, at: Block) {
        self.wanted = Some(at);
        self.previous = None;
        self.waited = 0;
    }

    /// Wants a block that a zone granted.
    pub(super) fn follow_grant(&mut self, block: Block) {
        self.wanted = Some(block);
        self.waited = 0;
    }

    /// Another robot that holds or wants the block.
    pub(super) fn in_the_way(&self, block: Block) -> Option<u32> {
        self.near.iter().find(|peer| peer.holds(block) || peer.wanted == block).map(|peer| peer.robot)
    }

    /// Which of two robots goes first, and by which rule: the one that is in the way of a block, or that of this number
    /// and priority, which is at a block and waits. The last number is that of a third robot for which the first one
    /// makes way, if it goes first because of that; else 0.
    pub(super) fn precedence(
        &self,
        (block, other): (Block, u32),
        (robot, at, own): (u32, Block, Priority),
        routes: &Routes,
    ) -> (u32, Precedence, u32) {
        let Some(peer) = self.near.iter().find(|peer| peer.robot == other) else {
            return (other, Precedence::There, 0);
        };
        if peer.block == block {
            let stays = peer.priority == IMMOVABLE;
            return (other, if stays { Precedence::Stays } else { Precedence::There }, 0);
        }
        if peer.next == block {
            return (other, Precedence::Moves, 0);
        }
        // Both want it: `availability` decides.
        let comes_out = |from: Block| way_out(from, routes) == Some(block);
        let [own, theirs] = [(comes_out(at), own, robot), (comes_out(peer.next), peer.priority, other)];
        let right = |(comes_out, priority, robot)| right_of_way(comes_out, priority, robot);
        let (first, second) = if right(theirs) > right(own) { (theirs, own) } else { (own, theirs) };
        if first.0 != second.0 {
            return (first.2, Precedence::ComesOut, 0);
        }
        let rule = Precedence::of_priorities(first.1, second.1);
        let is_lent = rule != Precedence::Number && first.1.robot != first.2;
        (first.2, rule, if is_lent { first.1.robot } else { 0 })
    }

    /// The robot on the block that is wanted, or else on the one that leads to a goal, or else the closest one.
    pub(super) fn blocker(&self, at: Block, goal: Block, routes: &Routes) -> Option<u32> {
        let wanted = self.wanted(at).and_then(|block| self.in_the_way(block));
        let ahead = || self.in_the_way(first_toward(at, Some(goal), routes)?);
        let closest =
            || self.near.iter().min_by_key(|peer| (peer.block.distance(at), peer.robot)).map(|peer| peer.robot);
        wanted.or_else(ahead).or_else(closest)
    }

    /// Records that the robot enters the block that it wanted.
    pub(in crate::robot) fn went(&mut self, from: Block) {
        self.previous = Some(from);
        self.waited = 0;
    }

    /// The robot's own priority, or the priority of the robot for which it has to make way.
    pub(super) fn inherited(&self, own: Priority, at: Block) -> Priority {
        self.asker(at).map_or(own, |asker| asker.priority.max(own))
    }

    /// Chooses the block that the robot wants from now on.
    pub(super) fn choose(&mut self, claim: &Claim, own: Priority, routes: &Routes, chance: &mut Chance) -> Block {
        let Claim { at, goal, .. } = *claim;
        self.leaving = self.leaving.and_then(|leaving| self.still_leaving(leaving));
        let out = if self.is_alone(at) { None } else { way_out(at, routes) };
        let coming_out = self.coming_out(at, routes);
        let leaves = self.leaving.is_some() && out.is_some();
        let makes_way = claim.priority > own || coming_out.is_some() || leaves;
        let on_the_way = goal.is_some_and(|goal| goal != at);
        if !makes_way && !on_the_way {
            self.stay(at);
            return at;
        }
        self.waited += u32::from(claim.tempo > 0);
        self.avoided = self.avoided.filter(|(block, robot)| self.holder(*block) == Some(*robot));
        let patience = if self.wanted(at).is_some() { PATIENCE } else { SHORT_PATIENCE };
        let impatient =
            claim.tempo > 0 && (self.waited > patience.saturating_mul(claim.tempo) || self.is_stuck_for(claim));
        if impatient {
            self.give_up(claim, routes, chance);
        }
        let here = goal.map_or(0, |goal| routes.to_goal(at, goal));
        let ahead = self.ahead_of_asker(at);
        let own_way = first_toward(at, goal, routes);
        let best = at
            .neighbours()
            .into_iter()
            .filter(|block| routes.is_free(*block) && self.avoided.is_none_or(|(avoided, _)| avoided != *block))
            .filter(|block| coming_out != Some(*block) && self.leaving.is_none_or(|leaving| leaving.block != *block))
            .filter_map(|block| {
                let standing = self.availability(block, claim, out, routes)?;
                let cost = goal.map_or(0, |goal| routes.to_goal(block, goal));
                let goes_back = Some(block) == self.previous;
                let aside = impatient && standing == Availability::Free;
                if !makes_way
                    && (cost == UNREACHABLE || (cost >= here && !aside) || (goes_back && self.avoided.is_some()))
                {
                    return None;
                }
                // One that comes out of a dead end passes its other branches: in one this robot can wait.
                let passes = coming_out.is_some() && out != own_way;
                let keeps_out = self.leaving.is_some() || (makes_way && !passes && (goal.is_none() || cost >= here));
                if keeps_out && way_out(block, routes) == Some(at) {
                    // The other robot would follow, and neither could leave.
                    return None;
                }
                let rank = if makes_way {
                    // The asking robot probably wants the block straight ahead next.
                    let ahead = if ahead == Some(block) { 2 * MOVE } else { 0 };
                    // Other robots may have to reach their chargers in time.
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
        if claim.priority > own
            && !on_the_way
            && out == Some(wanted)
            && let Some(asker) = self.asker(at)
        {
            self.leaving = Some(Leaving::new(at, asker.robot, claim.tempo));
        }
        // It wanted to go in itself, and is not to be back before the one that comes out is through.
        if wanted != at
            && on_the_way
            && coming_out.is_some()
            && coming_out == own_way
            && let Some(other) = self.near.iter().find(|peer| peer.wanted == at && Some(peer.block) == coming_out)
        {
            self.leaving = Some(Leaving::new(at, other.robot, claim.tempo));
        }
        wanted
    }

    /// True if no other robot is within two blocks.
    fn is_alone(&self, at: Block) -> bool {
        self.near.iter().all(|peer| peer.block.distance(at) > 2 && peer.next.distance(at) > 2)
    }

    /// The block beside this one from which a robot comes out of a dead end.
    fn coming_out(&self, at: Block, routes: &Routes) -> Option<Block> {
        let comes = |peer: &&Position| peer.wanted == at && peer.block == peer.next && peer.priority != IMMOVABLE;
        let comes = self.near.iter().filter(comes).map(|peer| peer.block);
        comes.filter(|block| *block != at).find(|block| way_out(*block, routes) == Some(at))
    }

    /// The block that the robot leaves to another one, until that is there or has gone elsewhere.
    fn still_leaving(&self, leaving: Leaving) -> Option<Leaving> {
        let asker = self.near.iter().find(|peer| peer.robot == leaving.asker)?;
        let left = leaving.left.checked_sub(1)?;
        (asker.block != leaving.block).then_some(Leaving { left, ..leaving })
    }

    /// The robot with the highest priority that asks for this block.
    fn asker(&self, at: Block) -> Option<&Position> {
        self.near.iter().filter(|peer| peer.wanted == at && !peer.holds(at)).max_by_key(|peer| peer.priority)
    }

    /// After waiting in vain, avoids the same block while the same robot holds it, unless there was no other way.
    fn give_up(&mut self, claim: &Claim, routes: &Routes, chance: &mut Chance) {
        // Random, so that two robots in each other's way do not always give up at the same time.
        self.waited = u32::try_from(chance.below(u64::from(SHORT_PATIENCE))).unwrap_or(0);
        if self.wanted(claim.at).is_none() && self.avoided.take().is_some() {
            // The holder makes way only if it is asked again.
            return;
        }
        let blocked = self.wanted(claim.at).or_else(|| first_toward(claim.at, claim.goal, routes));
        self.avoided = blocked.and_then(|block| Some((block, self.holder(block)?)));
        self.wanted = None;
    }

    /// True if the robot that should make way has heard of it, as its priority shows, and cannot.
    fn is_stuck_for(&self, claim: &Claim) -> bool {
        self.wanted(claim.at).is_some_and(|wanted| {
            let stays = |peer: &&Position| peer.block == wanted && peer.next == wanted && peer.wanted == wanted;
            self.near.iter().find(stays).is_some_and(|peer| peer.priority == claim.priority)
        })
    }

    /// The block on the other side of the robot with the highest priority that asks for this one.
    fn ahead_of_asker(&self, at: Block) -> Option<Block> {
        let asker = self.asker(at)?.next;
        Some(Block::new(2 * at.x - asker.x, 2 * at.y - asker.y))
    }

    /// A robot that holds a block.
    fn holder(&self, block: Block) -> Option<u32> {
        self.near.iter().find(|peer| peer.holds(block)).map(|peer| peer.robot)
    }

    /// Availability of a block; `None` if the robot cannot have it. `out` is the way out of the dead end that it is in.
    fn availability(&self, block: Block, claim: &Claim, out: Option<Block>, routes: &Routes) -> Option<Availability> {
        let mine = right_of_way(out == Some(block), claim.priority, claim.robot);
        let mut standing = Availability::Free;
        for peer in &self.near {
            if peer.holds(block) {
                let comes_here = peer.wanted == claim.at || peer.next == claim.at;
                let leaves = peer.next != block || (peer.wanted != block && !comes_here);
                standing = if leaves && peer.priority != IMMOVABLE {
                    Availability::Leaving
                } else if peer.priority < claim.priority
                    || (out == Some(block) && comes_here && peer.priority != IMMOVABLE)
                {
                    Availability::Yielding
                } else {
                    return None;
                };
            } else if peer.wanted == block {
                let goes_out = way_out(peer.next, routes) == Some(block);
                if right_of_way(goes_out, peer.priority, peer.robot) > mine {
                    return None;
                }
            }
        }
        Some(standing)
    }
}

/// Of two robots that want a block, the one with the higher right goes first.
fn right_of_way(comes_out: bool, priority: Priority, robot: u32) -> (bool, Priority, Reverse<u32>) {
    (comes_out, priority, Reverse(robot))
}

/// The free neighbour of a block that is the closest to a goal.
fn first_toward(at: Block, goal: Option<Block>, routes: &Routes) -> Option<Block> {
    let toward = |block: &Block| goal.map_or(0, |goal| routes.to_goal(*block, goal));
    at.neighbours().into_iter().filter(|block| routes.is_free(*block)).min_by_key(toward)
}

impl Position {
    /// True if the robot holds a block.
    pub(super) fn holds(&self, block: Block) -> bool {
        self.block == block || self.next == block
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Map;

    #[test]
    fn who_goes_first_has_the_rule_that_decided_it() {
        let mut routes = Routes::default();
        // A dead end of two blocks at the top; all blocks below are free.
        routes.learn(Map::read("@.@\n@.@\n...\n...\n...").unwrap(), Block::new(2, 4));
        let [at, block, other] = [(1, 1), (1, 2), (0, 2)].map(|(x, y)| Block::new(x, y));
        let priority = |purpose: u64, age: u64, robot: u32| Priority { rank: purpose << 56 | age, robot };
        let job = priority(2, 5, 4);
        let wants = |priority: Priority| Position { robot: 7, block: other, next: other, wanted: block, priority };
        let is_there = |priority: Priority| Position { robot: 7, block, next: block, wanted: block, priority };
        let moves = Position { next: block, ..wants(job) };
        let coming_out = Position { block: at, next: at, ..wants(priority(0, 0, 7)) };
        for (peer, from, own, expected) in [
            (is_there(job), at, job, (7, Precedence::There, 0)),
            (is_there(IMMOVABLE), at, job, (7, Precedence::Stays, 0)),
            (moves, at, job, (7, Precedence::Moves, 0)),
            (wants(priority(3, 9, 7)), at, job, (4, Precedence::ComesOut, 0)),
            (coming_out, other, job, (7, Precedence::ComesOut, 0)),
            (wants(priority(3, 9, 7)), other, job, (7, Precedence::Charger, 0)),
            (wants(priority(3, 9, 8)), other, job, (7, Precedence::Charger, 8)),
            (wants(priority(1, 9, 7)), other, job, (4, Precedence::Job, 0)),
            (wants(priority(2, 4, 7)), other, job, (4, Precedence::Older, 0)),
            (wants(priority(2, 5, 7)), other, job, (4, Precedence::Number, 0)),
        ] {
            let traffic = Traffic { near: vec![peer.clone()], ..Traffic::default() };
            assert_eq!(traffic.precedence((block, 7), (4, from, own), &routes), expected, "{peer:?} from {from}");
        }
    }
}
