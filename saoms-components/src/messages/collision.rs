use std::fmt;

use saoms_api::Message;

use crate::grid::Block;

/// Two robots were in each other's way.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Collision {
    /// The number of the robot that entered the block.
    pub robot: u32,
    /// The number of the robot that held it.
    pub other: u32,
    /// Where they met.
    pub block: Block,
    /// Whether it turned out that the two exchanged their blocks. They were told of as meeting there before: this is the same collision.
    pub swap: bool,
}

impl fmt::Display for Collision {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Collision { robot, other, block, swap } = self;
        let what = if *swap { "collide: they exchange blocks at" } else { "collide at" };
        write!(formatter, "robots {robot} and {other} {what} {block}")
    }
}
