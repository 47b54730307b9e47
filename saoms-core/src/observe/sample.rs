use std::sync::Arc;
use std::time::Duration;

use saoms_api::Time;

use super::SentMessage;
use crate::status::FleetStatus;

/// How often a fleet is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleRate {
    /// Time of the run between two samples.
    pub every: Duration,
    /// Number of samples after which the time between two doubles, and again after each half of it: who leaves out
    /// every second sample then has as many at most, however long the run lasts. `None` is never.
    pub most: Option<u32>,
}

/// A fleet at one moment between executions.
#[derive(Clone, Debug)]
pub struct FleetSample {
    /// Time of the run.
    pub time: Time,
    /// The fleet, with what its components say of themselves.
    pub status: FleetStatus,
    /// The state topics that an observer [wants](super::Observer::wants_state).
    pub states: Vec<StateOfTopic>,
    /// True for the sample of the end of a run, before its components shut down.
    pub is_last: bool,
}

/// What a state topic retains.
#[derive(Clone, Debug)]
pub struct StateOfTopic {
    /// Its name, after renaming.
    pub topic: Arc<str>,
    /// The name of its messages.
    pub message: Arc<str>,
    /// The fields of its messages, as declarations write them.
    pub schema: Arc<str>,
    /// The messages, the oldest first.
    pub retained: Vec<SentMessage>,
}
