//! The newest lines of a fleet's log, for clients.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use saoms_api::Level;
use saoms_core::observe::{Interest, Observer, Occurrence, RunEvent};
use serde::{Deserialize, Serialize};
use tokio::sync::broadcast;

use crate::date::date;

/// Number of lines that are kept, and number of lines that may wait for a client.
const KEPT: usize = 1000;

/// A line of the log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogLine {
    /// Time of the run in seconds.
    pub time_s: f64,
    /// Time of day in UTC, as `2026-11-26T18:37:00.123Z`.
    pub date: String,
    /// `error`, `warning`, `info` or `debug`.
    pub level: String,
    /// The component that it is about; `null` is the fleet as a whole.
    pub component: Option<String>,
    /// The line.
    pub text: String,
}

impl LogLine {
    /// The line about an event that happens now.
    pub fn of(event: &RunEvent) -> LogLine {
        LogLine {
            time_s: event.time.as_secs_f64(),
            date: date(SystemTime::now()),
            level: level_name(event.what.level()).to_owned(),
            component: event.component.as_deref().map(str::to_owned),
            text: event.what.to_string(),
        }
    }
}

/// An observer that keeps the newest lines of the log, and passes new ones to clients. A client that is slower than the
/// log loses lines, and is told how many.
#[derive(Debug)]
pub struct LogTail {
    lines: Mutex<VecDeque<Arc<LogLine>>>,
    new: broadcast::Sender<Arc<LogLine>>,
}

impl Default for LogTail {
    fn default() -> LogTail {
        LogTail { lines: Mutex::default(), new: broadcast::Sender::new(KEPT) }
    }
}

impl LogTail {
    fn lock(&self) -> MutexGuard<'_, VecDeque<Arc<LogLine>>> {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// True if a client waits for further lines.
    pub(crate) fn is_followed(&self) -> bool {
        self.new.receiver_count() > 0
    }

    /// The newest lines, at most so many, and what follows them.
    pub(crate) fn follow(&self, most: usize) -> (Vec<Arc<LogLine>>, broadcast::Receiver<Arc<LogLine>>) {
        let lines = self.lock();
        let skipped = lines.len().saturating_sub(most);
        (lines.iter().skip(skipped).cloned().collect(), self.new.subscribe())
    }
}

impl Observer for LogTail {
    fn interest(&self) -> Interest {
        Interest { log: Some(Level::Info), ..Interest::NONE }
    }

    fn event(&self, event: &RunEvent) {
        if matches!(event.what, Occurrence::Console { .. }) || event.what.level() > Level::Info {
            return;
        }
        let line = Arc::new(LogLine::of(event));
        let mut lines = self.lock();
        if lines.len() == KEPT {
            lines.pop_front();
        }
        lines.push_back(Arc::clone(&line));
        // Under the lock, so that each follower gets each line once. Nobody may follow.
        let _ = self.new.send(line);
    }
}

fn level_name(level: Level) -> &'static str {
    match level {
        Level::Error => "error",
        Level::Warning => "warning",
        Level::Info => "info",
        Level::Debug => "debug",
    }
}
