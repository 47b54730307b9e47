//! Alerts of a fleet: what needs a person, in one list, until somebody acknowledges it or it is over.

mod command;
mod delivery;
mod kept;
mod list;
#[cfg(test)]
mod tests;
mod webhook;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

use saoms_api::Level;
use saoms_core::observe::{Interest, Observer, Occurrence, RunEvent};
use saoms_core::schedule::{Handle, SharedText};
use serde_json::json;
use tokio::sync::broadcast;

pub use delivery::AlertTarget;
use delivery::Targets;
pub use list::{Acknowledgement, Alert};
use list::{List, Subject};

use crate::date::date;

/// Number of changes that may wait for a client.
const WAITING: usize = 256;

/// Kinds of alerts that need no word of a component.
const FAILED: &str = "failed";
const HANGS: &str = "hangs";
const ABANDONED: &str = "abandoned";
const NOT_STOPPED: &str = "not_stopped";

/// An observer that keeps the alerts, tells clients of changes, and has them delivered to the targets of the composite.
#[derive(Debug)]
pub struct AlertList {
    list: Mutex<List>,
    targets: Mutex<Targets>,
    new: broadcast::Sender<Arc<str>>,
    /// What outlives the program.
    kept: SharedText,
}

impl Default for AlertList {
    fn default() -> AlertList {
        let new = broadcast::Sender::new(WAITING);
        AlertList { list: Mutex::default(), targets: Mutex::default(), new, kept: SharedText::default() }
    }
}

/// What happened to an alert.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Raised,
    /// It has another text.
    Changed,
    Over,
    Acknowledged,
}

impl Change {
    fn name(self) -> &'static str {
        match self {
            Change::Raised => "raised",
            Change::Changed => "changed",
            Change::Over => "over",
            Change::Acknowledged => "acknowledged",
        }
    }
}

/// Numbers of alerts, for metrics.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct AlertCounts {
    /// By kind: those that wait, those that are acknowledged and not over, and all that were raised.
    pub(crate) kinds: Vec<(String, [u64; 3])>,
    /// Changes that were not delivered, once for each target.
    pub(crate) undelivered: u64,
}

impl AlertList {
    fn lock(&self) -> MutexGuard<'_, List> {
        self.list.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn targets(&self) -> MutexGuard<'_, Targets> {
        self.targets.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Has each alert delivered from now on that is raised, over or acknowledged, by threads of their own. `started` is
    /// the start of the run in seconds since 1970; `note` writes to the log of the fleet what fails.
    pub fn deliver<N>(&self, fleet: &str, started: u64, targets: Vec<AlertTarget>, note: &N)
    where
        N: Fn(Level, String) + Clone + Send + 'static,
    {
        self.targets().start(fleet, started, targets, note);
    }

    /// Ends the delivery: what waits is tried once, for this time at most. Gives the number of changes that were not
    /// delivered in the whole run.
    pub fn finish(&self, patience: Duration) -> u64 {
        let targets = std::mem::take(&mut *self.targets());
        targets.finish(patience)
    }

    /// Has acknowledgements outlive the program: what an earlier one left counts for the alerts that are raised again
    /// at the time at which this one goes on.
    pub fn outlive(&self, handle: &Handle) {
        let left = handle.share_text("acknowledged alerts", &self.kept);
        let mut list = self.lock();
        list.noted = left.map(|left| kept::read(&left)).unwrap_or_default();
        list.goes_on_at_s = handle.progress().time.as_secs_f64();
        list.last_time_s = list.goes_on_at_s;
        // This program may end before it has raised them again.
        self.keep(&list);
    }

    /// Says that a person is needed for something of this program, not of a component.
    pub fn raise(&self, kind: &str, subject: &str, text: String) {
        let at = self.lock().last_time_s;
        self.raise_at(at, Subject::new(None, kind, subject), text);
    }

    /// Says that an alert of [`raise`](AlertList::raise) is over.
    pub fn over(&self, kind: &str, subject: &str) {
        let at = self.lock().last_time_s;
        self.over_at(at, |one| one.component.is_none() && one.kind == kind && one.subject == subject);
    }

    fn raise_at(&self, time_s: f64, subject: Subject<'_>, text: String) {
        let mut list = self.lock();
        if let Some((alert, change)) = list.raise(time_s, date(SystemTime::now()), subject, text) {
            self.tell(change, &alert);
            if alert.acknowledged.is_some() {
                self.keep(&list);
            }
        }
    }

    fn over_at(&self, time_s: f64, is_over: impl Fn(&Alert) -> bool) {
        let mut list = self.lock();
        let over = list.over(time_s, is_over);
        over.iter().for_each(|alert| self.tell(Change::Over, alert));
        if over.iter().any(|alert| alert.acknowledged.is_some()) {
            self.keep(&list);
        }
    }

    /// Writes down what the next program has to know. Called under the lock of the list.
    fn keep(&self, list: &List) {
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = kept::text(list.all(), &list.noted);
    }

    /// Tells clients and targets of a change. Called under the lock of the list, so that all get the same order.
    fn tell(&self, change: Change, alert: &Alert) {
        let text: Arc<str> = json!({"event": change.name(), "alert": alert}).to_string().into();
        // Nobody may follow.
        let _ = self.new.send(text);
        // Another text calls nobody again, nor does what somebody has taken notice of before.
        if change != Change::Changed && (change != Change::Raised || alert.acknowledged.is_none()) {
            self.targets().put(change, alert);
        }
    }

    /// Acknowledges the alerts of these numbers, or, without any, all that wait; gives their numbers.
    ///
    /// # Errors
    /// There is no such alert.
    pub(crate) fn acknowledge(&self, ids: &[u64], by: &str) -> Result<Vec<u64>, u64> {
        let mut list = self.lock();
        let acknowledged = list.acknowledge(ids, by, &date(SystemTime::now()))?;
        for alert in &acknowledged {
            self.tell(Change::Acknowledged, alert);
        }
        self.keep(&list);
        Ok(acknowledged.iter().map(|alert| alert.id).collect())
    }

    /// All alerts that are kept, oldest first, and the changes that follow.
    pub(crate) fn follow(&self) -> (Vec<Alert>, broadcast::Receiver<Arc<str>>) {
        let list = self.lock();
        (list.all().cloned().collect(), self.new.subscribe())
    }

    /// All alerts that are kept, oldest first.
    pub(crate) fn kept(&self) -> Vec<Alert> {
        self.lock().all().cloned().collect()
    }

    /// Those that are neither over nor acknowledged.
    pub(crate) fn waiting(&self) -> Vec<Alert> {
        self.lock().all().filter(|one| one.waits()).cloned().collect()
    }

    pub(crate) fn counts(&self) -> AlertCounts {
        AlertCounts { kinds: self.lock().counts(), undelivered: self.targets().undelivered() }
    }
}

impl Observer for AlertList {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn event(&self, event: &RunEvent) {
        let time_s = event.time.as_secs_f64();
        let component = event.component.as_deref();
        let raise = |kind: &str, subject: &str| {
            self.raise_at(time_s, Subject::new(component, kind, subject), event.what.to_string());
        };
        let is_own = |one: &Alert| one.component.as_deref() == component;
        match &event.what {
            Occurrence::Alert { kind, subject, text: Some(_) } => raise(kind, subject),
            Occurrence::Alert { kind, subject, text: None } => {
                let (kind, subject) = (list::kind(kind), list::subject(subject));
                self.over_at(time_s, |one| is_own(one) && one.kind == kind && one.subject == subject);
            }
            Occurrence::Failed { restart: None, .. } | Occurrence::Overrun { .. } => raise(FAILED, ""),
            Occurrence::Hangs { .. } => raise(HANGS, ""),
            Occurrence::Abandoned => raise(ABANDONED, ""),
            Occurrence::NotStopped { .. } => raise(NOT_STOPPED, ""),
            Occurrence::Returned => self.over_at(time_s, |one| is_own(one) && one.kind == HANGS),
            // A new instance knows nothing of what the one before asked for.
            Occurrence::Started
            | Occurrence::Restarted { continued: false, .. }
            | Occurrence::Replaced { continued: false } => self.over_at(time_s, is_own),
            Occurrence::Restarted { continued: true, .. } | Occurrence::Replaced { continued: true } => {
                let of_instance = [FAILED, HANGS, ABANDONED];
                self.over_at(time_s, |one| is_own(one) && of_instance.contains(&&*one.kind));
            }
            _ => {}
        }
    }
}
