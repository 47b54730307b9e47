use std::fmt::Write;
use std::ops::Deref;
use std::sync::{Mutex, PoisonError};

use saoms_api::{Level, Time};
use saoms_core::journal::Journal;
use saoms_core::observe::{Observer, RunEvent};
use saoms_core::report::RunReport;

/// A run that has ended: its report, its journal and its log.
///
/// A run dereferences to its [report](RunReport).
#[derive(Clone, Debug)]
pub struct Run {
    report: RunReport,
    log: Vec<RunEvent>,
}

impl Run {
    pub(crate) fn new(report: RunReport, log: &Log) -> Run {
        Run { report, log: log.take() }
    }

    /// Observations, decisions and actions of the loops.
    pub fn journal(&self) -> &Journal {
        &self.report.journal
    }

    /// Log lines of components, and their other events such as failures, without starts and proper ends. One line for
    /// each: `[1.100 s] Robot7: takes luggage 1 from (3,1) to (3,10)`.
    pub fn log(&self) -> String {
        self.log.iter().fold(String::new(), |mut text, event| {
            let _ = writeln!(text, "{event}");
            text
        })
    }

    /// The lines of one component, by its path, without time and name.
    pub fn log_of(&self, component: &str) -> Vec<String> {
        self.log_lines(component).map(|(_, text)| text).collect()
    }

    /// The same with the time of each.
    pub(crate) fn log_lines(&self, component: &str) -> impl Iterator<Item = (Time, String)> {
        let own = self.log.iter().filter(move |event| event.component.as_deref() == Some(component));
        own.map(|event| (event.time, event.what.to_string()))
    }

    /// The report alone.
    pub fn into_report(self) -> RunReport {
        self.report
    }
}

impl Deref for Run {
    type Target = RunReport;

    fn deref(&self) -> &RunReport {
        &self.report
    }
}

/// An observer that stores the events of a run.
#[derive(Debug, Default)]
pub(crate) struct Log(Mutex<Vec<RunEvent>>);

impl Log {
    pub(crate) fn take(&self) -> Vec<RunEvent> {
        std::mem::take(&mut self.events())
    }

    fn events(&self) -> std::sync::MutexGuard<'_, Vec<RunEvent>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for Log {
    fn event(&self, event: &RunEvent) {
        if event.what.level() <= Level::Info {
            self.events().push(event.clone());
        }
    }
}
