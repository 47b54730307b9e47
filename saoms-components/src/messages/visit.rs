//! Messages about blocks that robots visit.

use std::fmt;

use saoms_api::{Message, Topic};

use super::EventLuggage;
use crate::grid::{Block, Map};
use crate::validation::{MessageValidator, Problem, Sender, Validate};

/// Blocks that robots visit. Which robot does it is said on ELMSTOPIC, under the same number.
///
/// Published by the environment, and again by its master; read by the master of the environment and robots.
pub const VISIT: Topic<Visit> = Topic::event("VISITTOPIC").optional();

/// The first number of visits; luggage has lower ones.
pub const FIRST_VISIT: u32 = 1 << 31;

/// True if the number of a job is that of a visit.
pub const fn is_visit(number: u32) -> bool {
    number >= FIRST_VISIT
}

/// A job in words, by its number: `luggage 3`, or `visit 1`.
pub(crate) fn job_name(number: u32) -> String {
    match number.checked_sub(FIRST_VISIT) {
        Some(visit) => format!("visit {visit}"),
        None => format!("luggage {number}"),
    }
}

/// Blocks that a robot visits.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Visit {
    /// Number of the visit.
    pub visit: u32,
    /// Number of the only robot that may do it; 0 for any.
    pub robot: u32,
    /// The blocks, in their order.
    pub stops: Vec<Block>,
}

impl Visit {
    /// The number as people count: from 1 on.
    pub const fn count(&self) -> u32 {
        self.visit.wrapping_sub(FIRST_VISIT)
    }

    /// The first and the last block.
    pub fn ends(&self) -> [Block; 2] {
        [self.stops.first(), self.stops.last()].map(|end| end.copied().unwrap_or_default())
    }

    /// The request for a robot.
    pub fn request(&self) -> EventLuggage {
        let [first, last] = self.ends();
        EventLuggage { robot: self.robot, ..EventLuggage::request(self.visit, first, last) }
    }
}

impl fmt::Display for Visit {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Blocks to visit:")?;
        let separator = |at: usize| if at == 0 { " " } else { ", " };
        self.stops.iter().enumerate().try_for_each(|(at, stop)| write!(formatter, "{}{stop}", separator(at)))?;
        if self.robot == 0 { Ok(()) } else { write!(formatter, " by robot {}", self.robot) }
    }
}

impl Validate for Visit {
    const WHAT: &'static str = "a visit";

    fn about(&self) -> String {
        let [first, last] = self.ends();
        format!("visit {} from {first} to {last}", self.count())
    }

    fn validate(
        &self,
        _sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        if !is_visit(self.visit) || self.stops.is_empty() {
            return Err(Problem::Visit);
        }
        self.stops.iter().try_for_each(|stop| Problem::of_free(*stop, area))?;
        if self.robot == 0 { Ok(()) } else { validator.check_known(self.robot) }
    }
}
