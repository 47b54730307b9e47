use super::{FleetStatus, TopicReaderStatus};
use crate::journal::LoopCounts;
use crate::report::LatenessSteps;

/// What can be counted in a running fleet.
#[derive(Clone, Debug, PartialEq)]
pub struct FleetMetrics {
    /// The fleet with its components.
    pub status: FleetStatus,
    /// Lateness of the components in real time, by their paths.
    pub lateness: Vec<(String, LatenessSteps)>,
    /// Numbers that components contribute to the report, by their paths in it.
    pub numbers: Vec<(String, f64)>,
    /// Records of the journal, by component and loop.
    pub loops: Vec<LoopCounts>,
    /// Events that wait, with the name of their topic. A component whose code runs is left out.
    pub queues: Vec<(String, TopicReaderStatus)>,
    /// The url of each network, and the number of messages that were lost on it.
    pub networks: Vec<(String, u64)>,
}
