use std::fmt;

use saoms_api::{Message, Topic};

use crate::grid::Block;

/// Collisions of robots.
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
