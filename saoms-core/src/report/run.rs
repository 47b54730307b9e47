use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use smol_str::SmolStr;

use super::recording::{self, Recording};
use super::{LatenessSummary, NodeReport, PartOfFleet, Standstill, label};
use crate::adaptation::AdaptationReport;
use crate::journal::Journal;

/// The report of a run, as `saoms run --report` writes it.
///
/// Sections that components contribute stand beside the fields below.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunReport {
    /// The seed of all chance.
    pub seed: u64,
    /// Duration of the run, in seconds of its own clock.
    pub time_s: f64,
    /// Executions of all periodic components together.
    pub periods: u64,
    /// Values contributed by components, as nested objects.
    #[serde(flatten)]
    pub sections: Map<String, Value>,
    /// Every component, in document order.
    pub components: Vec<ComponentReport>,
    /// Symptoms, decisions and effects of the loops.
    #[serde(default)]
    pub journal: Journal,
    /// What came of the events of the run; `None` where it was not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adaptation: Option<AdaptationReport>,
    /// Votes of the components about the work that is left.
    pub votes: Votes,
    /// The standstill of the run, if there was one: nothing happened for a long time, although work was left.
    #[serde(default)]
    pub standstill: Option<Standstill>,
    /// Outcome of the run.
    pub outcome: Outcome,
    /// A digest of everything that happened, 16 hexadecimal digits: equal for equal runs, on every machine. `null` in
    /// real time, where no two runs are equal.
    pub trace_hash: Option<String>,
    /// The node of the fleet that ran; `None` where all of it did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<PartOfFleet>,
    /// What `saoms view` shows; `None` where nobody recorded it. It is not read back: it may be large.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "recording::ignored")]
    pub recording: Option<Recording>,
    /// The nodes whose reports were joined to this one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub nodes: Vec<NodeReport>,
}

impl RunReport {
    /// The same report without the records of the journal and the list of events, whose counts stay, and without the
    /// recording.
    #[must_use]
    pub fn without_records(&self) -> RunReport {
        let RunReport { seed, time_s, periods, sections, components, journal, adaptation, .. } = self;
        RunReport {
            seed: *seed,
            time_s: *time_s,
            periods: *periods,
            sections: sections.clone(),
            components: components.clone(),
            journal: journal.without_records(),
            adaptation: adaptation.as_ref().map(AdaptationReport::without_events),
            votes: self.votes.clone(),
            standstill: self.standstill.clone(),
            outcome: self.outcome.clone(),
            trace_hash: self.trace_hash.clone(),
            part: self.part.clone(),
            recording: None,
            nodes: self.nodes.clone(),
        }
    }

    /// The whole number at a dotted path of the sections, such as `map.blocks`; 0 where there is none.
    pub fn count(&self, path: &str) -> i64 {
        let mut names = path.split('.');
        let section = names.next().and_then(|name| self.sections.get(name));
        let value = names.fold(section, |value, name| value.and_then(|value| value.get(name)));
        value.and_then(Value::as_i64).unwrap_or_default()
    }
}

/// One component in a [`RunReport`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ComponentReport {
    /// Its path in the composite.
    #[serde(with = "label")]
    pub name: SmolStr,
    /// Its `ID`; a passive component has none.
    #[serde(default, with = "label::optional")]
    pub id: Option<SmolStr>,
    /// Its class.
    #[serde(with = "label")]
    pub class: SmolStr,
    /// Number of executions begun.
    pub executions: u64,
    /// Number of due executions that were left out, because the one before had not started in time.
    pub missed: u64,
    /// Reactions to messages of topics that trigger it.
    #[serde(default)]
    pub reactions: u64,
    /// Lateness of the starts of executions, in microseconds.
    pub late_us: LatenessSummary,
    /// Number of executions that ended after their deadline.
    pub deadline_misses: u64,
    /// Number of executions that took longer than the watchdog's budget.
    pub slow: u64,
    /// Number of executions that were skipped, because a component that it called was busy.
    #[serde(default)]
    pub busy: u64,
    /// Number of new instances that replaced a failed one.
    pub restarts: u32,
    /// Number of replacements by a new instance in changes of the fleet (`saoms apply`, `saoms run --reload`).
    #[serde(default)]
    pub replaced: u32,
    /// Number of failures, by an error or a panic.
    pub failures: u64,
    /// Messages that its event queues could not hold, and messages of it that a state topic could not keep.
    pub dropped: u64,
    /// Messages sent and received.
    pub messages: MessageCounts,
}

/// Numbers of messages that a component sent and received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MessageCounts {
    /// Sent, each counted once however many readers it had.
    pub sent: u64,
    /// Received.
    pub received: u64,
}

/// Votes of the components about the work that is left.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Votes {
    /// Number of components that voted that all work is done.
    pub done: u64,
    /// The names of the components that voted that work is left.
    pub open: Vec<String>,
    /// The names of the components that voted that work was given up.
    #[serde(default)]
    pub given_up: Vec<String>,
}

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcome {
    /// Status in one word.
    pub status: RunStatus,
    /// Failures, and the cause of the end where it is not evident.
    pub reasons: Vec<String>,
}

/// Status of an ended run: of those that hold, the last one in this list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunStatus {
    /// All work was done.
    Done,
    /// The time given for the run was over.
    Elapsed,
    /// An operator ended the run (`saoms down`).
    Stopped,
    /// Work was given up, whatever ended the run.
    Incomplete,
    /// A component or observer failed for good, whatever ended the run.
    Failed,
    /// The run was interrupted, as by Ctrl-C.
    Interrupted,
}
