//! The journal as JSON: a section of a report, and the lines of a file. Both hold a record in the same form.

use std::fmt;
use std::sync::Arc;

use saoms_api::host::Phase;
use saoms_api::{Cause, Time};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::value::{RawValue, to_raw_value};
use serde_json::{Map, Value};

use super::entry::Content;
use super::{Journal, JournalEntry, LoopCounts, node_of};

/// A record as it is written; fields without a value are left out.
#[derive(Serialize)]
struct Line<'a> {
    id: u64,
    time_s: f64,
    component: &'a str,
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none")]
    loop_name: Option<&'a str>,
    phase: &'static str,
    /// The id of the record, unless it is a change.
    #[serde(skip_serializing_if = "Option::is_none")]
    record: Option<&'a str>,
    /// The entry of the knowledge that changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    entry: Option<&'a str>,
    #[serde(serialize_with = "as_text")]
    text: &'a Content,
    #[serde(skip_serializing_if = "RecordValues::is_empty")]
    values: RecordValues<'a>,
    #[serde(skip_serializing_if = "is_none")]
    cause: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_none(cause: &u64) -> bool {
    *cause == 0
}

fn as_text<S: Serializer>(text: &&Content, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(text)
}

/// The values of a record as a JSON object, sorted by name. A change has not the name of its entry among them, which is
/// its id.
pub struct RecordValues<'a>(pub(super) &'a JournalEntry);

impl RecordValues<'_> {
    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        match &self.0.what {
            Content::Noted(record) => record.values().all(|(name, _)| self.leaves_out(name)),
            Content::Read { values, .. } | Content::Outside { values, .. } => {
                values.keys().all(|name| self.leaves_out(name))
            }
        }
    }

    fn leaves_out(&self, name: &str) -> bool {
        self.0.change && name == "entry"
    }
}

impl Serialize for RecordValues<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0.what {
            Content::Noted(record) => {
                let mut values: Vec<_> = record.values().filter(|(name, _)| !self.leaves_out(name)).collect();
                values.sort_unstable_by_key(|(name, _)| *name);
                serializer.collect_map(values.into_iter().map(|(name, value)| (name, Json(value))))
            }
            Content::Read { values, .. } | Content::Outside { values, .. } => {
                serializer.collect_map(values.iter().filter(|(name, _)| !self.leaves_out(name)))
            }
        }
    }
}

/// A value of a record.
struct Json(saoms_api::Value);

impl Serialize for Json {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0 {
            saoms_api::Value::Nothing => serializer.serialize_unit(),
            saoms_api::Value::Bool(value) => serializer.serialize_bool(*value),
            saoms_api::Value::Integer(value) => serializer.serialize_i64(*value),
            saoms_api::Value::Number(value) => serializer.serialize_f64(*value),
            saoms_api::Value::Pair(x, y) => serializer.collect_seq([x, y]),
            saoms_api::Value::Word(word) => serializer.serialize_str(word),
            saoms_api::Value::Text(text) => serializer.serialize_str(text.as_str()),
        }
    }
}

impl Serialize for JournalEntry {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let line = Line {
            id: self.id.0,
            time_s: self.time.as_secs_f64(),
            component: &self.component,
            loop_name: self.loop_name(),
            phase: self.phase.name(),
            record: (!self.change).then(|| self.record_id()),
            entry: self.change.then(|| self.record_id()),
            text: &self.what,
            values: RecordValues(self),
            cause: self.cause.0,
        };
        line.serialize(serializer)
    }
}

/// A record as it is read.
#[derive(Deserialize)]
struct ReadLine {
    id: u64,
    time_s: f64,
    component: String,
    #[serde(rename = "loop", default)]
    loop_name: Option<String>,
    phase: PhaseName,
    /// Absent in journals of earlier versions.
    #[serde(default)]
    record: Option<String>,
    #[serde(default)]
    entry: Option<String>,
    text: String,
    #[serde(default)]
    values: Map<String, Value>,
    #[serde(default)]
    cause: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum PhaseName {
    Symptom,
    Decision,
    Effect,
}

impl<'de> Deserialize<'de> for JournalEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<JournalEntry, D::Error> {
        let mut line = ReadLine::deserialize(deserializer)?;
        let ReadLine { id, cause, .. } = line;
        if cause >= id && node_of(Cause(cause)).is_none() {
            let wrong = Wrong(format!("record {id} cannot follow from record {cause}: causes are older"));
            return Err(D::Error::custom(wrong));
        }
        let change = line.entry.is_some();
        let record_id = line.entry.clone().or(line.record).unwrap_or_else(|| line.text.clone());
        line.values.extend(line.entry.map(|entry| ("entry".to_owned(), Value::from(entry))));
        Ok(JournalEntry {
            id: Cause(id),
            time: time(line.time_s).map_err(D::Error::custom)?,
            component: Arc::from(line.component),
            loop_name: line.loop_name.map(Arc::from),
            phase: match line.phase {
                PhaseName::Symptom => Phase::Symptom,
                PhaseName::Decision => Phase::Decision,
                PhaseName::Effect => Phase::Effect,
            },
            cause: Cause(cause),
            change,
            what: Content::Read { id: record_id, text: line.text, values: line.values },
        })
    }
}

/// Error in the content of a journal that is valid JSON.
#[derive(Debug)]
pub(super) struct Wrong(String);

impl fmt::Display for Wrong {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

/// A time of the run from seconds.
pub(super) fn time(seconds: f64) -> Result<Time, Wrong> {
    let nanos = (seconds * 1e9).round();
    if !(0.0..u64::MAX as f64).contains(&nanos) {
        return Err(Wrong(format!("`{seconds}` is not a time in seconds")));
    }
    Ok(Time::from_nanos(nanos as u64))
}

/// Sorts records by number and checks them.
pub(super) fn in_order(mut entries: Vec<JournalEntry>) -> Result<Vec<JournalEntry>, Wrong> {
    entries.sort_by_key(JournalEntry::id);
    match entries.windows(2).find(|pair| pair[0].id == pair[1].id) {
        Some(pair) => Err(Wrong(format!("there are two records with the number {}", pair[0].id.0))),
        None => Ok(entries),
    }
}

#[derive(Serialize, Deserialize)]
#[serde(bound(deserialize = "L: Deserialize<'de>, E: Deserialize<'de>"))]
struct Section<L, E> {
    records: u64,
    #[serde(default)]
    overwritten: u64,
    #[serde(default)]
    lost: u64,
    #[serde(default = "Vec::new")]
    loops: Vec<L>,
    entries: Vec<E>,
}

impl Serialize for Journal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Journal { records, overwritten, lost, .. } = *self;
        let (loops, entries) = (in_lines(&self.loops)?, in_lines(&self.entries)?);
        Section { records, overwritten, lost, loops, entries }.serialize(serializer)
    }
}

/// Writes each value on one line, even in indented JSON.
pub(crate) fn in_lines<T: Serialize, E: serde::ser::Error>(values: &[T]) -> Result<Vec<Box<RawValue>>, E> {
    values.iter().map(|value| to_raw_value(value).map_err(E::custom)).collect()
}

impl<'de> Deserialize<'de> for Journal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Journal, D::Error> {
        let Section::<LoopCounts, JournalEntry> { records, overwritten, lost, loops, entries } =
            Section::deserialize(deserializer)?;
        let entries = in_order(entries).map_err(D::Error::custom)?;
        Ok(Journal { records, overwritten, lost, loops, entries })
    }
}
