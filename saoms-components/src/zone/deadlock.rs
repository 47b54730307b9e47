//! Robots that stand in each other's way for good.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use super::ground::Ground;
use super::ledger::{Ledger, Member};
use crate::grid::Block;
use crate::messages::Standing;

/// Number of rounds for which robots have not moved before they count as a deadlock, and of the longest moves that
/// there are: of two robots that wait, one may have to wait until others behind it are out of its way.
///
/// Maneuvers are looked for after 4, 8, 16 and 32 rounds without a move. By then there is none, or what came of it has
/// changed nothing. Rounds in which a robot is in one do not count: it may wait long for its move over an edge.
const STANDING_STILL: u32 = 40;
const MOVES: u32 = 20;

/// The robots of a zone that stand still and want to go on.
#[derive(Debug, Default)]
pub(super) struct StandingStill {
    robots: BTreeMap<u32, Standstill>,
    /// Number of rounds after which they count as a deadlock.
    bound: u32,
}

#[derive(Debug)]
struct Standstill {
    /// Number of its last step that was granted.
    granted: u64,
    /// Number of rounds since then.
    rounds: u32,
    /// True if it is in a deadlock that was found: that lasts, also if moves are heard of later that take longer.
    is_named: bool,
}

impl StandingStill {
    /// Counts a round, in which these robots are in a maneuver. Gives the deadlocks of the zone, each once. Where some
    /// have waited for long, it counts for how many rounds the longest move lasts.
    pub(super) fn count(
        &mut self,
        ledger: &Ledger,
        ground: &mut Ground,
        moving: &BTreeSet<u32>,
        longest_move: impl FnOnce() -> u32,
    ) -> Vec<Deadlock> {
        let stands = |robot: &u32| ledger.member(*robot).filter(|member| is_at_rest(member) && member.wants_to_go());
        self.robots.retain(|robot, still| stands(robot).is_some_and(|member| member.granted == still.granted));
        // One that has to make way waits, too, although the round decides no more of it.
        let waits = |robot: &u32, member: &Member| ledger.territory().contains(member.end()) && !moving.contains(robot);
        let waiting = ledger.members().iter().filter(|(robot, member)| stands(robot).is_some() && waits(robot, member));
        for (robot, member) in waiting {
            let begins = Standstill { granted: member.granted, rounds: 0, is_named: false };
            let still = self.robots.entry(*robot).or_insert(begins);
            still.rounds = still.rounds.saturating_add(1);
        }
        let mut found: Vec<Deadlock> = Vec::new();
        if self.robots.values().all(|still| still.rounds < STANDING_STILL) {
            return found;
        }
        self.bound = STANDING_STILL.max(longest_move().saturating_mul(MOVES));
        let stuck = self.robots.keys().filter(|robot| self.is_stuck(**robot));
        for deadlock in stuck.filter_map(|robot| self.deadlock_of(*robot, ledger, ground, moving)) {
            if found.iter().all(|one| one.first() != deadlock.first()) {
                found.push(deadlock);
            }
        }
        for (robot, _) in found.iter().flat_map(|deadlock| &deadlock.robots) {
            self.robots.entry(*robot).and_modify(|still| still.is_named = true);
        }
        found
    }

    /// True if no robot stands still.
    pub(super) fn is_empty(&self) -> bool {
        self.robots.is_empty()
    }

    fn is_stuck(&self, robot: u32) -> bool {
        self.robots.get(&robot).is_some_and(|still| still.is_named || still.rounds >= self.bound)
    }

    /// The deadlock that a robot is in, or waits for; `None` if a robot in its way can still go on, is in a maneuver,
    /// or has to stay for now, as one that charges: it rests with a rank above those of all that wait for it.
    fn deadlock_of(
        &self,
        robot: u32,
        ledger: &Ledger,
        ground: &mut Ground,
        moving: &BTreeSet<u32>,
    ) -> Option<Deadlock> {
        let mut chain: Vec<(u32, Block)> = Vec::new();
        let mut highest = 0;
        let mut next = robot;
        loop {
            let member = ledger.member(next)?;
            if let Some(start) = chain.iter().position(|(one, _)| *one == next) {
                chain.drain(..start);
                break;
            }
            let rests = is_at_rest(member) && !member.wants_to_go();
            if moving.contains(&next) || rests && member.request.rank > highest {
                return None;
            }
            chain.push((next, member.end()));
            if rests {
                break;
            }
            highest = highest.max(member.request.rank);
            if !self.is_stuck(next) {
                return None;
            }
            next = match member.in_the_way {
                Some((_, other)) => other,
                None => holder_ahead(member, ledger, ground)?,
            };
        }
        let first = chain.iter().enumerate().min_by_key(|(_, (robot, _))| *robot).map_or(0, |(place, _)| place);
        chain.rotate_left(first);
        Some(Deadlock { robots: chain })
    }
}

/// Robots of which each one waits for the next, and the last one for one of them, or for a robot that cannot make way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Deadlock {
    /// The robots and their blocks, the one with the lowest number first.
    robots: Vec<(u32, Block)>,
}

impl Deadlock {
    /// The number of the first robot: an alert is about it.
    pub(super) fn first(&self) -> u32 {
        self.robots.first().map_or(0, |(robot, _)| *robot)
    }
}

/// The robot on the block that leads a robot closest to its goal.
fn holder_ahead(member: &Member, ledger: &Ledger, ground: &mut Ground) -> Option<u32> {
    let (end, goal) = (member.end(), member.request.goal);
    let blocks = end.neighbours().into_iter().filter(|block| ground.is_free(*block)).collect::<Vec<Block>>();
    let best = blocks.into_iter().map(|block| (ground.cost(block, goal), block)).min()?;
    (best.0 < ground.cost(end, goal)).then(|| ledger.holder(best.1)).flatten()
}

/// True if the robot holds one block, and would make way.
fn is_at_rest(member: &Member) -> bool {
    member.steps.len() == 1 && member.request.standing == Standing::MakesWay
}

impl fmt::Display for Deadlock {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let listed: Vec<String> = self.robots.iter().map(|(robot, block)| format!("{robot} at {block}")).collect();
        match listed.as_slice() {
            [only] => write!(formatter, "robot {only} is in the way of others, and cannot make way"),
            all => write!(formatter, "robots {} are in each other's way, and cannot get past", all.join(", ")),
        }
    }
}
