use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use saoms_api::event::fault::FaultCall;
use saoms_api::extension::ConcernedComponent;
use saoms_api::host::SharedMessage;
use saoms_api::{Level, Time};

use crate::report::Standstill;

/// Something that happened in a fleet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunEvent {
    /// Time of the run.
    pub time: Time,
    /// The path of the component that it concerns; `None` is the fleet as a whole.
    pub component: Option<Arc<str>>,
    /// Kind of the event.
    pub what: Occurrence,
}

/// Kinds of events.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Occurrence {
    /// A component wrote a line to its log.
    Log {
        /// Severity.
        level: Level,
        /// The line.
        text: String,
    },
    /// A person is needed, or no longer.
    Alert {
        /// Its kind, such as `assistance`.
        kind: Arc<str>,
        /// What it is about, where a component may have several of a kind; else empty.
        subject: Arc<str>,
        /// What is wrong; `None`: it is over.
        text: Option<String>,
    },
    /// A component wrote a line to the classic console.
    Console {
        /// The line.
        text: String,
    },
    /// The component has initialized and takes part.
    Started,
    /// The component has shut down.
    Left,
    /// The component failed, by an error or a panic.
    Failed {
        /// Message of the failure.
        message: String,
        /// Delay until a new instance replaces it; `None` is never.
        restart: Option<Duration>,
    },
    /// A new instance has replaced a failed one.
    Restarted {
        /// Number of restarts so far.
        number: u32,
        /// True if it goes on from what the failed one had saved.
        continued: bool,
    },
    /// A new instance has replaced the component, in a change of the fleet.
    Replaced {
        /// True if it restored the state of the earlier one.
        continued: bool,
    },
    /// A function of the component took so long that another thread had to take over the other components. From now on
    /// the component runs on a thread of its own.
    Slow {
        /// What took so long, such as `an execution`.
        what: &'static str,
        /// The watchdog's budget.
        budget: Duration,
    },
    /// An event queue of the component was full. Reported once for each burst.
    Dropped {
        /// The topic.
        topic: Arc<str>,
        /// Number of messages lost in this period.
        count: u64,
        /// The component that sent most of those that fitted.
        sender: Option<Arc<str>>,
    },
    /// Executions were due faster than they could be run, and the component's `overrun` is `stop`.
    Overrun {
        /// Number of executions left out.
        missed: u64,
    },
    /// A component that it called was busy: its execution is skipped, its start or shutdown tried again. Reported once
    /// for each row of such executions.
    Busy {
        /// The component that was called.
        provider: Arc<str>,
    },
    /// The code of the component has not returned for two periods if it has hardware, which is stopped then; else for
    /// ten periods and five seconds.
    Hangs {
        /// The time since its code was called.
        time: Duration,
        /// True if it has hardware.
        stops: bool,
        /// The library of its code, if it is of one.
        library: Option<String>,
    },
    /// The code of a component that hung has returned.
    Returned,
    /// The hardware of the component could not be stopped.
    NotStopped {
        /// Message of the failure.
        message: String,
    },
    /// The component did not end in time and was abandoned.
    Abandoned,
    /// Nothing has happened for a long time, although work is left.
    Standstill(Standstill),
    /// A fault begins that was put into the run.
    Fault {
        /// The fault.
        call: FaultCall,
        /// The components that a fault of components names, those of other nodes included.
        concerned: Vec<ConcernedComponent>,
    },
    /// A remark about the whole fleet.
    Note {
        /// Severity.
        level: Level,
        /// The remark.
        text: String,
    },
}

impl Occurrence {
    /// Severity.
    pub fn level(&self) -> Level {
        match self {
            Occurrence::Log { level, .. } | Occurrence::Note { level, .. } => *level,
            Occurrence::Fault { .. }
            | Occurrence::Console { .. }
            | Occurrence::Replaced { .. }
            | Occurrence::Returned => Level::Info,
            Occurrence::Started | Occurrence::Left | Occurrence::Alert { text: None, .. } => Level::Debug,
            Occurrence::Failed { restart: None, .. }
            | Occurrence::Alert { text: Some(_), .. }
            | Occurrence::Overrun { .. }
            | Occurrence::Abandoned
            | Occurrence::NotStopped { .. } => Level::Error,
            Occurrence::Failed { .. }
            | Occurrence::Restarted { .. }
            | Occurrence::Slow { .. }
            | Occurrence::Busy { .. }
            | Occurrence::Hangs { .. }
            | Occurrence::Standstill(_)
            | Occurrence::Dropped { .. } => Level::Warning,
        }
    }
}

impl fmt::Display for Occurrence {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Occurrence::Log { text, .. }
            | Occurrence::Console { text }
            | Occurrence::Note { text, .. }
            | Occurrence::Alert { text: Some(text), .. } => formatter.write_str(text),
            Occurrence::Alert { kind, subject, text: None } => {
                let of = if subject.is_empty() { "" } else { " of " };
                write!(formatter, "the alert `{kind}`{of}{subject} is over")
            }
            Occurrence::Started => formatter.write_str("started"),
            Occurrence::Left => formatter.write_str("has shut down"),
            Occurrence::Failed { message, restart: None } => write!(formatter, "failed: {message}"),
            Occurrence::Failed { message, restart: Some(pause) } => {
                write!(formatter, "failed and is restarted in {}: {message}", saoms_api::host::format_duration(*pause))
            }
            Occurrence::Restarted { number, continued: false } => write!(formatter, "restarted ({number})"),
            Occurrence::Restarted { number, continued: true } => {
                write!(formatter, "restarted ({number}), and continues")
            }
            Occurrence::Replaced { continued: true } => {
                formatter.write_str("is replaced, and continues with the earlier state")
            }
            Occurrence::Replaced { continued: false } => {
                formatter.write_str("is replaced, and starts without the earlier state")
            }
            Occurrence::Slow { what, budget } => write!(
                formatter,
                "{what} takes longer than {}: from now on the component runs on a thread of its own, which starts executions less punctually",
                saoms_api::host::format_duration(*budget)
            ),
            Occurrence::Dropped { topic, count, sender } => {
                write!(formatter, "lost {count} messages of topic `{topic}`, whose queue was full")?;
                match sender {
                    Some(sender) => write!(formatter, ": most were sent by `{sender}`"),
                    None => Ok(()),
                }
            }
            Occurrence::Busy { provider } if provider.contains("://") => {
                write!(formatter, "the server at `{provider}`, which it calls, is busy: tries again in each period")
            }
            Occurrence::Busy { provider } => {
                write!(formatter, "component `{provider}`, which it calls, is busy: tries again in each period")
            }
            Occurrence::Overrun { missed } => {
                write!(formatter, "stopped, because executions could not start in time: {missed} would be left out")
            }
            Occurrence::Hangs { time, stops, library } => {
                let time = saoms_api::host::format_duration(Duration::from_millis(time.as_millis() as u64));
                let then = if *stops { ": its hardware is stopped" } else { "" };
                let library = library.as_deref().map(|library| format!(" (library `{library}`)")).unwrap_or_default();
                write!(formatter, "has not returned for {time}{then}{library}")
            }
            Occurrence::Fault { call, .. } => write!(formatter, "the fault `{call}` begins"),
            Occurrence::Returned => formatter.write_str("has returned"),
            Occurrence::NotStopped { message } => write!(formatter, "its hardware may still move: {message}"),
            Occurrence::Standstill(standstill) => standstill.fmt(formatter),
            Occurrence::Abandoned => formatter.write_str("did not end in time and is abandoned"),
        }
    }
}

impl fmt::Display for RunEvent {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.component {
            Some(component) => write!(formatter, "[{}] {component}: {}", self.time, self.what),
            None => write!(formatter, "[{}] {}", self.time, self.what),
        }
    }
}

/// A message that was sent.
#[derive(Clone, Debug)]
pub struct SentMessage {
    /// The topic, by the name that it has after renaming.
    pub topic: Arc<str>,
    /// The path of the component that sent it.
    pub component: Arc<str>,
    /// The message; its header says when it was sent, or arrived from another program.
    pub message: SharedMessage,
    /// True if it came from another program: only observers that [hear others](super::Observer::hears_others) get it.
    pub is_of_other: bool,
}

/// The progress of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunProgress {
    /// The time of the run.
    pub time: Time,
    /// Executions of all components so far.
    pub periods: u64,
    /// Short summaries of the report's counts so far ([`RunSummary::progress`](saoms_api::extension::RunSummary)).
    pub summaries: Vec<String>,
}
