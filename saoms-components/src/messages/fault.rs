use std::fmt;

use saoms_api::{Field, Message, Topic};

use crate::grid::Map;
use crate::validation::{MessageValidator, Problem, Validate, of_robot};

/// Faults of robots.
pub const FAULT: Topic<Fault> = Topic::event("FAULTTOPIC");

/// Kinds of faults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum FaultKind {
    /// The robot can neither move nor handle luggage any more.
    #[default]
    Breakdown,
}

/// A fault of a robot.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Fault {
    /// Number of the robot.
    pub robot: u32,
    /// Kind of the fault.
    pub kind: FaultKind,
}

impl Fault {
    /// The breakdown of a robot.
    pub const fn breakdown(robot: u32) -> Fault {
        Fault { robot, kind: FaultKind::Breakdown }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            FaultKind::Breakdown => write!(formatter, "robot {} breaks down", self.robot),
        }
    }
}

impl Validate for Fault {
    const WHAT: &'static str = "a fault";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(&self, _sender: u32, validator: &mut MessageValidator, _area: Option<&Map>) -> Result<(), Problem> {
        validator.check_known(self.robot)
    }
}
