//! Observers of a run: programs that see what happens in a fleet without being part of it.
//!
//! An [`Observer`] receives events, the messages of topics that it asks for, records of the journal, and the report at
//! the end. It changes nothing in the fleet, the trace included, and data that no observer asks for costs nothing.
//! Events and messages are put into a queue while the fleet runs, and delivered by a thread of their own; so are
//! records, by a second queue and thread.

mod adaptation;
mod event;
mod invariants;
mod journal_file;
mod observer;
mod queue;
mod records;
mod rotation;
mod sample;
#[cfg(test)]
mod tests;

pub use adaptation::AdaptationWatch;
pub use event::{Occurrence, RunEvent, RunProgress, SentMessage};
pub use invariants::InvariantWatch;
pub use journal_file::JournalFile;
pub(crate) use observer::Observers;
pub use observer::{Beginning, Interest, LostEvents, Observer, Records, WriterEvents};
pub(crate) use queue::{EventQueue, Notification};
pub(crate) use records::{RecordDelivery, deliver_records};
pub use rotation::{RotatingFile, Rotation, create_file, earlier_file};
pub use sample::{FleetSample, SampleRate, StateOfTopic};
