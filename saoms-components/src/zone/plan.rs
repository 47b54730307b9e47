//! Which robot is granted which block next.
//!
//! A round of planning looks at the ends of all passages, where robots come to rest if nothing more is granted to them.
//! In the order of their ranks, each robot is granted the free block that leads it closest to its goal. A robot that
//! holds that block is first moved away, with the rank of the one that waits for it, and so on along a line of robots;
//! if that is not possible, the next best block is tried. This is the priority inheritance with backtracking of PIBT
//! (Okumura, Machida, Défago, Tamura, 2019) without its common time steps, and without moves into a block that is not
//! free yet.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use super::ground::Ground;
use super::ledger::Ledger;
use super::maneuver::Maneuver;
use crate::grid::{Block, MOVE, UNREACHABLE};
use crate::messages::Standing;

/// Maximum number of robots that are moved away for one.
const LINE: u32 = 64;

/// A round of planning.
pub(crate) struct Round<'z> {
    ledger: &'z mut Ledger,
    ground: &'z mut Ground,
    /// Robots for which this round has decided.
    decided: BTreeSet<u32>,
    /// Robots that still have to move in maneuvers.
    busy: BTreeSet<u32>,
    /// Blocks of maneuvers, which others do not enter.
    taken: BTreeSet<Block>,
    /// Robots to which something was granted.
    granted: BTreeSet<u32>,
    /// Number of blocks that are granted ahead of a robot.
    ahead: usize,
}

/// What comes of a wish to have a block.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// It is granted.
    Granted,
    /// Its holder leaves it.
    Waits,
    /// Its holder cannot leave it.
    Refused,
}

/// Number of rounds after which a robot that nobody can make way for is helped by a maneuver. If there is none, it is
/// looked for again after twice as many rounds.
const PATIENCE: u32 = 4;

/// Maximum number of blocks that are granted ahead of a robot.
pub(crate) const MOST_AHEAD: u32 = 16;

/// Maximum number of searches for a maneuver in one round.
const SEARCHES: usize = 2;

/// What a round of planning changed.
#[derive(Debug, Default)]
pub(crate) struct Planned {
    /// Robots to which something was granted.
    pub(crate) granted: BTreeSet<u32>,
    /// Robots that wait for another robot than before, or for none any more.
    pub(crate) waiting: BTreeSet<u32>,
}

/// Plans a round: grants blocks, and notes which robots wait for which.
pub(crate) fn plan(ledger: &mut Ledger, maneuvers: &mut Vec<Maneuver>, ground: &mut Ground, ahead: usize) -> Planned {
    let mut granted = BTreeSet::new();
    maneuvers.retain_mut(|maneuver| maneuver.go_on(ledger, &mut granted));
    let mut order: Vec<(Reverse<u64>, u32)> = ledger
        .members()
        .iter()
        .filter(|(_, member)| member.wants_to_go())
        .map(|(robot, member)| (Reverse(member.request.rank), *robot))
        .collect();
    order.sort_unstable();
    let (busy, taken): (BTreeSet<u32>, BTreeSet<Block>) = maneuvers.iter().flat_map(Maneuver::concerns).unzip();
    let mut round = Round { ledger, ground, decided: busy.clone(), busy, taken, granted, ahead };
    for (_, robot) in &order {
        round.serve(*robot);
    }
    for (_, robot) in &order {
        round.extend(*robot);
    }
    if let Some(maneuver) = round.maneuver(&order) {
        maneuvers.push(maneuver);
    }
    let waiting = order.iter().map(|(_, robot)| *robot).filter(|robot| round.note_wait(*robot)).collect();
    Planned { granted: round.granted, waiting }
}

impl Round<'_> {
    /// Grants a robot its next block, unless it still has one ahead.
    fn serve(&mut self, robot: u32) {
        let Some(member) = self.ledger.member(robot) else { return };
        if self.decided.contains(&robot) || member.steps.len() > 2 {
            return;
        }
        let outcome = self.advance(robot, false, LINE);
        if outcome != Outcome::Granted
            && let Some(member) = self.ledger.member_mut(robot)
        {
            member.waited = member.waited.saturating_add(1);
        }
    }

    /// Looks for a maneuver for the first robot for which nobody can make way.
    fn maneuver(&mut self, order: &[(Reverse<u64>, u32)]) -> Option<Maneuver> {
        let is_stuck = |robot: &u32| {
            let waited = self.ledger.member(*robot).map_or(0, |member| member.waited);
            waited >= PATIENCE && waited.is_power_of_two() && !self.busy.contains(robot)
        };
        let stuck: Vec<u32> = order.iter().map(|(_, robot)| *robot).filter(is_stuck).take(SEARCHES).collect();
        let mut found =
            stuck.into_iter().filter_map(|robot| Maneuver::find(robot, self.ledger, self.ground, &self.taken));
        let mut maneuver = found.next()?;
        maneuver.go_on(self.ledger, &mut self.granted).then_some(maneuver)
    }

    /// Extends the passage of a robot. One that makes way for another moves anywhere; one that goes to its goal moves
    /// closer to it.
    fn advance(&mut self, robot: u32, makes_way: bool, line: u32) -> Outcome {
        self.decided.insert(robot);
        let Some(member) = self.ledger.member(robot) else { return Outcome::Refused };
        if member.request.standing != Standing::MakesWay || line == 0 {
            return Outcome::Refused;
        }
        let (end, goal) = (member.end(), member.request.goal);
        for block in self.candidates(end, goal, makes_way) {
            if !self.ledger.territory().contains(block) {
                if makes_way {
                    continue;
                }
                // The zone over there decides.
                return Outcome::Waits;
            }
            let outcome = match self.ledger.holder(block) {
                None if self.ledger.grant(robot, block) => {
                    self.granted.insert(robot);
                    Outcome::Granted
                }
                Some(holder) if holder != robot => self.ask(holder, block, line),
                _ => Outcome::Refused,
            };
            if outcome != Outcome::Refused {
                return outcome;
            }
        }
        Outcome::Refused
    }

    /// Asks the holder of a block to leave it.
    fn ask(&mut self, holder: u32, block: Block, line: u32) -> Outcome {
        let Some(member) = self.ledger.member(holder) else { return Outcome::Refused };
        if member.end() != block {
            // It is on its way to the end of its passage, which nobody can take from it.
            return Outcome::Waits;
        }
        if self.decided.contains(&holder) {
            return Outcome::Refused;
        }
        match self.advance(holder, true, line - 1) {
            Outcome::Refused => Outcome::Refused,
            Outcome::Granted | Outcome::Waits => Outcome::Waits,
        }
    }

    /// The blocks beside the end of a passage, the best first.
    fn candidates(&mut self, end: Block, goal: Block, makes_way: bool) -> Vec<Block> {
        let here = self.ground.cost(end, goal);
        let mut candidates: Vec<(u32, bool, Block)> = Vec::with_capacity(4);
        for block in end.neighbours() {
            if !self.ground.is_free(block) || self.taken.contains(&block) {
                continue;
            }
            let cost = self.ground.cost(block, goal);
            if !makes_way && (cost >= here || cost == UNREACHABLE) {
                continue;
            }
            let is_held = self.ledger.holder(block).is_some();
            candidates.push((cost.saturating_add(if is_held { MOVE / 2 } else { 0 }), is_held, block));
        }
        candidates.sort_unstable();
        candidates.into_iter().map(|(_, _, block)| block).collect()
    }

    /// Notes for which robot this one waits; `true` if it waited for another one before, or for none.
    fn note_wait(&mut self, robot: u32) -> bool {
        let Some(member) = self.ledger.member(robot) else { return false };
        let (end, goal) = (member.end(), member.request.goal);
        // A robot that can still drive does not wait.
        let waits = member.waited > 0 && member.steps.len() < 2;
        let best = if waits { self.candidates(end, goal, false).into_iter().next() } else { None };
        let in_the_way = best.and_then(|block| Some((block, self.ledger.holder(block)?)));
        let Some(member) = self.ledger.member_mut(robot) else { return false };
        std::mem::replace(&mut member.in_the_way, in_the_way) != in_the_way
    }

    /// Grants a robot further blocks ahead: those that it needs so that it does not wait for grants, and some more
    /// where no other robot is near.
    fn extend(&mut self, robot: u32) {
        while let Some(member) = self.ledger.member(robot)
            && !self.busy.contains(&robot)
            && member.wants_to_go()
            && !member.steps.is_empty()
        {
            let (end, goal) = (member.end(), member.request.goal);
            let is_needed = member.steps.len() <= member.request.ahead.min(MOST_AHEAD) as usize;
            if !is_needed && member.steps.len() > self.ahead {
                return;
            }
            let best = self.candidates(end, goal, false).into_iter().next();
            let Some(block) = best.filter(|block| is_needed || self.is_quiet(*block, robot)) else { return };
            if !self.ledger.grant(robot, block) {
                return;
            }
            self.granted.insert(robot);
        }
    }

    /// True if no other robot holds a block beside this one.
    fn is_quiet(&self, block: Block, robot: u32) -> bool {
        let others = |block: &Block| self.ledger.holder(*block).is_some_and(|holder| holder != robot);
        !block.neighbours().iter().any(others)
    }
}
