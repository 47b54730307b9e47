//! The observer that writes the log to a file.

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use saoms_control::AlertList;
use saoms_core::observe::{Interest, Observer, Occurrence, RotatingFile, RunEvent};
use saoms_core::report::RunReport;

use super::log_lines::LogStyle;
use crate::output::{counted, displayed, eprint};

/// Kind and subject of the alert about the file.
const FILE: &str = "file";
const LOG: &str = "log";

/// The file of the log. A line that cannot be written is counted, and the next one tried again.
pub(super) struct LogFile {
    path: PathBuf,
    style: LogStyle,
    file: Mutex<RotatingFile>,
    lost: Arc<AtomicU64>,
    /// True if it was told that the file cannot be moved aside.
    stays: AtomicBool,
    /// True if the last line could not be written.
    fails: AtomicBool,
    /// What is told of that.
    alerts: Arc<AlertList>,
}

impl LogFile {
    pub(super) fn new(path: PathBuf, file: RotatingFile, style: LogStyle) -> LogFile {
        LogFile {
            path,
            style,
            file: Mutex::new(file),
            lost: Arc::default(),
            stays: AtomicBool::new(false),
            fails: AtomicBool::new(false),
            alerts: Arc::default(),
        }
    }

    /// The same observer, which raises an alert while lines cannot be written.
    pub(super) fn with_alerts(self, alerts: &Arc<AlertList>) -> LogFile {
        LogFile { alerts: Arc::clone(alerts), ..self }
    }

    /// The number of lines that could not be written.
    pub(super) fn lost(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.lost)
    }

    fn write(&self, line: &str) {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        if file.is_full(0, line.len())
            && let Err(error) = file.rotate()
            && !self.stays.swap(true, Ordering::Relaxed)
        {
            self.tell("rotated", &error, "its file keeps growing");
        }
        match file.write(line.as_bytes()) {
            Ok(()) => {
                if self.fails.swap(false, Ordering::Relaxed) {
                    self.alerts.over(FILE, LOG);
                }
            }
            Err(error) => {
                if self.lost.fetch_add(1, Ordering::Relaxed) == 0 {
                    self.tell("written", &error, "lines are lost; the run reports their number");
                }
                if !self.fails.swap(true, Ordering::Relaxed) {
                    let path = self.path.display();
                    self.alerts.raise(FILE, LOG, format!("the log cannot be written at `{path}`: {error}"));
                }
            }
        }
    }

    /// Tells a failure on standard error.
    fn tell(&self, what: &str, error: &io::Error, then: &str) {
        eprint(&format!("error: the log could not be {what} at `{}`: {error}; {then}\n", displayed(&self.path)));
    }
}

impl Observer for LogFile {
    fn interest(&self) -> Interest {
        Interest { log: Some(self.style.level), ..Interest::NONE }
    }

    fn event(&self, event: &RunEvent) {
        if !matches!(event.what, Occurrence::Console { .. }) && event.what.level() <= self.style.level {
            self.write(&self.style.line(event));
        }
    }

    fn end(&self, report: &RunReport) {
        self.write(&self.style.end(report));
        let lost = self.lost.load(Ordering::Relaxed);
        if lost > 0 {
            let lines = counted(usize::try_from(lost).unwrap_or(usize::MAX), "line");
            eprint(&format!("error: {lines} could not be written to the log `{}`\n", displayed(&self.path)));
        }
    }
}
