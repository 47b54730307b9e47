//! Fault injection: faults that are put into a run on purpose, to test how a fleet handles them.
//!
//! The engine looks for them at two places only: when an execution begins, and when messages go from their sender to
//! their topic. Until the first fault begins, that costs one comparison. In virtual time a run with faults is as
//! deterministic as one without: all chance is from the seed of the run, each fault with numbers of its own.
//!
//! Faults of messages act on links, the ways from a sender to a reader by a topic: a reader that is concerned reads a
//! copy of the topic of its own ([`Bus::link`](crate::bus::Bus::link)). What is retained for late readers stays as it
//! is, and so does what a component hears of itself.

mod flight;
mod named;
mod play;
mod tasks;
#[cfg(test)]
mod tests;

use saoms_api::Time;
use saoms_api::event::fault::FaultCall;

pub(crate) use play::{Arrival, End, FaultPlay, OnLink};
pub(crate) use tasks::TaskFault;

/// A fault with the time at which it begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimedFault {
    /// The time, in that of the run.
    pub at: Time,
    /// The site whose components it concerns; empty for all components.
    pub site: String,
    /// The fault.
    pub call: FaultCall,
}

impl TimedFault {
    /// A fault of a fleet without sites.
    pub fn new(at: Time, call: FaultCall) -> TimedFault {
        TimedFault { at, site: String::new(), call }
    }
}
