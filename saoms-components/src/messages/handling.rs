//! Messages about what becomes of luggage on the floor.

use saoms_api::{Field, Message, Topic};

use crate::grid::Block;

/// What robots do with luggage, as it happens.
///
/// Published by the world; read by observers of the fleet.
pub const HANDLING: Topic<Handling> = Topic::event("HANDLINGTOPIC").optional();

/// What a robot did with a piece of luggage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum HandlingKind {
    /// It took the piece from a block, or from a robot that is out of service there.
    #[default]
    Collected,
    /// It put the piece down at a block that is not the destination.
    PutDown,
    /// It put the piece down at its destination.
    Delivered,
}

/// A piece of luggage that was collected, put down or delivered.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Handling {
    /// Number of the luggage.
    pub luggage: u32,
    /// Number of the robot.
    pub robot: u32,
    /// What it did.
    pub kind: HandlingKind,
    /// The block where it did so.
    pub block: Block,
    /// Number of the robot from which it took the luggage; 0 for none.
    pub other: u32,
}
