//! Recordings of fleets: the messages of topics, the journal and the log of a run in a file of the format MCAP, as
//! tools of ROS 2 read it. `docs/recording.md` has its parts.
//!
//! [`Recording`] is the observer that writes one while a fleet runs; [`Reader`] reads it, also one that was cut off;
//! [`Excerpt`] writes a part of it.

mod drawer;
mod error;
mod excerpt;
mod file;
mod messages;
mod queue;
mod reader;
mod recording;
#[cfg(test)]
mod tests;
mod writing;

pub use error::RecordingError;
pub use excerpt::Excerpt;
pub use reader::{Channel, Part, Reader, RecordedFile, RecordedMessage};
pub use recording::{RecordedRun, Recording};
pub use writing::{REPORT, path_of_part};
