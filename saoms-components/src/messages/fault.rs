use std::fmt;

use saoms_api::{Field, Message};

/// What happened to a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum FaultKind {
    /// It can neither move nor handle luggage any more.
    #[default]
    Breakdown,
}

/// Something in a robot broke.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Fault {
    /// The robot's number.
    pub robot: u32,
    /// What happened to it.
    pub kind: FaultKind,
}

impl Fault {
    /// That a robot breaks down.
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
