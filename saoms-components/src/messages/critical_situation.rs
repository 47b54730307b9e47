use std::fmt;

use saoms_api::{Field, Message};

use crate::grid::Block;
use crate::robot::Job;

/// What a robot was doing when it became critical.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum CriticalKind {
    /// It carries luggage: the healer collects that where the robot is and delivers it. Kind 1 of the manual.
    #[default]
    CarriesLuggage,
    /// It was on its way to collect luggage: the healer takes the whole job. Kind 2.
    OnTheWay,
    /// It had nothing to do: a substitute is awaked. Kind 3.
    Idle,
}

/// What a [`CriticalSituation`] message says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum CriticalStage {
    /// A robot needs help.
    #[default]
    Request,
    /// The healer would help, and says from where.
    Intention,
    /// The healer no longer would: another one is closer.
    Release,
    /// The healer helps.
    Taken,
    /// The healer was awaked in place of the robot.
    StandsIn,
}

/// A robot that cannot go on asks for a healer, or a healer responds.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct CriticalSituation {
    /// The number of the robot that needs help.
    pub critical: u32,
    /// Where it is.
    pub block: Block,
    /// The number of its luggage; 0 where it has none.
    pub luggage: u32,
    /// Where its luggage was to be collected.
    pub from: Block,
    /// Where its luggage has to go.
    pub to: Block,
    /// What it was doing.
    pub kind: CriticalKind,
    /// Request or kind of response.
    pub stage: CriticalStage,
    /// The number of the robot that responds; 0 in a request.
    pub healer: u32,
    /// Where the healer is; without meaning in a request.
    pub healer_block: Block,
}

impl CriticalSituation {
    /// What a healer has to bring: what the robot carries, from where it is, or what it was to collect.
    pub fn job(&self) -> Option<Job> {
        let from = match self.kind {
            CriticalKind::CarriesLuggage => self.block,
            CriticalKind::OnTheWay => self.from,
            CriticalKind::Idle => return None,
        };
        Some(Job { luggage: self.luggage, from, to: self.to })
    }
}

impl fmt::Display for CriticalSituation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Robot{} in {} needs help", self.critical, self.block)
    }
}
