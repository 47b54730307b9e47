use std::collections::BTreeMap;
use std::fmt;

use saoms_api::host::Phase;
use saoms_api::{Cause, Time};
use serde::{Serialize, Serializer};
use serde_json::Value;

use super::{Journal, JournalEntry};

/// Why a component did what it did.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Why<'a> {
    /// When it acted; `null` when it had not yet.
    #[serde(rename = "time_s", serialize_with = "seconds")]
    pub time: Option<Time>,
    /// What it did then, and what led to it: one chain for each reason that it had.
    pub chains: Vec<Chain<'a>>,
    /// What it knew at the time that was asked about, as far as that ever changed.
    pub knowledge: Vec<KnowledgeEntry>,
}

/// What was done for one reason, and what led to it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chain<'a> {
    /// What was done.
    pub acts: Vec<&'a JournalEntry>,
    /// What led to it, from the last reason back to the first.
    pub reasons: Vec<&'a JournalEntry>,
    /// The record at which the way back is lost, because it is not in the journal any more.
    #[serde(serialize_with = "number")]
    pub missing: Option<Cause>,
}

/// The value of an entry of what a component knows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KnowledgeEntry {
    /// The entry.
    pub entry: String,
    /// Its value.
    pub value: Value,
    /// Since when; `null` is earlier than the journal reaches.
    #[serde(rename = "since_s", serialize_with = "seconds")]
    pub since: Option<Time>,
}

/// What the component did is not in the journal any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WhyError {
    /// How far the journal of the component reaches back; `None` when nothing of it is left.
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
    /// What a component did last, up to this time of the run or at all, what led to it, and what it knew then.
    ///
    /// An act is an effect or a decision. A change of the knowledge that no loop had a reason for, such as a measured value, is an act only where
    /// there is nothing else.
    ///
    /// # Errors
    /// What it did then is not in the journal any more.
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

    /// The records of one execution as acts with their reasons.
    fn chains<'a>(&'a self, then: &[&'a JournalEntry]) -> Vec<Chain<'a>> {
        let acts: Vec<&JournalEntry> = then.iter().copied().filter(|entry| is_act(entry)).collect();
        let told = if acts.is_empty() { then } else { &acts };
        let ends = told.iter().filter(|entry| !told.iter().any(|other| other.cause() == entry.id()));
        let mut chains: Vec<Chain<'a>> = Vec::new();
        for act in ends {
            let together = chains
                .iter_mut()
                .find(|chain| act.cause() != Cause::default() && chain.acts[0].cause() == act.cause());
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

    /// How many records of a component are not left.
    fn overwritten_of(&self, component: &str) -> u64 {
        let counts = self.loops.iter().filter(|counts| counts.component == component);
        let written: u64 = counts.map(super::LoopCounts::records).sum();
        written.saturating_sub(self.of(component).len() as u64)
    }
}

fn is_act(entry: &JournalEntry) -> bool {
    match entry.phase() {
        Phase::Symptom => false,
        Phase::Decision => true,
        Phase::Effect => !entry.change || entry.cause() != Cause::default(),
    }
}

/// The newest values at a time. Of what changed only later, the first change tells what it was before.
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
