//! What a run tells the program while it happens.

mod event;
mod line;

pub use event::{Event, Events, Occurrence, Progress, Quiet, Sent};
pub(super) use line::{Line, News};
