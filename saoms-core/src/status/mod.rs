//! The status of a running fleet, as operators see it.

mod metrics;

use std::collections::HashSet;
use std::sync::Arc;

use saoms_api::extension::RunSummary;
use saoms_api::host::SmolStr;
use saoms_api::{Failure, ReportValue, Time};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

pub use metrics::FleetMetrics;

use crate::report::{ComponentReport, json};

/// A snapshot of a running fleet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FleetStatus {
    /// Time of the run in seconds.
    pub time_s: f64,
    /// What the fleet does.
    pub phase: FleetPhase,
    /// True while the run pauses.
    pub paused: bool,
    /// Seconds of virtual time in a second; `null` as fast as possible, and in real time.
    pub speed: Option<f64>,
    /// Summaries of the report's counts so far ([`RunSummary::progress`]).
    pub summaries: Vec<String>,
    /// Its components in document order, without those that were removed.
    pub components: Vec<ComponentStatus>,
}

/// Phases of a fleet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FleetPhase {
    /// Its components initialize.
    Starting,
    /// Its components execute.
    Running,
    /// Its components shut down.
    Ending,
    /// The run is over.
    Ended,
}

/// A snapshot of a component.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComponentStatus {
    /// What its report would say now.
    #[serde(flatten)]
    pub report: ComponentReport,
    /// The site that it belongs to; empty outside of sites.
    #[serde(serialize_with = "text")]
    pub site: SmolStr,
    /// What it does.
    pub state: ComponentState,
    /// True from an emergency stop to its release.
    pub emergency_stop: bool,
    /// Its period in milliseconds; a passive component has none.
    pub period_ms: Option<f64>,
    /// Seconds since its present code was called, if that has not returned: long if it hangs. Not in virtual time.
    pub in_code_s: Option<f64>,
    /// What it waits for, if it takes no work by itself ([`Component::waits_for`](saoms_api::Component::waits_for)).
    pub waits_for: Option<String>,
    /// What it says of itself ([`Component::status`](saoms_api::Component::status)), shared by all who look.
    #[serde(serialize_with = "shared")]
    pub values: Arc<Map<String, Value>>,
    /// Time of the run in seconds at which it said so; `null` if it was never asked.
    pub values_s: Option<f64>,
}

/// States of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ComponentState {
    /// It is not scheduled: nobody has started it yet, or it was stopped.
    Idle,
    /// It will be constructed and initialized.
    Starting,
    /// It takes part.
    Running,
    /// It will be shut down.
    Leaving,
    /// It has failed for good.
    Failed,
    /// Its code did not return in time, and it was given up.
    Abandoned,
}

impl FleetPhase {
    /// The phase as a word.
    pub fn name(self) -> &'static str {
        match self {
            FleetPhase::Starting => "starting",
            FleetPhase::Running => "running",
            FleetPhase::Ending => "ending",
            FleetPhase::Ended => "ended",
        }
    }
}

impl ComponentState {
    /// The state as a word.
    pub fn name(self) -> &'static str {
        match self {
            ComponentState::Idle => "idle",
            ComponentState::Starting => "starting",
            ComponentState::Running => "running",
            ComponentState::Leaving => "leaving",
            ComponentState::Failed => "failed",
            ComponentState::Abandoned => "abandoned",
        }
    }
}

/// A snapshot of a topic.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TopicStatus {
    /// Its name, after renaming.
    pub name: String,
    /// `event` or `state`.
    pub kind: &'static str,
    /// The name of its messages.
    pub message: String,
    /// The fields of its messages, as declarations write them.
    pub schema: Value,
    /// The fields that say who speaks, in words.
    pub speakers: Vec<String>,
    /// The components that publish it.
    pub publishers: Vec<String>,
    /// The components that read it.
    pub readers: Vec<TopicReaderStatus>,
}

/// A component that reads a topic.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TopicReaderStatus {
    /// Its path.
    pub component: String,
    /// Number of events that wait for it; `null` on a state topic, and while its code runs.
    pub waiting: Option<u64>,
    /// Number of events that may wait for it.
    pub queue: Option<u64>,
}

/// What a component said of itself.
#[derive(Clone, Debug, Default)]
pub(crate) struct Description {
    pub(crate) at: Time,
    pub(crate) waits_for: Option<String>,
    pub(crate) values: Arc<Map<String, Value>>,
}

fn text<S: Serializer>(text: &SmolStr, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(text)
}

fn shared<S: Serializer>(values: &Arc<Map<String, Value>>, serializer: S) -> Result<S::Ok, S::Error> {
    values.as_ref().serialize(serializer)
}

/// The values of a status by their names.
///
/// # Errors
/// A name stands twice: one of the two would be lost without a word.
pub(crate) fn named_values(values: &[(String, ReportValue)]) -> Result<Map<String, Value>, Failure> {
    let mut named = Map::new();
    for (name, value) in values {
        has_own_names(value)?;
        if named.insert(name.clone(), json(value)).is_some() {
            return Err(twice(name));
        }
    }
    Ok(named)
}

fn has_own_names(value: &ReportValue) -> Result<(), Failure> {
    match value {
        ReportValue::List(values) => values.iter().try_for_each(has_own_names),
        ReportValue::Map(values) => {
            let mut names = HashSet::new();
            values.iter().try_for_each(
                |(name, value)| {
                    if names.insert(name) { has_own_names(value) } else { Err(twice(name)) }
                },
            )
        }
        _ => Ok(()),
    }
}

fn twice(name: &str) -> Failure {
    Failure::new(format!("its status has `{name}` twice: give each value a name of its own"))
}

/// The summaries of counts so far.
pub(crate) fn summaries(count: impl Fn(&str) -> i64) -> Vec<String> {
    RunSummary::linked().into_iter().filter_map(|summary| (summary.progress)(&count)).collect()
}
