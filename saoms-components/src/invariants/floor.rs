//! Invariants 1 and 2 where no world tells of collisions: robots say which blocks they hold.

use std::collections::BTreeMap;

use super::{Finder, NO_SWAP, ONE_IN_A_BLOCK};
use crate::grid::Block;

/// The blocks that robots hold, as they say.
#[derive(Debug, Default)]
pub(super) struct Floor {
    /// The block of each robot, and the one that it enters.
    held: BTreeMap<u32, [Block; 2]>,
    holders: BTreeMap<Block, Vec<u32>>,
    meetings: Vec<Meeting>,
}

/// A robot that entered a block of another one.
#[derive(Debug)]
struct Meeting {
    entered: u32,
    from: Block,
    other: u32,
    block: Block,
    /// True if the other one then entered the block that this one came from.
    is_exchange: bool,
}

impl Floor {
    /// A robot says which blocks it holds: its own one, and the one that it enters.
    pub(super) fn hear(&mut self, robot: u32, block: Block, next: Block, finder: &mut Finder<'_>) {
        if self.held.get(&robot) == Some(&[block, next]) {
            return;
        }
        let exchanges =
            |one: &Meeting| !one.is_exchange && one.other == robot && one.block == block && one.from == next;
        if let Some(meeting) = self.meetings.iter_mut().find(|one| exchanges(one)) {
            meeting.is_exchange = true;
            let entered = meeting.entered;
            finder.note(NO_SWAP, format!("robots {entered} and {robot} exchange {next} and {block}, as they say"));
        }
        self.release(robot);
        self.held.insert(robot, [block, next]);
        self.meetings.retain(|one| {
            let is_its = one.entered == robot || one.other == robot;
            !is_its || one.block == block || one.block == next
        });
        for held in [block, next] {
            let holders = self.holders.entry(held).or_default();
            for other in holders.iter().copied().filter(|other| *other != robot) {
                let knows =
                    |one: &Meeting| [(one.entered, one.other), (one.other, one.entered)].contains(&(robot, other));
                if !self.meetings.iter().any(knows) {
                    finder.note(ONE_IN_A_BLOCK, format!("robots {robot} and {other} are in {held}, as they say"));
                    self.meetings.push(Meeting { entered: robot, from: block, other, block: held, is_exchange: false });
                }
            }
            if !holders.contains(&robot) {
                holders.push(robot);
            }
        }
    }

    /// A robot is not on the floor any more.
    pub(super) fn leave(&mut self, robot: u32) {
        self.release(robot);
        self.held.remove(&robot);
        self.meetings.retain(|one| one.entered != robot && one.other != robot);
    }

    fn release(&mut self, robot: u32) {
        for block in self.held.get(&robot).into_iter().flatten() {
            if let Some(holders) = self.holders.get_mut(block) {
                holders.retain(|holder| *holder != robot);
                if holders.is_empty() {
                    self.holders.remove(block);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use saoms_api::Time;

    use super::*;

    /// What is found where robots say in turn that they are in a column of a row, and enter another one.
    fn found(words: &[(u32, i32, i32)]) -> Vec<String> {
        let (mut floor, mut found) = (Floor::default(), Vec::new());
        for &(robot, at, next) in words {
            let mut finder = Finder { site: "", at: Time::START, found: &mut found };
            match at {
                -1 => floor.leave(robot),
                _ => floor.hear(robot, Block::new(at, 0), Block::new(next, 0), &mut finder),
            }
        }
        found.iter().map(|one| format!("{}: {}", one.invariant, one.text)).collect()
    }

    #[test]
    fn robots_that_hold_one_block_are_found_once() {
        let followed = [(1, 0, 0), (2, 1, 1), (2, 1, 2), (2, 2, 2), (1, 0, 1), (1, 1, 1)];
        assert_eq!(found(&followed), [""; 0], "it has left that block");
        let shared = ["1 no two robots in a block: robots 1 and 2 are in (1,0), as they say"];
        assert_eq!(found(&[(2, 1, 1), (1, 0, 1), (1, 1, 1), (2, 1, 1), (1, 1, 1)]), shared);
        assert_eq!(found(&[(2, 1, 1), (2, 1, 2), (1, 0, 1)]), shared, "it has not left that block");
        assert_eq!(found(&[(2, 1, 1), (2, -1, 0), (1, 0, 1)]), [""; 0], "it is gone");
    }

    #[test]
    fn robots_that_exchange_their_blocks_are_found() {
        let shared = "1 no two robots in a block: robots 1 and 2 are in (1,0), as they say";
        let exchanged = "2 no two robots exchange their blocks: robots 1 and 2 exchange (0,0) and (1,0), as they say";
        assert_eq!(found(&[(1, 0, 0), (2, 1, 1), (1, 0, 1), (2, 1, 0)]), [shared, exchanged]);
        assert_eq!(found(&[(1, 0, 0), (2, 1, 1), (1, 0, 1), (1, 1, 1), (2, 1, 0)]), [shared, exchanged]);
    }
}
