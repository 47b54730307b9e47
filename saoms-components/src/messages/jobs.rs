//! Messages of a master that assigns luggage to robots.

use saoms_api::{Message, Topic};

use crate::grid::{Block, Map};
use crate::validation::{MessageValidator, Problem, Validate};

/// Luggage that a master assigns to single robots.
///
/// Published by the master of the environment; read by robots.
pub const ASSIGNMENT: Topic<Assignment> = Topic::event("JOBTOPIC").optional();

/// A job for one robot. The robot answers on ELMSTOPIC: it takes the luggage, refuses it for good, or releases it for
/// the others.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(place = "charger")]
pub struct Assignment {
    /// Number of the robot.
    pub robot: u32,
    /// Number of the luggage.
    pub luggage: u32,
    /// True if the luggage is for another robot now: the robot releases it, unless it has collected it.
    pub withdrawn: bool,
    /// Block where the luggage is collected.
    pub from: Block,
    /// Block where the luggage is deposited.
    pub to: Block,
    /// Block of the robot's charger. On a large map a robot hears the assignments for its charger alone.
    pub charger: Block,
}

impl Validate for Assignment {
    const WHAT: &'static str = "an assignment";

    fn about(&self) -> String {
        format!("luggage {} from {} to {}", self.luggage, self.from, self.to)
    }

    fn validate(&self, _sender: u32, validator: &mut MessageValidator, area: Option<&Map>) -> Result<(), Problem> {
        for block in [self.from, self.to] {
            Problem::of_block(block, area)?;
            if area.is_some_and(|area| !area.is_free(block)) {
                return Err(Problem::Blocked { block });
            }
        }
        validator.check_known(self.robot)
    }
}
