use std::fmt;

use saoms_api::Message;

use crate::grid::Block;

/// Below so many percent a robot that is awaked would soon have to charge again, as the manual's robots do.
const LOW: f64 = 35.0;

/// That a robot is there, or no longer is.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(key = "robot")]
pub struct RobotList {
    /// The robot's number.
    pub robot: u32,
    /// Whether it works; `false` when it ends.
    pub active: bool,
    /// Its battery in percent.
    pub battery: f64,
    /// Whether it is at its charger and in charge.
    pub in_charge: bool,
    /// Whether it takes no jobs until somebody awakes it.
    pub asleep: bool,
    /// Where its charger is: a block that others keep off.
    pub charger: Block,
    /// How often it acts: the time from one execution to the next, in microseconds.
    pub period: u64,
}

impl RobotList {
    /// Whether it is asleep, and charged so far that it can work when it is awaked.
    pub fn can_be_awaked(&self) -> bool {
        self.active && self.asleep && self.battery > LOW
    }

    /// Whether its battery is empty, with no charger there.
    pub fn is_out_of_battery(&self) -> bool {
        self.battery <= 0.0 && !self.in_charge
    }
}

impl fmt::Display for RobotList {
    /// As the console of the manual's figures shows it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Robot{} is active", self.robot)
    }
}
