use std::fmt;
use std::sync::Arc;

use saoms_api::host::Phase;
use saoms_api::{Cause, Record, Time};
use serde_json::{Map, Value};

use super::RecordValues;

/// A record of the journal: what a component saw, decided or did.
#[derive(Clone, Debug)]
pub struct JournalEntry {
    pub(super) id: Cause,
    pub(super) time: Time,
    pub(super) component: Arc<str>,
    pub(super) loop_name: Option<Arc<str>>,
    pub(super) phase: Phase,
    pub(super) cause: Cause,
    /// True if it records a change of an entry of the knowledge.
    pub(super) change: bool,
    pub(super) what: Content,
}

/// Id, text and values.
#[derive(Clone, Debug)]
pub(super) enum Content {
    /// As written by a component.
    Noted(Record),
    /// As read from a file.
    Read { id: String, text: String, values: Map<String, Value> },
    /// A message from outside, or a notice of the engine.
    Outside { id: &'static str, text: String, values: Map<String, Value> },
}

/// The id of all records of messages from outside.
pub(crate) const FROM_OUTSIDE: &str = "message_from_outside";
/// The id of all records of components that failed and lost what they knew.
pub(crate) const COMPONENT_FAILED: &str = "component_failed";
/// The id of all records of changes of the fleet.
pub(crate) const FLEET_CHANGED: &str = "fleet_changed";

/// A change of what a component knows.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The name of the entry of its knowledge.
    pub entry: String,
    /// Its value before.
    pub before: Value,
    /// Its value from then on.
    pub after: Value,
}

impl JournalEntry {
    /// A symptom from outside the fleet.
    pub(crate) fn from_outside(
        id: Cause,
        time: Time,
        source: &str,
        (record, text, values): (&'static str, String, Map<String, Value>),
        cause: Cause,
    ) -> JournalEntry {
        JournalEntry {
            id,
            time,
            component: Arc::from(source),
            loop_name: None,
            phase: Phase::Symptom,
            cause,
            change: false,
            what: Content::Outside { id: record, text, values },
        }
    }

    /// Its number in the run, from 1, in the order of writing.
    pub fn id(&self) -> Cause {
        self.id
    }

    /// Start time of the execution that wrote it.
    pub fn time(&self) -> Time {
        self.time
    }

    /// The path of the component that wrote it.
    pub fn component(&self) -> &str {
        &self.component
    }

    /// The loop that wrote it; `None` for a component without loops, or outside all of them.
    pub fn loop_name(&self) -> Option<&str> {
        self.loop_name.as_deref()
    }

    /// Phase of the loop: symptom, decision or effect.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The record that it follows from, of this component or of another that sent a message; the default one means
    /// none.
    pub fn cause(&self) -> Cause {
        self.cause
    }

    /// The id of the record, which stays when its text is reworded: as `low_battery`, or the text of a record without
    /// one; of a change of the knowledge the name of the entry.
    pub fn record_id(&self) -> &str {
        match &self.what {
            Content::Noted(record) => record.id(),
            Content::Read { id, .. } => id,
            Content::Outside { id, .. } => id,
        }
    }

    /// The text with the values inserted.
    pub fn text(&self) -> String {
        self.what.to_string()
    }

    /// The text, to be written without a copy.
    pub fn displayed_text(&self) -> impl fmt::Display {
        &self.what
    }

    /// The values by name, to be written without a map.
    pub fn record_values(&self) -> RecordValues<'_> {
        RecordValues(self)
    }

    /// A value of the record by its name.
    pub fn value(&self, name: &str) -> Option<Value> {
        match &self.what {
            Content::Noted(record) => record.values().find(|(known, _)| *known == name).map(|(_, value)| json(value)),
            Content::Read { values, .. } | Content::Outside { values, .. } => values.get(name).cloned(),
        }
    }

    /// True if it is what came from outside the fleet.
    pub(crate) fn is_from_outside(&self) -> bool {
        self.record_id() == FROM_OUTSIDE
    }

    /// True if it is a change of an entry of the knowledge that is yes or no.
    pub(crate) fn is_switch(&self) -> bool {
        self.change
            && match &self.what {
                Content::Noted(record) => {
                    record.values().any(|(name, value)| name == "before" && matches!(value, saoms_api::Value::Bool(_)))
                }
                Content::Read { values, .. } => values.get("before").is_some_and(Value::is_boolean),
                Content::Outside { .. } => false,
            }
    }

    /// All values by name.
    pub fn values(&self) -> Map<String, Value> {
        match &self.what {
            Content::Noted(record) => record.values().map(|(name, value)| (name.to_owned(), json(value))).collect(),
            Content::Read { values, .. } | Content::Outside { values, .. } => values.clone(),
        }
    }

    /// True if it is a change of an entry of the component's knowledge.
    pub fn is_change(&self) -> bool {
        self.change
    }

    /// The change of an entry of the component's knowledge, if the record is one.
    pub fn change(&self) -> Option<Change> {
        let value = |name| self.value(name).unwrap_or_default();
        self.change.then(|| Change {
            entry: self.record_id().to_owned(),
            before: value("before"),
            after: value("after"),
        })
    }
}

/// Records are equal when all fields are equal, wherever they were read from.
impl PartialEq for JournalEntry {
    fn eq(&self, other: &JournalEntry) -> bool {
        (self.id, self.time, self.phase, self.cause, self.change)
            == (other.id, other.time, other.phase, other.cause, other.change)
            && (&self.component, &self.loop_name) == (&other.component, &other.loop_name)
            && self.record_id() == other.record_id()
            && self.text() == other.text()
            && self.values() == other.values()
    }
}

/// Time, component, loop, phase and text, in one line.
impl fmt::Display for JournalEntry {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let JournalEntry { time, component, .. } = self;
        let (by, phase) = (self.loop_name().unwrap_or("-"), self.phase.name());
        write!(formatter, "{time} {component} {by} {phase}: ")?;
        self.what.fmt(formatter)
    }
}

/// The text with the values inserted.
impl fmt::Display for Content {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Content::Noted(record) => record.fmt(formatter),
            Content::Read { text, .. } | Content::Outside { text, .. } => formatter.write_str(text),
        }
    }
}

/// A value as JSON.
pub(super) fn json(value: saoms_api::Value) -> Value {
    match value {
        saoms_api::Value::Nothing => Value::Null,
        saoms_api::Value::Bool(value) => Value::from(value),
        saoms_api::Value::Integer(value) => Value::from(value),
        saoms_api::Value::Number(value) => Value::from(value),
        saoms_api::Value::Pair(x, y) => Value::from([x, y].as_slice()),
        saoms_api::Value::Word(word) => Value::from(word),
        saoms_api::Value::Text(text) => Value::from(text.as_str()),
    }
}
