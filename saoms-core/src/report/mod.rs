//! The report of a run: one [`RunReport`], and the statistics that it is made from.

mod label;
mod lateness;
mod merge;
mod part;
mod recording;
mod run;
mod sections;
mod standstill;
#[cfg(test)]
mod tests;

pub(crate) use label::Label;
pub use lateness::{Lateness, LatenessSteps, LatenessSummary};
pub use merge::{MergeError, merge};
pub use part::{NodeReport, PartOfFleet};
pub use recording::Recording;
pub use run::{ComponentReport, MessageCounts, Outcome, RunReport, RunStatus, Votes};
pub use sections::Sections;
pub(crate) use sections::{PartOfReport, json};
pub use standstill::{Standstill, Waiting};
