//! Messages about the positions and ways of robots.

use std::fmt;

use saoms_api::{Field, Message, Topic};

use crate::grid::{Block, Map};
use crate::hardware::Area;
use crate::validation::{MessageValidator, Problem, Sender, Validate, of_robot};

/// Position and next blocks of each robot, the newest message of each.
///
/// Published by robots; read by robots.
pub const POSITION: Topic<Position> = Topic::state("POSTOPIC");

/// Priority of a robot that never makes way: it handles luggage, has to charge, or cannot move.
pub const IMMOVABLE: Priority = Priority { rank: u64::MAX, robot: 0 };

/// Right of way where robots meet. A robot lends its priority to robots that have to make way for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub struct Priority {
    /// The higher rank goes first.
    pub rank: u64,
    /// Number of the robot that the priority comes from; with equal ranks the lower number goes first.
    pub robot: u32,
}

/// Least rank of a way to work or to a charger that is needed in time: the highest byte of a rank is the purpose of the
/// way.
const WORK: u64 = 2 << 56;

/// The same of a way to a charger.
const CHARGER: u64 = 3 << 56;

impl Priority {
    /// The purpose of the way, the more urgent the higher.
    pub(crate) fn purpose(self) -> u64 {
        self.rank >> 56
    }

    /// True if the robot has to reach a charger in time.
    pub(crate) fn is_for_charger(self) -> bool {
        self.rank >= CHARGER
    }

    /// True if the robot is on its way with a job, or to a charger that it has to reach in time; false if it is free.
    pub fn is_for_work(&self) -> bool {
        self.rank >= WORK
    }
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

/// Blocks that a robot holds and wants.
///
/// A robot holds its block, and its next block from the announcement until it has left that block again. It does not
/// hold the block that it wants: it goes there once no other robot holds it or wants it with a higher priority.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(
    key = "robot",
    place = "block",
    speaker(
        "robot",
        instead = "to keep the robot at its block, stop it with `estop`; if it was removed from the floor, send `gone`"
    )
)]
pub struct Position {
    /// Number of the robot.
    pub robot: u32,
    /// Position of the robot.
    pub block: Block,
    /// Block that the robot moves to; the same as `block` if it does not move.
    pub next: Block,
    /// Block that the robot wants to enter after that; the same as `next` if it wants to stay.
    pub wanted: Block,
    /// Priority of the robot.
    pub priority: Priority,
}

impl fmt::Display for Position {
    /// Format of the console in the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Position of Robot{} will be: {}", self.robot, self.next)
    }
}

impl Validate for Position {
    const WHAT: &'static str = "the position";
    const SPOKEN_ON: Option<Topic<Position>> = Some(POSITION);

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    /// The first message about an unknown robot is accepted: a robot sends its position before anything else, and its
    /// block is kept free.
    fn validate(
        &self,
        sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        let Position { block, next, wanted, .. } = *self;
        for block in [block, next, wanted] {
            Problem::of_block(block, area)?;
        }
        for (from, to) in [(block, next), (next, wanted)] {
            if from.distance(to) > 1 {
                return Err(Problem::Jump { from, to });
            }
        }
        validator.check_speaker(self.robot, sender)
    }
}

/// Collisions of robots.
///
/// Published by the world, or robots without one; read by observers of the fleet.
pub const COLLISION: Topic<Collision> = Topic::event("COLLISIONTOPIC").optional();

/// A collision of two robots.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Collision {
    /// Number of the robot that entered the block.
    pub robot: u32,
    /// Number of the robot that held it.
    pub other: u32,
    /// Block of the collision.
    pub block: Block,
    /// True if the two robots exchanged their blocks. It is the same collision that was reported before as a meeting in
    /// one block.
    pub swap: bool,
}

impl fmt::Display for Collision {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Collision { robot, other, block, swap } = self;
        let what = if *swap { "collide: they exchange blocks at" } else { "collide at" };
        write!(formatter, "robots {robot} and {other} {what} {block}")
    }
}

/// The map that the robots share, published when the world starts.
///
/// Published by the world; read by the master of the environment, the environment and observers of the fleet.
pub const AREA: Topic<Area> = Topic::state("AREATOPIC");
