//! A run that has ended, from its report.

use std::collections::BTreeSet;
use std::fmt;

use saoms_api::Time;
use saoms_core::journal::{JournalDocument, JournalEntry, JournalSource, find, read};
use saoms_core::report::Outcome;
use serde::Deserialize;
use serde_json::value::RawValue;
use serde_json::{Value, json};

use super::VERSION;
use super::form::Form;

/// A run that has ended, with what was recorded of it.
#[derive(Clone, Debug)]
pub struct FinishedRun {
    name: String,
    time_s: f64,
    outcome: Outcome,
    recording: Box<RawValue>,
    journal: JournalDocument,
}

/// Why a report cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RunReadError {
    /// It is no report.
    NoReport(String),
    /// It ends in the middle.
    CutOff,
    /// Nothing was recorded.
    NotRecorded,
    /// It was recorded by a program of another version: the version of the recording.
    OtherVersion(u64),
    /// What was recorded is malformed.
    Malformed(String),
}

impl fmt::Display for RunReadError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RunReadError::NoReport(error) => write!(formatter, "it is no report of `saoms run --report`: {error}"),
            RunReadError::CutOff => formatter.write_str("it ends in the middle"),
            RunReadError::NotRecorded => formatter.write_str("it has no recording of the run"),
            RunReadError::OtherVersion(version) => {
                write!(formatter, "its recording has the format {version}, and this program shows the format {VERSION}")
            }
            RunReadError::Malformed(error) => write!(formatter, "its recording is malformed: {error}"),
        }
    }
}

impl std::error::Error for RunReadError {}

/// The fields of a report that are shown.
#[derive(Deserialize)]
struct Report<'a> {
    time_s: f64,
    outcome: Value,
    #[serde(borrow, default)]
    recording: Option<&'a RawValue>,
}

#[derive(Deserialize)]
struct Version {
    version: u64,
}

impl FinishedRun {
    /// The run of a report, as text.
    ///
    /// # Errors
    /// The text is no report, or has no recording that can be shown.
    pub fn read(report: &str) -> Result<FinishedRun, RunReadError> {
        let no_report = |error: &dyn fmt::Display| RunReadError::NoReport(error.to_string());
        if report.trim().is_empty() {
            return Err(no_report(&"it is empty"));
        }
        if !report.trim_start().starts_with('{') {
            return Err(no_report(&"expected an object in JSON"));
        }
        if read(report).is_ok_and(|document| document.source == JournalSource::File) {
            return Err(no_report(&"it is a journal of `saoms run --journal`"));
        }
        let Report { time_s, outcome, recording } =
            serde_json::from_str(report).map_err(|error| match error.is_eof() {
                true => RunReadError::CutOff,
                false => no_report(&error),
            })?;
        let recording = recording.ok_or(RunReadError::NotRecorded)?;
        let malformed = |error: serde_json::Error| RunReadError::Malformed(error.to_string());
        let Version { version } = serde_json::from_str(recording.get()).map_err(malformed)?;
        if version != u64::from(VERSION) {
            return Err(RunReadError::OtherVersion(version));
        }
        let form: Form<'_> = serde_json::from_str(recording.get()).map_err(malformed)?;
        form.judge().map_err(RunReadError::Malformed)?;
        let outcome = serde_json::from_value(outcome).map_err(|error| no_report(&error))?;
        let journal = read(report).map_err(|error| no_report(&error))?;
        Ok(FinishedRun { name: form.name, time_s, outcome, recording: recording.to_owned(), journal })
    }

    /// The same run with the records of another journal of it, which may have more.
    ///
    /// # Errors
    /// It is the journal of another run.
    pub fn with_journal(self, journal: JournalDocument) -> Result<FinishedRun, String> {
        let is_same = |one: &JournalDocument| (one.seed, one.components.iter().map(|one| one.name.clone()).collect());
        let known: (Option<u64>, BTreeSet<String>) = is_same(&self.journal);
        if known != is_same(&journal) {
            return Err("it is the journal of another run: its seed or its components differ".to_owned());
        }
        if journal.end.is_some_and(|end| (end.as_secs_f64() - self.time_s).abs() > 1e-6) {
            return Err("it is the journal of another run: it took another time".to_owned());
        }
        Ok(FinishedRun { journal, ..self })
    }

    /// The name of the fleet.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How long it took.
    pub fn time(&self) -> Time {
        Time::from_nanos((self.time_s * 1e9).round() as u64)
    }

    /// What a page gets of it, with the views that it loads.
    pub(crate) fn json(&self, views: &[Value]) -> String {
        let head =
            json!({"name": self.name, "time_s": self.time_s, "outcome": self.outcome, "views": views}).to_string();
        let head = head.strip_suffix('}').unwrap_or_default();
        format!("{head},\"recording\":{}}}", self.recording.get())
    }

    /// The records of a component, the oldest first.
    ///
    /// # Errors
    /// There is no such component.
    pub(crate) fn records(&self, component: &str) -> Result<Vec<&JournalEntry>, String> {
        let found = find(&self.journal.components, component)?;
        Ok(self.journal.journal.of(&found.name).iter().collect())
    }

    /// Why a component did what it did before a time; `null` where the records for that are missing.
    ///
    /// # Errors
    /// There is no such component.
    pub(crate) fn why(&self, component: &str, at: Option<Time>) -> Result<Value, String> {
        let found = find(&self.journal.components, component)?;
        let at = at.filter(|at| *at <= self.time());
        Ok(json!({"answer": self.journal.journal.why(&found.name, at).ok()}))
    }
}
