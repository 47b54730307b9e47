use std::ops::Range;

use crate::Time;
use crate::host::TopicDeclaration;

/// A language of events from outside the fleet: `saoms run --events` reads lines of it.
///
/// Each event becomes a message on the topic of the language.
#[derive(Clone, Copy, Debug)]
pub struct EventLanguage {
    /// The topic of the messages.
    pub topic: TopicDeclaration<'static>,
    /// Codes of findings that do not hold for a run with such events: that nothing brings work.
    pub settles: &'static [&'static str],
    /// Makes a reader for one run, with the seed of the run.
    pub new: fn(seed: u64) -> Box<dyn EventReader>,
}

inventory::collect!(EventLanguage);

impl EventLanguage {
    /// The languages that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static EventLanguage> {
        inventory::iter::<EventLanguage>()
    }
}

/// A reader of events, line by line.
pub trait EventReader: Send {
    /// Reads a line, which comes at the time `now` of the run. An empty line or a comment has no events.
    ///
    /// # Errors
    /// The fault of the line, which has no events then.
    fn read(&mut self, line: &str, now: Time) -> Result<Vec<TimedMessage>, LineFault>;
}

/// A message from outside, with its time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimedMessage {
    /// Time at which it takes effect; `None` is the next instant.
    pub at: Option<Time>,
    /// The message in CDR (see [`crate::host::cdr`]).
    pub bytes: Vec<u8>,
    /// Description in the words of the language.
    pub text: String,
}

/// A fault of a line of events.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineFault {
    /// The bytes of the line that are wrong.
    pub bytes: Range<usize>,
    /// Found and expected text.
    pub message: String,
    /// Suggested replacement of the bytes.
    pub instead: Option<String>,
    /// Advice.
    pub help: Option<String>,
}
