use std::fmt;

use saoms_api::{Field, Message};

use crate::grid::Block;

/// The priority of a robot that stays where it is whoever wants its block: it handles luggage, has to charge, or cannot move.
pub const IMMOVABLE: Priority = Priority { rank: u64::MAX, robot: 0 };

/// Who goes first where robots meet. A robot lends its own to those that have to make way for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub struct Priority {
    /// The higher goes first.
    pub rank: u64,
    /// The robot that it comes from; with equal ranks the lower number goes first.
    pub robot: u32,
}

impl Ord for Priority {
    fn cmp(&self, other: &Priority) -> std::cmp::Ordering {
        self.rank.cmp(&other.rank).then(other.robot.cmp(&self.robot))
    }
}

impl PartialOrd for Priority {
    fn partial_cmp(&self, other: &Priority) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Which blocks a robot holds and which it wants.
///
/// It holds the block where it is, and its next block from the announcement until it has left it again. What it wants it does not hold yet:
/// it goes there once nobody holds the block or wants it with more right.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(key = "robot")]
pub struct Position {
    /// The robot's number.
    pub robot: u32,
    /// Where it is.
    pub block: Block,
    /// Where it moves; the same as `block` while it does not.
    pub next: Block,
    /// Where it wants to go after that; the same as `next` when it wants to stay.
    pub wanted: Block,
    /// With which right.
    pub priority: Priority,
}

impl fmt::Display for Position {
    /// As the console of the manual's figures shows it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Position of Robot{} will be: {}", self.robot, self.next)
    }
}
