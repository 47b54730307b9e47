use saoms_api::Field;

use crate::grid::Block;
use crate::messages::{EventLuggage, LuggageStage};

/// Luggage that a robot brings, or would.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub struct Job {
    /// The luggage's number.
    pub luggage: u32,
    /// Where to collect it: the first destination.
    pub from: Block,
    /// Where to deposit it: the second destination.
    pub to: Block,
}

impl Job {
    /// What a robot says about it.
    pub const fn response(&self, robot: u32, block: Block, stage: LuggageStage) -> EventLuggage {
        EventLuggage { robot, luggage: self.luggage, stage, from: self.from, to: self.to, block }
    }
}
