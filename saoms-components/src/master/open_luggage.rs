use std::collections::{BTreeMap, BTreeSet};

use crate::grid::Block;
use crate::messages::{EventLuggage, LuggageStage, RobotList};

/// Open luggage, and the robots that could bring it.
#[derive(Debug, Default)]
pub(super) struct OpenLuggage {
    pieces: BTreeMap<u32, Piece>,
    /// Robots that report that they are active.
    active: BTreeSet<u32>,
    /// Active robots that are broken.
    broken: BTreeSet<u32>,
    /// True once there was a robot.
    seen: bool,
    /// True if something changed since the last check.
    changed: bool,
}

#[derive(Debug)]
struct Piece {
    from: Block,
    to: Block,
    /// Robots that can never bring it.
    refused: BTreeSet<u32>,
}

impl OpenLuggage {
    pub(super) fn add(&mut self, luggage: u32, from: Block, to: Block) {
        self.pieces.insert(luggage, Piece { from, to, refused: BTreeSet::new() });
        self.changed = true;
    }

    /// The lowest number of open luggage, and the number of other pieces.
    pub(super) fn first(&self) -> Option<(u32, usize)> {
        self.pieces.first_key_value().map(|(first, _)| (*first, self.pieces.len() - 1))
    }

    pub(super) fn break_down(&mut self, robot: u32) {
        self.changed |= self.broken.insert(robot);
    }

    pub(super) fn hear_robot(&mut self, robot: &RobotList) {
        self.seen = true;
        self.changed |= if robot.active {
            self.active.insert(robot.robot)
        } else {
            // A robot that reports itself again was repaired.
            self.broken.remove(&robot.robot);
            self.active.remove(&robot.robot)
        };
    }

    pub(super) fn hear_response(&mut self, response: &EventLuggage) {
        match response.stage {
            LuggageStage::Delivered | LuggageStage::GivenUp => _ = self.pieces.remove(&response.luggage),
            LuggageStage::Refused => {
                if let Some(piece) = self.pieces.get_mut(&response.luggage) {
                    self.changed |= piece.refused.insert(response.robot);
                }
            }
            _ => {}
        }
    }

    /// Removes luggage that no robot can bring: every robot refused it, or no robot is left. Returns number, origin and
    /// destination of each piece.
    pub(super) fn take_hopeless(&mut self) -> Vec<(u32, Block, Block)> {
        if !std::mem::take(&mut self.changed) || !self.seen {
            return Vec::new();
        }
        let OpenLuggage { pieces, active, broken, .. } = self;
        let can = |piece: &Piece| active.difference(broken).any(|robot| !piece.refused.contains(robot));
        let hopeless = pieces.extract_if(.., |_, piece| !can(piece));
        hopeless.map(|(luggage, piece)| (luggage, piece.from, piece.to)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot(robot: u32, active: bool) -> RobotList {
        RobotList { robot, active, ..RobotList::default() }
    }

    fn refusal(luggage: u32, robot: u32) -> EventLuggage {
        EventLuggage { luggage, robot, stage: LuggageStage::Refused, ..EventLuggage::default() }
    }

    fn hopeless(open: &mut OpenLuggage) -> Vec<u32> {
        open.take_hopeless().into_iter().map(|(luggage, ..)| luggage).collect()
    }

    #[test]
    fn luggage_is_given_up_once_every_robot_refused_it() {
        let mut open = OpenLuggage::default();
        for luggage in 1..=3 {
            open.add(luggage, Block::new(0, 0), Block::new(1, 0));
        }
        assert_eq!(hopeless(&mut open), [0; 0], "no robot was there yet");
        open.hear_robot(&robot(1, true));
        open.hear_robot(&robot(2, true));
        open.hear_response(&refusal(2, 1));
        assert_eq!(hopeless(&mut open), [0; 0]);
        open.hear_response(&refusal(2, 2));
        assert_eq!(hopeless(&mut open), [2]);
        open.hear_response(&EventLuggage { stage: LuggageStage::Delivered, luggage: 1, ..refusal(1, 1) });
        open.hear_response(&refusal(3, 1));
        open.break_down(2);
        assert_eq!(hopeless(&mut open), [3], "the other one is broken down");
    }

    #[test]
    fn luggage_is_given_up_once_no_robot_is_left() {
        let mut open = OpenLuggage::default();
        open.hear_robot(&robot(1, true));
        open.add(1, Block::new(0, 0), Block::new(1, 0));
        assert_eq!(hopeless(&mut open), [0; 0]);
        open.hear_robot(&robot(1, false));
        assert_eq!(hopeless(&mut open), [1]);
        open.hear_robot(&robot(1, true));
        open.add(2, Block::new(0, 0), Block::new(1, 0));
        assert_eq!(hopeless(&mut open), [0; 0], "it is back");
    }
}
