use std::fmt;

use saoms_api::{Message, Topic};

use crate::grid::{Block, Map};
use crate::validation::{LONGEST_PERIOD, MessageValidator, Problem, Validate, of_robot};

/// State of each robot, the newest message of each.
pub const ROBOT_LIST: Topic<RobotList> = Topic::state("RLMSTOPIC");

/// Battery level in percent below which a robot is not woken, since it would soon have to charge again; the same as for
/// the manual's robots.
const LOW: f64 = 35.0;

/// State of a robot.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(key = "robot")]
pub struct RobotList {
    /// Number of the robot.
    pub robot: u32,
    /// True if the robot works; `false` when it ends.
    pub active: bool,
    /// Battery level in percent.
    pub battery: f64,
    /// True if the robot is charging.
    pub in_charge: bool,
    /// True if the robot takes no jobs until it is woken.
    pub asleep: bool,
    /// Block of the robot's charger, which other robots avoid.
    pub charger: Block,
    /// Period of the robot in microseconds.
    pub period: u64,
}

impl RobotList {
    /// True if the robot is asleep, and charged enough to work when it is woken.
    pub fn can_be_woken(&self) -> bool {
        self.active && self.asleep && self.battery > LOW
    }

    /// True if the battery is empty and the robot is not at a charger.
    pub fn is_out_of_battery(&self) -> bool {
        self.battery <= 0.0 && !self.in_charge
    }
}

impl fmt::Display for RobotList {
    /// Format of the console in the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Robot{} is active", self.robot)
    }
}

impl Validate for RobotList {
    const WHAT: &'static str = "the state";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(&self, sender: u32, validator: &mut MessageValidator, area: Option<&Map>) -> Result<(), Problem> {
        if !(0.0..=100.0).contains(&self.battery) {
            return Err(Problem::Battery { percent: self.battery });
        }
        if self.period > LONGEST_PERIOD {
            return Err(Problem::Period { micros: self.period });
        }
        Problem::of_block(self.charger, area)?;
        validator.check_speaker(self.robot, sender)?;
        validator.expect_introductions();
        Ok(())
    }
}
