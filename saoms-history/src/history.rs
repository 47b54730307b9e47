use std::collections::{BTreeSet, HashMap};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use saoms_api::Failure;
use saoms_api::extension::{HistoryRegistration, HistoryTable, RunHistory};
use saoms_api::host::TopicDeclaration;
use saoms_core::journal::ComponentName;
use saoms_core::observe::{
    Beginning, Interest, LostEvents, Observer, Occurrence, Records, RunEvent, SentMessage, WriterEvents,
};
use saoms_core::report::RunReport;
use saoms_core::schedule::{Handle, SharedText};

use crate::HistoryError;
use crate::writer::{Writer, Written, open};

/// The name under which a state folder has that by which histories know it.
const STATE: &str = "history";

/// What a history says of a run beside what the run itself says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HistoryRun {
    /// The name of the first composite.
    pub name: String,
    /// The files of the composites.
    pub composites: Vec<String>,
    /// The node that runs, of a fleet in several programs.
    pub node: Option<String>,
    /// The version of the program.
    pub version: String,
}

/// The observer that writes the history of a run, while it goes on.
///
/// What cannot be written is counted, and the next rows are tried again: a full disk or another program that writes for
/// long does not end the run.
pub struct History {
    path: PathBuf,
    run: HistoryRun,
    keep: Option<Duration>,
    events: Box<dyn WriterEvents>,
    lost: Arc<AtomicU64>,
    /// Locked for moments alone: a thread of the run asks which topics are wanted.
    sources: Mutex<Vec<Source>>,
    state: Mutex<State>,
}

/// The tables of a crate of components, and what gives their rows.
struct Source {
    tables: &'static [HistoryTable],
    history: Box<dyn RunHistory>,
    /// The topics that it wants.
    topics: BTreeSet<String>,
}

/// Component, kind and subject of an alert.
type AlertKey = (Option<Arc<str>>, Arc<str>, Arc<str>);

#[derive(Default)]
struct State {
    writer: Option<Writer>,
    /// The alerts that last, with their numbers.
    alerts: HashMap<AlertKey, i64>,
    raised: i64,
    /// True if the last rows could not be written.
    fails: bool,
    /// Rows whose loss the database does not know of.
    untold: u64,
}

impl History {
    /// The history at a path. The file is tried before the run begins. Records of the journal are removed from it at
    /// the age of `keep`; `None` is never.
    ///
    /// # Errors
    /// The file is no history, or cannot be used.
    pub fn open(
        path: &Path,
        run: HistoryRun,
        keep: Option<Duration>,
        events: Box<dyn WriterEvents>,
    ) -> Result<History, HistoryError> {
        let sources = HistoryRegistration::linked().into_iter();
        let source =
            |one: &HistoryRegistration| Source { tables: one.tables, history: (one.new)(), topics: BTreeSet::new() };
        let sources: Vec<Source> = sources.map(source).collect();
        drop(open(path, &tables(&sources))?);
        let (path, sources) = (path.to_owned(), Mutex::new(sources));
        Ok(History { path, run, keep, events, lost: Arc::default(), sources, state: Mutex::default() })
    }

    /// The number of rows that could not be written.
    pub fn lost(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.lost)
    }

    /// Has the runs of a fleet with a state folder know of each other, once its [store](Handle::use_store) is used:
    /// where this one goes on from that of an earlier program, what both did is that of the later one.
    pub fn outlive(&self, handle: &Handle) {
        let kept = SharedText::default();
        let left = handle.share_text(STATE, &kept).filter(|left| !left.is_empty());
        let from_s = handle.recalled().map(|time| time.as_secs_f64());
        self.write(0, |state| {
            let Some(writer) = &mut state.writer else { return Ok(()) };
            let name = left.map_or_else(|| writer.chance_name(), Ok)?;
            kept.lock().unwrap_or_else(PoisonError::into_inner).clone_from(&name);
            writer.has_state(&name, from_s)?;
            for source in self.sources.lock().unwrap_or_else(PoisonError::into_inner).iter_mut() {
                let Source { tables, history, .. } = source;
                for table in tables.iter().enumerate() {
                    writer.each_earlier(table, |time_s, row| history.goes_on(time_s, row))?;
                }
            }
            Ok(())
        });
    }

    /// Counts what has not even come here.
    fn lack(&self, lost: u64) {
        if lost > 0 {
            self.lost.fetch_add(lost, Ordering::Relaxed);
            self.state.lock().unwrap_or_else(PoisonError::into_inner).untold += lost;
        }
    }

    /// Writes so many rows, or counts them as lost.
    fn write(&self, rows: u64, write: impl FnOnce(&mut State) -> Written) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if state.writer.is_none() {
            return;
        }
        match write(&mut state) {
            Ok(()) => {
                if std::mem::take(&mut state.fails) {
                    state.writer.iter().for_each(|writer| writer.is_patient(true));
                    self.events.works();
                }
                let lost = self.lost.load(Ordering::Relaxed);
                if state.untold > 0 && state.writer.as_mut().is_some_and(|writer| writer.lost(lost).is_ok()) {
                    state.untold = 0;
                }
            }
            Err(error) => {
                self.lost.fetch_add(rows, Ordering::Relaxed);
                state.untold += rows;
                if !std::mem::replace(&mut state.fails, true) {
                    state.writer.iter().for_each(|writer| writer.is_patient(false));
                    let path = self.path.display();
                    self.events.fails(&format!("the history cannot be written to `{path}`: {error}; rows are lost"));
                }
            }
        }
    }
}

fn tables(sources: &[Source]) -> Vec<&'static HistoryTable> {
    sources.iter().flat_map(|source| source.tables).collect()
}

fn components(components: &[ComponentName]) -> impl Iterator<Item = (&str, Option<&str>, Option<f64>)> {
    components.iter().map(|one| (&*one.name, one.id.as_deref(), one.period_us.map(|period| period as f64 / 1e6)))
}

impl fmt::Debug for History {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("History").field(&self.path).finish()
    }
}

impl Observer for History {
    fn interest(&self) -> Interest {
        Interest { journal: true, ..Interest::NONE }
    }

    fn begin(&self, beginning: &Beginning<'_>) -> Result<(), Failure> {
        let tables = tables(&self.sources.lock().unwrap_or_else(PoisonError::into_inner));
        let connection = open(&self.path, &tables).map_err(|error| Failure::new(error.to_string()))?;
        let clock = if beginning.is_virtual { "virtual" } else { "real" };
        let writer = Writer::begin(connection, &tables, (&self.run, self.keep), (clock, beginning.seed)).and_then(
            |mut writer| {
                writer.components(components(beginning.components))?;
                Ok(writer)
            },
        );
        let writer = writer.map_err(|error| {
            Failure::new(format!("the history `{}` cannot be written: {error}", self.path.display()))
        })?;
        self.state.lock().unwrap_or_else(PoisonError::into_inner).writer = Some(writer);
        Ok(())
    }

    fn event(&self, event: &RunEvent) {
        let Occurrence::Alert { kind, subject, text } = &event.what else { return };
        let time = event.time.as_secs_f64();
        self.write(1, |state| {
            let State { writer: Some(writer), alerts, raised, .. } = state else { return Ok(()) };
            let key = (event.component.clone(), Arc::clone(kind), Arc::clone(subject));
            match text {
                Some(text) => {
                    let known = alerts.get(&key).copied();
                    let number = known.unwrap_or(*raised + 1);
                    let about = (&**kind, event.component.as_deref(), &**subject);
                    writer.alert((number, known.is_none()), about, text, time)?;
                    // One whose row was lost has its row once it is raised again.
                    alerts.insert(key, number);
                    *raised = number.max(*raised);
                    Ok(())
                }
                None => alerts.remove(&key).map_or(Ok(()), |number| writer.alert_over(number, time)),
            }
        });
    }

    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        let mut is_wanted = false;
        for source in self.sources.lock().unwrap_or_else(PoisonError::into_inner).iter_mut() {
            if source.history.wants_topic(name, declared) {
                is_wanted = true;
                source.topics.insert(name.to_owned());
            }
        }
        is_wanted
    }

    fn message(&self, sent: &SentMessage) {
        let SentMessage { topic, component, message, .. } = sent;
        let time = message.header().sent.as_secs_f64();
        let mut new = Vec::new();
        for source in self.sources.lock().unwrap_or_else(PoisonError::into_inner).iter_mut() {
            if source.topics.contains(&**topic) {
                let rows = source.history.message(topic, component, message);
                if !rows.is_empty() {
                    new.push((source.tables, rows));
                }
            }
        }
        for (tables, rows) in new {
            self.write(rows.len() as u64, |state| {
                state.writer.as_mut().map_or(Ok(()), |writer| writer.rows(tables, time, &rows))
            });
        }
    }

    fn lost(&self, lost: LostEvents) {
        // Not each message is a row, but nobody knows which of these would have been.
        self.lack(lost.alerts + lost.messages);
    }

    fn records(&self, records: &Records<'_>) -> Result<(), Failure> {
        self.lack(records.lost);
        let rows = (records.entries.len() + records.joined.len()) as u64;
        self.write(rows, |state| {
            let Some(writer) = &mut state.writer else { return Ok(()) };
            if !records.joined.is_empty() {
                writer.components(components(records.joined))?;
            }
            if records.entries.is_empty() { Ok(()) } else { writer.records(records.entries) }
        });
        Ok(())
    }

    fn end(&self, report: &RunReport) {
        self.write(1, |state| state.writer.as_mut().map_or(Ok(()), |writer| writer.end(report)));
        // The last connection that is closed leaves one file.
        self.state.lock().unwrap_or_else(PoisonError::into_inner).writer = None;
    }
}
