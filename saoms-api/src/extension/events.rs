use std::fmt;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicU32;

use crate::Time;
use crate::event::Events;
use crate::host::TopicDeclaration;
use crate::rule::{Code, FleetView};

/// A language of events from outside the fleet: `saoms run --events` reads lines of it.
///
/// Each event of the language becomes a message on its topic. Its lines can have the events that classes take, too.
#[derive(Clone, Copy, Debug)]
pub struct EventLanguage {
    /// The topic of the messages.
    pub topic: TopicDeclaration<'static>,
    /// Codes of findings that do not hold for a run with such events: that nothing brings work.
    pub settles: &'static [&'static str],
    /// Judges a line without faults before a run starts, by the fleet or the site that its events are for.
    pub judge: fn(&FleetView<'_>, &Events, &str) -> Result<(), LineFault>,
    /// Makes a reader of one source of events.
    pub new: fn(EventSource) -> Box<dyn EventReader>,
}

inventory::collect!(EventLanguage);

impl EventLanguage {
    /// The languages that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static EventLanguage> {
        inventory::iter::<EventLanguage>()
    }
}

/// A source of events: a file, or operators.
#[derive(Clone, Debug)]
pub struct EventSource {
    /// Its name, from which its chance follows.
    pub name: &'static str,
    /// What messages call one of its lines, such as "a line of `--events`".
    pub line: &'static str,
    /// Seed of the run.
    pub seed: u64,
    /// Number of things that the events of all sources of the run have numbered so far.
    pub numbers: Arc<AtomicU32>,
}

/// A reader of events, line by line.
pub trait EventReader: Send {
    /// Reads a line, which comes at the time `now` of the run, with the events that classes of the fleet take. An empty
    /// line or a comment has no events.
    ///
    /// # Errors
    /// The fault of the line, which has no events then.
    fn read(&mut self, line: &str, now: Time, events: &Events) -> Result<Vec<TimedMessage>, LineFault>;
}

/// A message from outside, with its time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimedMessage {
    /// Time at which it takes effect; `None` is the next instant.
    pub at: Option<Time>,
    /// The message.
    pub content: EventContent,
    /// A line of the language that says the same, without its time.
    pub text: String,
}

/// The content of a message from outside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EventContent {
    /// A message on the topic of the language, in CDR (see [`crate::host::cdr`]).
    Bytes(Vec<u8>),
    /// An event that classes take: its text is an [`EventCall`](crate::event::EventCall).
    Raised,
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
    /// The code of the rule over fleets that finds it, whose severity users can set; without one it is an error.
    pub code: Option<&'static Code>,
}

impl LineFault {
    /// A fault without advice.
    pub fn new(bytes: Range<usize>, message: impl Into<String>) -> LineFault {
        LineFault { bytes, message: message.into(), instead: None, help: None, code: None }
    }

    /// Adds the suggested replacement.
    #[must_use]
    pub fn instead(self, meant: impl Into<String>) -> LineFault {
        LineFault { instead: Some(meant.into()), ..self }
    }

    /// Adds advice.
    #[must_use]
    pub fn help(self, text: impl Into<String>) -> LineFault {
        LineFault { help: Some(text.into()), ..self }
    }

    /// The same fault, found by a rule over fleets.
    #[must_use]
    pub fn code(self, code: &'static Code) -> LineFault {
        LineFault { code: Some(code), ..self }
    }

    /// The same fault at another place.
    #[must_use]
    pub fn at(self, bytes: Range<usize>) -> LineFault {
        LineFault { bytes, ..self }
    }

    /// The same fault, in a text that starts so many bytes before this one.
    #[must_use]
    pub fn moved(self, by: usize) -> LineFault {
        LineFault { bytes: self.bytes.start + by..self.bytes.end + by, ..self }
    }
}

impl fmt::Display for LineFault {
    /// The fault without its place, in one line.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)?;
        if let Some(instead) = &self.instead {
            write!(formatter, "; did you mean `{instead}`?")?;
        }
        match &self.help {
            Some(help) => write!(formatter, "; {help}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for LineFault {}
