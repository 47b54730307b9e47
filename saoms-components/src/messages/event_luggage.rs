use std::fmt;

use saoms_api::{Field, Message};

use crate::grid::Block;

/// What an [`EventLuggage`] message says about its luggage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum LuggageStage {
    /// It waits for a robot.
    #[default]
    Request,
    /// The robot would take it, and says from where.
    Interest,
    /// The robot no longer would: another one is closer.
    Release,
    /// The robot goes and brings it; nobody else has to.
    Taken,
    /// The robot brought it to its destination.
    Delivered,
    /// The robot can never bring it.
    Refused,
    /// Nobody can: it is no open work any more.
    GivenUp,
}

/// Luggage to bring from one block to another, or a robot's response.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct EventLuggage {
    /// The number of the robot that responds; 0 for a request.
    pub robot: u32,
    /// The luggage's own number.
    pub luggage: u32,
    /// Request or kind of response.
    pub stage: LuggageStage,
    /// Where to collect it.
    pub from: Block,
    /// Where to deposit it.
    pub to: Block,
    /// Where the robot is that responds; without meaning in a request.
    pub block: Block,
}

impl EventLuggage {
    /// A request.
    pub const fn request(luggage: u32, from: Block, to: Block) -> EventLuggage {
        EventLuggage { robot: 0, luggage, stage: LuggageStage::Request, from, to, block: from }
    }

    /// That nobody can bring the luggage of a request.
    pub const fn given_up(luggage: u32, from: Block, to: Block) -> EventLuggage {
        EventLuggage { stage: LuggageStage::GivenUp, ..EventLuggage::request(luggage, from, to) }
    }
}

impl fmt::Display for EventLuggage {
    /// As the console of the manual's figures shows it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Luggage to bring from {} to {}", self.from, self.to)
    }
}
