use std::collections::VecDeque;
use std::time::Duration;

use rusqlite::{Connection, params};
use saoms_core::journal::JournalEntry;

/// Removes records of the journal that are older than a time, a few at once. What they took in the file is used for new
/// ones.
#[derive(Debug)]
pub(crate) struct Retention {
    keep_s: f64,
    /// Records of the present run with their times, one for each step of time.
    marks: VecDeque<(f64, i64)>,
}

/// Number of steps in the time that is kept.
const STEPS: f64 = 100.0;

/// Number of records of earlier runs that are removed in one step.
const AT_ONCE: i64 = 50_000;

/// Records of runs that ended before a time, or were killed. `CROSS JOIN` has SQLite find the runs first: no record is
/// older than the begin of its run, so that it looks at records of runs alone that may have old ones.
pub(crate) const OF_EARLIER_RUNS: &str = "DELETE FROM records WHERE (run, id) IN ( \
    SELECT t.run, t.id FROM runs r CROSS JOIN records t ON t.run = r.run \
    WHERE r.run <> ?1 AND julianday(coalesce(ended, began)) < julianday('now') - ?2 / 86400.0 \
    AND (ended IS NOT NULL OR julianday(began) + t.time_s / 86400.0 < julianday('now') - ?2 / 86400.0) LIMIT ?3)";

impl Retention {
    pub(crate) fn of(keep: Duration) -> Retention {
        Retention { keep_s: keep.as_secs_f64(), marks: VecDeque::new() }
    }

    /// Notes the next records of a run, and removes those that are too old by their time.
    pub(crate) fn remove(&mut self, connection: &Connection, run: i64, next: &[JournalEntry]) -> rusqlite::Result<()> {
        let known = self.marks.len();
        for entry in next {
            let time = entry.time().as_secs_f64();
            if self.marks.back().is_none_or(|(last, _)| time - last >= self.keep_s / STEPS) {
                self.marks.push_back((time, i64::try_from(entry.id().0).unwrap_or(i64::MAX)));
            }
        }
        let (Some(last), true) = (next.last(), self.marks.len() > known) else { return Ok(()) };
        connection.prepare_cached(OF_EARLIER_RUNS)?.execute(params![run, self.keep_s, AT_ONCE])?;
        let now = last.time().as_secs_f64();
        let mut old = None;
        while let Some((_, id)) = self.marks.front().filter(|(time, _)| now - time > self.keep_s) {
            old = Some(*id);
            self.marks.pop_front();
        }
        if let Some(id) = old {
            connection.prepare_cached("DELETE FROM records WHERE run = ? AND id < ?")?.execute(params![run, id])?;
        }
        Ok(())
    }
}
