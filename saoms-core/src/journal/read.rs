use std::fmt;

use saoms_api::Time;
use saoms_lang::assembly::ComponentSpec;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::json::{in_order, time};
use super::{Journal, JournalEntry, LoopCounts};

/// A component of the fleet, as journals name it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ComponentName {
    /// Its path in the composite.
    pub name: String,
    /// Its `ID`; a passive component has none.
    #[serde(default)]
    pub id: Option<String>,
}

impl ComponentName {
    pub(crate) fn of(spec: &ComponentSpec) -> ComponentName {
        ComponentName { name: spec.path.clone(), id: spec.task.as_ref().map(|task| task.id.clone()) }
    }
}

/// The journal of a run as read from a file: a report that `saoms run --report` wrote, or the lines of `--journal`.
#[derive(Clone, Debug, PartialEq)]
pub struct JournalDocument {
    /// The records.
    pub journal: Journal,
    /// The seed of the run; `None` where the file does not tell.
    pub seed: Option<u64>,
    /// The components of the fleet, in document order.
    pub components: Vec<ComponentName>,
    /// End of the run; `None` if the run has not ended or was killed.
    pub end: Option<Time>,
    /// True if the file is a report, which holds only the newest records.
    pub is_report: bool,
}

/// A fault of a file that is no journal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JournalReadError {
    /// A part of it is malformed.
    Malformed {
        /// The line, from 1.
        line: usize,
        /// The column, from 1; 0 is the line as a whole.
        column: usize,
        /// Found and expected content.
        message: String,
    },
    /// It is no JSON object at all.
    Other,
    /// It is a report, but holds no journal.
    NoJournal,
}

impl fmt::Display for JournalReadError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            JournalReadError::Malformed { line, column: 0, message } => {
                write!(formatter, "line {line}: {message}")
            }
            JournalReadError::Malformed { line, column, message } => {
                write!(formatter, "line {line}, column {column}: {message}")
            }
            JournalReadError::Other => formatter
                .write_str("this is neither a report of `saoms run --report` nor a file of `saoms run --journal`"),
            JournalReadError::NoJournal => formatter.write_str("this report contains no journal"),
        }
    }
}

impl std::error::Error for JournalReadError {}

/// The fields of a report that are read.
#[derive(Deserialize)]
struct Report {
    #[serde(default)]
    seed: Option<u64>,
    time_s: f64,
    components: Vec<ComponentName>,
    journal: Option<Journal>,
}

/// The first line of the file of a journal.
#[derive(Deserialize)]
struct Head {
    /// Version of the format.
    journal: u32,
    #[serde(default)]
    seed: Option<u64>,
    components: Vec<ComponentName>,
}

/// A line about a component that joined the running fleet.
#[derive(Deserialize)]
struct Joined {
    joined: ComponentName,
}

/// The last line.
#[derive(Deserialize)]
struct EndLine {
    end: End,
}

#[derive(Deserialize)]
struct End {
    time_s: f64,
    lost: u64,
}

/// Reads a report or the file of a journal.
///
/// # Errors
/// The text is neither, or is malformed.
pub fn read(text: &str) -> Result<JournalDocument, JournalReadError> {
    if !text.trim_start().starts_with('{') {
        return Err(JournalReadError::Other);
    }
    let first = text.lines().next().unwrap_or_default();
    match serde_json::from_str::<Value>(first) {
        Ok(value) if value.get("journal").is_some_and(Value::is_u64) => lines(text),
        _ => report(text),
    }
}

fn report(text: &str) -> Result<JournalDocument, JournalReadError> {
    let report: Report = serde_json::from_str(text).map_err(|error| malformed(0, &error, REPORT))?;
    let journal = report.journal.ok_or(JournalReadError::NoJournal)?;
    let end = time(report.time_s).map_err(|wrong| incomplete(1, wrong.to_string()))?;
    Ok(JournalDocument { journal, seed: report.seed, components: report.components, end: Some(end), is_report: true })
}

const REPORT: &str = "this is neither a complete report of `saoms run --report` nor a file of `saoms run --journal`";

fn lines(text: &str) -> Result<JournalDocument, JournalReadError> {
    let mut lines = text.lines().enumerate().peekable();
    let head = lines.next().map_or("", |(_, line)| line);
    let mut head: Head = serde_json::from_str(head).map_err(|error| malformed(0, &error, REPORT))?;
    if head.journal != 1 {
        let message = format!("this file has the format {}, which a newer version of the program writes", head.journal);
        return Err(incomplete(1, message));
    }
    let (mut entries, mut end) = (Vec::new(), None);
    while let Some((number, line)) = lines.next() {
        if line.trim().is_empty() {
            continue;
        }
        let (read, what) = if line.starts_with("{\"end\"") {
            let last = serde_json::from_str(line).map(|EndLine { end: last }| end = Some(last));
            (last, "the end of the journal is malformed")
        } else if line.starts_with("{\"joined\"") {
            let joined = serde_json::from_str(line).map(|Joined { joined }| head.components.push(joined));
            (joined, "this is not a component of a journal")
        } else {
            (serde_json::from_str(line).map(|entry| entries.push(entry)), "this is not a record of a journal")
        };
        match read {
            // A run that has not ended, or was killed, may have written a part of its last line.
            Err(error) if error.is_eof() && lines.peek().is_none() && !text.ends_with('\n') => {}
            read => read.map_err(|error| malformed(number, &error, what))?,
        }
    }
    let entries = in_order(entries).map_err(|wrong| incomplete(1, wrong.to_string()))?;
    let newest = entries.last().map_or(0, |entry: &JournalEntry| entry.id().0);
    let lost = newest - entries.len() as u64;
    let journal = Journal {
        records: newest.max(entries.len() as u64),
        overwritten: 0,
        lost: end.as_ref().map_or(lost, |end| end.lost),
        loops: LoopCounts::of(&entries),
        entries,
    };
    let end = end.map(|end| time(end.time_s)).transpose().map_err(|wrong| incomplete(1, wrong.to_string()))?;
    Ok(JournalDocument { journal, seed: head.seed, components: head.components, end, is_report: false })
}

/// An error of the JSON parser, with its place in the whole text.
fn malformed(lines_before: usize, error: &serde_json::Error, about: &str) -> JournalReadError {
    let text = error.to_string();
    let what = text.rfind(" at line ").map_or(text.as_str(), |end| &text[..end]);
    let line = lines_before + error.line().max(1);
    JournalReadError::Malformed { line, column: error.column(), message: format!("{about}: {what}") }
}

fn incomplete(line: usize, message: String) -> JournalReadError {
    JournalReadError::Malformed { line, column: 0, message }
}
