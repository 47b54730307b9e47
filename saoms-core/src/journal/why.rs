use std::collections::BTreeMap;
use std::fmt;

use saoms_api::host::Phase;
use saoms_api::{Cause, Time};
use serde::{Serialize, Serializer};
use serde_json::Value;

use super::{Journal, JournalEntry};

/// Explanation of the last act of a component.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Why<'a> {
    /// Time of the act; `null` if there is none yet.
    #[serde(rename = "time_s", serialize_with = "seconds")]
    pub time: Option<Time>,
    /// Acts with their causes: one chain for each cause.
    pub chains: Vec<Chain<'a>>,
    /// Knowledge at the given time: the entries that ever changed.
    pub knowledge: Vec<KnowledgeEntry>,
}

/// Acts of one cause, and the chain of causes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chain<'a> {
    /// The acts.
    pub acts: Vec<&'a JournalEntry>,
    /// The causes, from the last one back to the first.
    pub reasons: Vec<&'a JournalEntry>,
    /// The first cause that is missing, because it is not in the journal any more.
    #[serde(serialize_with = "number")]
    pub missing: Option<Cause>,
}

/// The value of an entry of a component's knowledge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KnowledgeEntry {
    /// The entry.
    pub entry: String,
    /// Its value.
    pub value: Value,
    /// Time of its last change; `null` if it is older than the journal.
    #[serde(rename = "since_s", serialize_with = "seconds")]
    pub since: Option<Time>,
}

/// Error: the acts of the component at that time are not in the journal any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WhyError {
    /// Time of the oldest kept record of the component; `None` if none is kept.
    pub since: Option<Time>,
}

impl fmt::Display for WhyError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.since {
            Some(since) => {
                write!(formatter, "what it did then was overwritten: its journal reaches back to {since}")
            }
            None => formatter.write_str("what it did then was overwritten"),
        }
    }
}

impl std::error::Error for WhyError {}

fn seconds<S: Serializer>(time: &Option<Time>, serializer: S) -> Result<S::Ok, S::Error> {
    time.map(Time::as_secs_f64).serialize(serializer)
}

fn number<S: Serializer>(cause: &Option<Cause>, serializer: S) -> Result<S::Ok, S::Error> {
    cause.map(|cause| cause.0).serialize(serializer)
}

impl KnowledgeEntry {
    /// The value as records show it.
    pub fn shown(&self) -> String {
        shown(&self.value)
    }
}

fn shown(value: &Value) -> String {
    match value {
        Value::Null => "none".to_owned(),
        Value::Bool(true) => "yes".to_owned(),
        Value::Bool(false) => "no".to_owned(),
        Value::String(text) => text.clone(),
        Value::Array(values) => format!("({})", values.iter().map(shown).collect::<Vec<_>>().join(",")),
        other => other.to_string(),
    }
}

impl Journal {
    /// Explains the last act of a component, up to this time of the run or at all: its causes, and the knowledge at
    /// that time.
    ///
    /// An act is an effect or a decision. A change of the knowledge without a cause, such as a measured value, is an
    /// act only if the execution has no other.
    ///
    /// # Errors
    /// The records of that time are not in the journal any more.
    pub fn why(&self, component: &str, at: Option<Time>) -> Result<Why<'_>, WhyError> {
        let own: Vec<&JournalEntry> = self.of(component).iter().collect();
        let until = own.iter().filter(|entry| at.is_none_or(|at| entry.time() <= at));
        let acted = until.clone().filter(|entry| is_act(entry)).map(|entry| entry.time()).max();
        let time = acted.or_else(|| until.map(|entry| entry.time()).max());
        if acted.is_none() && self.overwritten_of(component) > 0 {
            return Err(WhyError { since: own.first().map(|entry| entry.time()) });
        }
        let then = own.iter().copied().filter(|entry| Some(entry.time()) == time);
        let chains = self.chains(&then.collect::<Vec<_>>());
        Ok(Why { time, chains, knowledge: knowledge(&own, at) })
    }

    /// The records of one execution as acts with their causes.
    fn chains<'a>(&'a self, then: &[&'a JournalEntry]) -> Vec<Chain<'a>> {
        let acts: Vec<&JournalEntry> = then.iter().copied().filter(|entry| is_act(entry)).collect();
        let shown = if acts.is_empty() { then } else { &acts };
        let ends = shown.iter().filter(|entry| !shown.iter().any(|other| other.cause() == entry.id()));
        let mut chains: Vec<Chain<'a>> = Vec::new();
        for act in ends {
            let together =
                chains.iter_mut().find(|chain| act.cause() != Cause::default() && chain.acts[0].cause() == act.cause());
            match together {
                Some(chain) => chain.acts.push(act),
                None => {
                    let (reasons, missing) = self.reasons(act);
                    chains.push(Chain { acts: vec![act], reasons, missing });
                }
            }
        }
        chains
    }

    /// Number of records of a component that were overwritten.
    fn overwritten_of(&self, component: &str) -> u64 {
        let counts = self.loops.iter().filter(|counts| counts.component == component);
        let written: u64 = counts.map(super::LoopCounts::records).sum();
        written.saturating_sub(self.of(component).len() as u64)
    }
}

pub(super) fn is_act(entry: &JournalEntry) -> bool {
    match entry.phase() {
        Phase::Symptom => false,
        Phase::Decision => true,
        Phase::Effect => !entry.change || entry.cause() != Cause::default(),
    }
}

/// The values at a time. An entry that changed only later has the `before` value of its first change.
fn knowledge(own: &[&JournalEntry], at: Option<Time>) -> Vec<KnowledgeEntry> {
    let mut known: BTreeMap<String, KnowledgeEntry> = BTreeMap::new();
    for entry in own {
        let Some(change) = entry.change() else { continue };
        let name = change.entry;
        if at.is_none_or(|at| entry.time() <= at) {
            let now = KnowledgeEntry { entry: name.clone(), value: change.after, since: Some(entry.time()) };
            known.insert(name, now);
        } else {
            let before = KnowledgeEntry { entry: name.clone(), value: change.before, since: None };
            known.entry(name).or_insert(before);
        }
    }
    known.into_values().collect()
}
