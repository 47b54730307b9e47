//! The journal of a run: symptoms, decisions and effects of each loop of each component, each with its cause.
//!
//! While a component's code runs, its records go to a buffer of its own. They are delivered together with the messages
//! that it sent, to a ring of the newest records of each component, and to the observers that want them. A record keeps
//! its text and values apart: it is formatted when it is read.

mod batch;
mod entry;
mod excerpt;
mod find;
mod fingerprint;
mod json;
mod kept;
mod nodes;
mod outside;
mod queue;
mod read;
mod recorder;
mod ring;
mod select;
#[cfg(test)]
mod tests;
mod why;

pub(crate) use batch::{Batch, Head};
pub(crate) use entry::{COMPONENT_FAILED, FLEET_CHANGED, FROM_OUTSIDE};
pub use entry::{Change, JournalEntry};
pub use excerpt::LiveJournal;
pub(crate) use excerpt::Pieces;
pub use find::find;
pub use json::RecordValues;
pub(crate) use json::in_lines;
pub use kept::{Journal, LoopCounts};
pub use nodes::node_of;
pub(crate) use nodes::of_node;
pub(crate) use outside::OutsideRing;
pub(crate) use queue::RecordQueue;
pub use read::{ComponentName, JournalDocument, JournalPart, JournalReadError, JournalSource, part, read, read_parts};
pub(crate) use recorder::{Recorder, Stamp};
pub(crate) use ring::Ring;
pub use select::Selection;
pub use why::{Chain, KnowledgeEntry, Why, WhyError};
