pub(super) mod lease;

use saoms_api::Field;

use crate::grid::Block;
use crate::messages::{EventLuggage, LuggageStage};

/// Luggage that a robot brings, or is interested in; or blocks that it visits, the first and the last one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub struct Job {
    /// Number of the luggage.
    pub luggage: u32,
    /// Block where it is collected: the first destination.
    pub from: Block,
    /// Block where it is deposited: the second destination.
    pub to: Block,
}

impl Job {
    /// The robot's message about this luggage.
    pub const fn response(&self, robot: u32, block: Block, stage: LuggageStage) -> EventLuggage {
        EventLuggage { robot, luggage: self.luggage, stage, from: self.from, to: self.to, block }
    }
}
