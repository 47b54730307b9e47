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
    /// Its period in microseconds; a passive component has none, nor has any in journals of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_us: Option<u64>,
}

impl ComponentName {
    pub(crate) fn of(spec: &ComponentSpec) -> ComponentName {
        let task = spec.task.as_ref();
        ComponentName {
            name: spec.path.clone(),
            id: task.map(|task| task.id.clone()),
            period_us: task.map(|task| u64::try_from(task.period.as_micros()).unwrap_or(u64::MAX)),
        }
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
    /// Where it comes from.
    pub source: JournalSource,
    /// The nodes of the fleet, by name, whose components records can follow from; none where the file does not tell.
    pub nodes: Vec<String>,
}

/// Where a journal comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JournalSource {
    /// A report, which holds only the newest records.
    Report,
    /// The file of `--journal`.
    File,
    /// A running fleet, which holds only the newest records, and goes on.
    Running,
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
    #[serde(default)]
    part: Option<NamedNodes>,
}

/// The field of a part of a fleet that is read.
#[derive(Deserialize)]
struct NamedNodes {
    nodes: Vec<String>,
}

/// The first line of the file of a journal.
#[derive(Deserialize)]
struct Head {
    /// Version of the format.
    journal: u32,
    #[serde(default)]
    seed: Option<u64>,
    components: Vec<ComponentName>,
    #[serde(default)]
    part: Option<JournalPart>,
}

/// What the first line of a part of a journal says.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
pub struct JournalPart {
    /// The run that it is a part of.
    pub run: String,
    /// Its number, from 0.
    pub number: u32,
    /// Number of the records before it, and of those of them that were lost.
    records: u64,
    lost: u64,
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
    Ok(JournalDocument {
        journal,
        seed: report.seed,
        components: report.components,
        end: Some(end),
        source: JournalSource::Report,
        nodes: report.part.map(|part| part.nodes).unwrap_or_default(),
    })
}

const REPORT: &str = "this is neither a complete report of `saoms run --report` nor a file of `saoms run --journal`";

fn lines(text: &str) -> Result<JournalDocument, JournalReadError> {
    read_parts(&[text]).map_err(|(_, error)| error)
}

/// The part of a journal that a text is, if its file was one that is moved aside.
pub fn part(text: &str) -> Option<JournalPart> {
    serde_json::from_str::<Head>(text.lines().next()?).ok()?.part
}

/// Reads following parts of a journal, the oldest first.
///
/// # Errors
/// One of them is no such part, or malformed: its place in the list, and what is wrong.
pub fn read_parts(parts: &[&str]) -> Result<JournalDocument, (usize, JournalReadError)> {
    let mut all = Lines::default();
    let mut before = None;
    for (place, text) in parts.iter().enumerate() {
        let head = all.read(text).map_err(|error| (place, error))?;
        // Each part names all components so far.
        (all.seed, all.components) = (head.seed, head.components.into_iter().chain(all.joined.drain(..)).collect());
        before.get_or_insert(head.part);
    }
    let wrong = |error: JournalReadError| (parts.len().saturating_sub(1), error);
    let entries = in_order(all.entries).map_err(|error| wrong(incomplete(1, error.to_string())))?;
    let newest = entries.last().map_or(0, |entry: &JournalEntry| entry.id().0);
    let JournalPart { records: earlier, lost: lost_earlier, .. } = before.flatten().unwrap_or_default();
    let lost = lost_earlier + newest.saturating_sub(earlier + entries.len() as u64);
    let journal = Journal {
        records: newest.max(entries.len() as u64),
        overwritten: earlier.saturating_sub(lost_earlier),
        lost: all.end.as_ref().map_or(lost, |end| end.lost),
        loops: LoopCounts::of(&entries),
        entries,
    };
    let end = all.end.map(|end| time(end.time_s)).transpose();
    let end = end.map_err(|error| wrong(incomplete(1, error.to_string())))?;
    Ok(JournalDocument {
        journal,
        seed: all.seed,
        components: all.components,
        end,
        source: JournalSource::File,
        nodes: Vec::new(),
    })
}

/// What the lines of a journal hold.
#[derive(Default)]
struct Lines {
    seed: Option<u64>,
    components: Vec<ComponentName>,
    /// Components that joined since the last head.
    joined: Vec<ComponentName>,
    entries: Vec<JournalEntry>,
    end: Option<End>,
}

impl Lines {
    /// Adds the lines of a part, and gives its head.
    fn read(&mut self, text: &str) -> Result<Head, JournalReadError> {
        let mut lines = text.lines().enumerate().peekable();
        let head = lines.next().map_or("", |(_, line)| line);
        let head: Head = serde_json::from_str(head).map_err(|error| malformed(0, &error, REPORT))?;
        if head.journal != 1 {
            let message =
                format!("this file has the format {}, which a newer version of the program writes", head.journal);
            return Err(incomplete(1, message));
        }
        while let Some((number, line)) = lines.next() {
            if line.trim().is_empty() {
                continue;
            }
            let (read, what) = if line.starts_with("{\"end\"") {
                let last = serde_json::from_str(line).map(|EndLine { end }| self.end = Some(end));
                (last, "the end of the journal is malformed")
            } else if line.starts_with("{\"joined\"") {
                let joined = serde_json::from_str(line).map(|Joined { joined }| self.joined.push(joined));
                (joined, "this is not a component of a journal")
            } else {
                (serde_json::from_str(line).map(|entry| self.entries.push(entry)), "this is not a record of a journal")
            };
            match read {
                // A run that has not ended, or was killed, may have written a part of its last line.
                Err(error) if error.is_eof() && lines.peek().is_none() && !text.ends_with('\n') => {}
                read => read.map_err(|error| malformed(number, &error, what))?,
            }
        }
        Ok(head)
    }
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
