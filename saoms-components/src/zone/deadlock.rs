//! Robots that stand in each other's way for good.

use std::fmt;

use super::ledger::{Ledger, Member};
use crate::grid::Block;
use crate::messages::Standing;

/// Number of rounds for which robots have not moved before they count as a deadlock.
///
/// Maneuvers are looked for after 4, 8, 16 and 32 rounds: by then there is none.
const STANDING_STILL: u32 = 40;

/// Robots of which each one waits for the next, and the last one for one of them, or for a robot that cannot make way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Deadlock {
    /// The robots and their blocks, the one with the lowest number first.
    robots: Vec<(u32, Block)>,
}

impl Deadlock {
    /// The deadlock that a robot is in, or waits for; `None` if a robot in its way can still go on, or has to stay for
    /// now.
    fn of(robot: u32, ledger: &Ledger) -> Option<Deadlock> {
        let mut chain: Vec<(u32, Block)> = Vec::new();
        let mut next = robot;
        loop {
            let member = ledger.member(next)?;
            if let Some(start) = chain.iter().position(|(one, _)| *one == next) {
                chain.drain(..start);
                break;
            }
            let is_last = is_at_rest(member) && !member.wants_to_go();
            chain.push((next, member.end()));
            if is_last {
                break;
            }
            if !is_stuck(member) {
                return None;
            }
            next = member.in_the_way?.1;
        }
        let first = chain.iter().enumerate().min_by_key(|(_, (robot, _))| *robot).map_or(0, |(place, _)| place);
        chain.rotate_left(first);
        Some(Deadlock { robots: chain })
    }

    /// The number of the first robot: an alert is about it.
    pub(super) fn first(&self) -> u32 {
        self.robots.first().map_or(0, |(robot, _)| *robot)
    }
}

/// The deadlocks of a zone, each once.
pub(super) fn deadlocks(ledger: &Ledger) -> Vec<Deadlock> {
    let mut found: Vec<Deadlock> = Vec::new();
    let stuck = ledger.members().iter().filter(|(_, member)| is_stuck(member));
    for deadlock in stuck.filter_map(|(robot, _)| Deadlock::of(*robot, ledger)) {
        if found.iter().all(|one| one.first() != deadlock.first()) {
            found.push(deadlock);
        }
    }
    found
}

/// True if the robot holds one block, and would make way.
fn is_at_rest(member: &Member) -> bool {
    member.steps.len() == 1 && member.request.standing == Standing::MakesWay
}

fn is_stuck(member: &Member) -> bool {
    is_at_rest(member) && member.wants_to_go() && member.waited >= STANDING_STILL
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
