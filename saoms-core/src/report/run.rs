use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::LatenessSummary;
use crate::journal::Journal;

/// The report of a run, as `saoms run --report` writes it.
///
/// Sections that components contribute stand beside the fields below.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunReport {
    /// The seed of all chance.
    pub seed: u64,
    /// How long the run lasted, in seconds of its own clock.
    pub time_s: f64,
    /// Executions of all periodic components together.
    pub periods: u64,
    /// What components contributed, as nested objects.
    #[serde(flatten)]
    pub sections: Map<String, Value>,
    /// Every component, in document order.
    pub components: Vec<ComponentReport>,
    /// What the loops saw, decided and did.
    #[serde(default)]
    pub journal: Journal,
    /// Who said whether the work is done.
    pub votes: Votes,
    /// How the run ended.
    pub outcome: Outcome,
    /// A digest of everything that happened, 16 hexadecimal digits: equal for equal runs, on every machine. `null` in real time, where no
    /// two runs are equal.
    pub trace_hash: Option<String>,
}

impl RunReport {
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
    pub name: String,
    /// Its `ID`; a passive component has none.
    #[serde(default)]
    pub id: Option<String>,
    /// Its class.
    pub class: String,
    /// How many executions it began.
    pub executions: u64,
    /// How many due executions were left out, because the one before had not started in time.
    pub missed: u64,
    /// How late executions started, in microseconds.
    pub late_us: LatenessSummary,
    /// How many executions ended after their deadline.
    pub deadline_misses: u64,
    /// How many executions took longer than the watchdog's budget.
    pub slow: u64,
    /// How often a new instance took the place of a failed one.
    pub restarts: u32,
    /// How often a component of a new build of its class took its place (`saoms run --reload`).
    #[serde(default)]
    pub replaced: u32,
    /// How often it failed, by an error or a panic.
    pub failures: u64,
    /// Messages that its event queues could not hold.
    pub dropped: u64,
    /// Messages sent and received.
    pub messages: MessageCounts,
}

/// How many messages a component sent and received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MessageCounts {
    /// Sent, each counted once however many readers it had.
    pub sent: u64,
    /// Received.
    pub received: u64,
}

/// What components said about the work that is left.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Votes {
    /// How many said that it is done.
    pub done: u64,
    /// The names of those who saw work left.
    pub open: Vec<String>,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcome {
    /// In one word.
    pub status: RunStatus,
    /// What went wrong, and what ended the run where that is not evident.
    pub reasons: Vec<String>,
}

/// How a run ended, in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunStatus {
    /// All work was done.
    Done,
    /// The time given for the run was over.
    Elapsed,
    /// Something failed for good, whatever ended the run.
    Failed,
    /// The run was told to stop.
    Interrupted,
}
