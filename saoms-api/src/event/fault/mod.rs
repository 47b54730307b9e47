//! Faults that are put into a run on purpose, as lines write them: `for 30s lose 20 % on POSTOPIC from Robot* to
//! Robot2`.
//!
//! A line is read as a [`FaultCall`], which is judged by the [`FaultSubjects`] of a fleet: its components and topics.
//! The core plays it.

mod judge;
mod name;
mod rate;
mod read;

use std::fmt;
use std::ops::Range;
use std::time::Duration;

use crate::time::format_duration;

use super::Word;
pub use judge::{FaultSubjects, SubjectComponent, SubjectTopic};
pub use name::{NODE_SIGN, is_named, names_component};
pub use rate::Rate;

/// The words with which a fault begins, behind how long it lasts: no event has one of them as its name.
pub const FAULTS: [&str; 12] =
    ["lose", "violate", "delay", "jitter", "duplicate", "reorder", "cut", "part", "stall", "fail", "crash", "drift"];

/// The word before the time that a fault lasts.
pub const LASTING: &str = "for";

/// A fault as a line writes it.
///
/// ```
/// use std::time::Duration;
///
/// use saoms_api::event::fault::{FaultCall, FaultKind};
///
/// let call = FaultCall::read("for 30s lose 20 % on POSTOPIC from Robot* to Robot2")?;
/// assert_eq!(call.lasting, Some(Duration::from_secs(30)));
/// assert!(matches!(call.kind, FaultKind::Lose(rate) if rate.per_million() == 200_000));
/// assert_eq!(call.to_string(), "for 30s lose 20 % on POSTOPIC from Robot* to Robot2");
/// assert!(FaultCall::read("lose 120 %").is_err());
/// # Ok::<(), saoms_api::extension::LineFault>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultCall {
    /// How long it lasts; `None` is to the end of the run.
    pub lasting: Option<Duration>,
    /// What happens.
    pub kind: FaultKind,
    /// The bytes of the word that says so.
    pub bytes: Range<usize>,
    /// Of a fault of messages, the only topic that it concerns.
    pub topic: Option<Word>,
    /// Of a fault of messages, the components that send them; without any, all. Each is named by its path or its node
    /// ([`names_component`]).
    pub from: Vec<Word>,
    /// Of a fault of messages, the components that read them; without any, all. Otherwise the components that it
    /// concerns.
    pub to: Vec<Word>,
}

impl FaultCall {
    /// True if it names a node: a fault of messages acts then between components of different nodes alone.
    pub fn names_nodes(&self) -> bool {
        self.from.iter().chain(&self.to).any(|name| name.text.starts_with(NODE_SIGN))
    }
}

/// Kinds of faults. Those of messages act on the way from each sender to each reader by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// So many messages are lost on their way: one of a state topic for good, an event until it is sent again.
    Lose(Rate),
    /// So many messages are lost for good, events too.
    Violate(Rate),
    /// Each message takes a time between these two.
    Delay(Duration, Duration),
    /// Each message takes longer by a time up to this one.
    Jitter(Duration),
    /// So many messages come twice.
    Duplicate(Rate),
    /// So many messages come later by a time up to this one, while others overtake them.
    Reorder(Rate, Duration),
    /// The reader hears nothing from the sender.
    Cut,
    /// Neither of two groups hears the other one.
    Part,
    /// The next execution takes as long as the fault lasts.
    Stall,
    /// The next execution is a failure, which the component's `restart` handles.
    Fail,
    /// The component ends without a shutdown, and starts again after this time, or never.
    Crash {
        /// The time.
        restart: Option<Duration>,
    },
    /// The component's clock goes faster by so many millionths, or slower by a negative number.
    Drift(i32),
}

impl FaultKind {
    /// Its word.
    pub fn word(self) -> &'static str {
        FAULTS[self.place()]
    }

    /// The place of its word in [`FAULTS`].
    pub fn place(self) -> usize {
        match self {
            FaultKind::Lose(_) => 0,
            FaultKind::Violate(_) => 1,
            FaultKind::Delay(..) => 2,
            FaultKind::Jitter(_) => 3,
            FaultKind::Duplicate(_) => 4,
            FaultKind::Reorder(..) => 5,
            FaultKind::Cut => 6,
            FaultKind::Part => 7,
            FaultKind::Stall => 8,
            FaultKind::Fail => 9,
            FaultKind::Crash { .. } => 10,
            FaultKind::Drift(_) => 11,
        }
    }

    /// True if it is one of messages, not of components.
    pub fn is_of_messages(self) -> bool {
        self.place() < 8
    }
}

impl FaultCall {
    /// A fault of all links, or of no component yet, to the end of the run.
    pub fn new(kind: FaultKind) -> FaultCall {
        FaultCall { lasting: None, kind, bytes: 0..0, topic: None, from: Vec::new(), to: Vec::new() }
    }

    /// The same for a time.
    #[must_use]
    pub fn lasting(self, time: Duration) -> FaultCall {
        FaultCall { lasting: Some(time), ..self }
    }

    /// The same on a topic alone.
    #[must_use]
    pub fn on(self, topic: &str) -> FaultCall {
        FaultCall { topic: Some(Word::unplaced(topic)), ..self }
    }

    /// The same from one more sender.
    #[must_use]
    pub fn from(mut self, component: &str) -> FaultCall {
        self.from.push(Word::unplaced(component));
        self
    }

    /// The same to one more reader, or of one more component.
    #[must_use]
    pub fn to(mut self, component: &str) -> FaultCall {
        self.to.push(Word::unplaced(component));
        self
    }

    /// True if a line is one of a fault: its first word, behind how long it lasts, is one of a fault.
    pub fn is_one(line: &str) -> bool {
        let first = line.split_whitespace().next().unwrap_or_default();
        first == LASTING || FAULTS.contains(&first)
    }

    /// The same fault, in a text that starts so many bytes before the one that was read.
    #[must_use]
    pub fn moved(mut self, by: usize) -> FaultCall {
        self.bytes = self.bytes.start + by..self.bytes.end + by;
        let words = self.topic.iter_mut().chain(&mut self.from).chain(&mut self.to);
        words.for_each(|word| word.moved(by));
        self
    }
}

impl fmt::Display for FaultCall {
    /// The line of the fault, without its time.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(time) = self.lasting {
            write!(formatter, "{LASTING} {} ", format_duration(time))?;
        }
        formatter.write_str(self.kind.word())?;
        match self.kind {
            FaultKind::Lose(rate) | FaultKind::Violate(rate) | FaultKind::Duplicate(rate) => {
                write!(formatter, " {rate}")?;
            }
            FaultKind::Reorder(rate, by) => write!(formatter, " {rate} by {}", format_duration(by))?,
            FaultKind::Delay(least, most) if least == most => write!(formatter, " {}", format_duration(least))?,
            FaultKind::Delay(least, most) => {
                write!(formatter, " {} to {}", format_duration(least), format_duration(most))?;
            }
            FaultKind::Jitter(most) => write!(formatter, " {}", format_duration(most))?,
            FaultKind::Cut | FaultKind::Part => {
                write!(formatter, " {} from {}", names(&self.to), names(&self.from))?;
                return self.topic.as_ref().map_or(Ok(()), |topic| write!(formatter, " on {}", topic.text));
            }
            FaultKind::Stall | FaultKind::Fail => return write!(formatter, " {}", names(&self.to)),
            FaultKind::Crash { restart } => {
                write!(formatter, " {}", names(&self.to))?;
                return restart.map_or(Ok(()), |time| write!(formatter, " restart {}", format_duration(time)));
            }
            FaultKind::Drift(by) => {
                let sign = if by < 0 { "-" } else { "" };
                return write!(formatter, " {} {sign}{}", names(&self.to), Rate::of_millionths(by.unsigned_abs()));
            }
        }
        if let Some(topic) = &self.topic {
            write!(formatter, " on {}", topic.text)?;
        }
        if !self.from.is_empty() {
            write!(formatter, " from {}", names(&self.from))?;
        }
        if self.to.is_empty() { Ok(()) } else { write!(formatter, " to {}", names(&self.to)) }
    }
}

/// Names as a line has them.
fn names(words: &[Word]) -> String {
    words.iter().map(|word| word.text.as_str()).collect::<Vec<_>>().join(", ")
}
