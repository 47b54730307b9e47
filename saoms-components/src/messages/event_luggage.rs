use std::fmt;

use saoms_api::{Field, Message, Topic};

use crate::grid::{Block, Map};
use crate::validation::{MessageValidator, Problem, Validate};

/// Requests to bring luggage, and the robots' responses.
pub const EVENT_LUGGAGE: Topic<EventLuggage> = Topic::event("ELMSTOPIC");

/// Stages of an [`EventLuggage`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum LuggageStage {
    /// The luggage waits for a robot.
    #[default]
    Request,
    /// The robot is interested and reports its position.
    Interest,
    /// The robot takes its interest back: another robot is closer.
    Release,
    /// The robot brings the luggage; no other robot has to.
    Taken,
    /// The robot has brought the luggage to its destination.
    Delivered,
    /// The robot can never bring the luggage.
    Refused,
    /// No robot can bring the luggage; it is no open work any more.
    GivenUp,
}

/// A request to bring luggage from one block to another, or the response of a robot.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct EventLuggage {
    /// Number of the robot that responds; 0 in a request.
    pub robot: u32,
    /// Number of the luggage.
    pub luggage: u32,
    /// Request, or kind of response.
    pub stage: LuggageStage,
    /// Block where the luggage is collected.
    pub from: Block,
    /// Block where the luggage is deposited.
    pub to: Block,
    /// Position of the robot that responds; without meaning in a request.
    pub block: Block,
}

impl EventLuggage {
    /// A request.
    pub const fn request(luggage: u32, from: Block, to: Block) -> EventLuggage {
        EventLuggage { robot: 0, luggage, stage: LuggageStage::Request, from, to, block: from }
    }

    /// A report that no robot can bring the luggage of a request.
    pub const fn given_up(luggage: u32, from: Block, to: Block) -> EventLuggage {
        EventLuggage { stage: LuggageStage::GivenUp, ..EventLuggage::request(luggage, from, to) }
    }
}

impl fmt::Display for EventLuggage {
    /// Format of the console in the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Luggage to bring from {} to {}", self.from, self.to)
    }
}

impl Validate for EventLuggage {
    const WHAT: &'static str = "a message";

    fn about(&self) -> String {
        format!("luggage {} from {} to {}", self.luggage, self.from, self.to)
    }

    fn validate(&self, sender: u32, validator: &mut MessageValidator, area: Option<&Map>) -> Result<(), Problem> {
        let EventLuggage { robot, from, to, block, .. } = *self;
        match self.stage {
            LuggageStage::Request => Problem::of_request(self, area),
            // The component that requested luggage gives it up in nobody's name, even if the request was impossible.
            LuggageStage::GivenUp if robot == 0 => Ok(()),
            LuggageStage::Interest
            | LuggageStage::Release
            | LuggageStage::Taken
            | LuggageStage::Delivered
            | LuggageStage::Refused
            | LuggageStage::GivenUp => {
                for block in [from, to, block] {
                    Problem::of_block(block, area)?;
                }
                validator.check_known_speaker(robot, sender)
            }
        }
    }
}
