//! Adaptation measured: what came of each event of a run, and when, by the records of its journal.
//!
//! An *event* is a symptom or decision that no record of the journal caused: what came from outside the fleet, what a
//! component without loops saw, or what a loop began by itself. What follows from it by the causes of the journal is
//! its tree. [`Adaptations`] takes in the records one by one and keeps of each event a few times; [`AdaptationReport`]
//! has them by kind of event.
//!
//! It knows no component: the names in its tables are those that the journal has.

mod event;
mod known;
mod measure;
mod names;
mod report;
mod samples;
mod spread;
mod switches;
#[cfg(test)]
mod tests;
mod text;
mod throughput;

pub use measure::Adaptations;
pub use report::{AdaptationReport, KindReport, MeasuredEvent};
pub use samples::Samples;
pub use spread::Spread;
pub use throughput::Throughput;
