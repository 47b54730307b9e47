use std::collections::{BTreeMap, VecDeque};

use serde::{Deserialize, Serialize};

use super::Change;
use super::kept::Noted;

/// Number of alerts that are kept, and of kinds that are counted.
const KEPT: usize = 1000;
const KINDS: usize = 100;
/// The kind of those beyond.
const OTHER: &str = "other";
/// Letters of a kind, of a subject and of a text that are kept.
const KIND: usize = 64;
const SUBJECT: usize = 200;
const TEXT: usize = 4000;

/// Something that needs a person.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alert {
    /// Its number in this run.
    pub id: u64,
    /// Its kind, such as `assistance`.
    pub kind: String,
    /// The component that it is about; `null` is the fleet as a whole.
    pub component: Option<String>,
    /// What it is about, where a component may have several of a kind; else empty.
    pub subject: String,
    /// What is wrong.
    pub text: String,
    /// Time of the run in seconds.
    pub time_s: f64,
    /// Time of day in UTC.
    pub date: String,
    /// Time of the run in seconds at which it was over; `null`: it is not.
    pub over_s: Option<f64>,
    /// Who took notice of it.
    pub acknowledged: Option<Acknowledgement>,
}

/// Who took notice of an alert.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Acknowledgement {
    /// The name that was given.
    pub by: String,
    /// Time of day in UTC.
    pub date: String,
}

impl Alert {
    /// True if nobody took notice of it yet, and it is not over.
    pub fn waits(&self) -> bool {
        self.over_s.is_none() && self.acknowledged.is_none()
    }
}

/// What an alert is about.
pub(super) struct Subject<'a> {
    component: Option<&'a str>,
    kind: String,
    subject: String,
}

impl<'a> Subject<'a> {
    pub(super) fn new(component: Option<&'a str>, kind: &str, of: &str) -> Subject<'a> {
        Subject { component, kind: self::kind(kind), subject: subject(of) }
    }
}

/// A kind, cut where it is too long.
pub(super) fn kind(text: &str) -> String {
    text.chars().take(KIND).collect()
}

/// A subject, cut where it is too long.
pub(super) fn subject(text: &str) -> String {
    text.chars().take(SUBJECT).collect()
}

/// The newest alerts, oldest first.
#[derive(Debug, Default)]
pub(super) struct List {
    alerts: VecDeque<Alert>,
    raised: u64,
    /// The number of those that were raised, by kind.
    kinds: BTreeMap<String, u64>,
    /// Time of the newest event in seconds.
    pub(super) last_time_s: f64,
    /// What was acknowledged in an earlier program, and the time at which this one goes on: alerts that are raised
    /// again then are the same.
    pub(super) noted: Vec<Noted>,
    pub(super) goes_on_at_s: f64,
}

impl List {
    pub(super) fn all(&self) -> impl Iterator<Item = &Alert> {
        self.alerts.iter()
    }

    /// Adds an alert, or gives the one about the same this text; `None` if nothing changes.
    pub(super) fn raise(
        &mut self,
        time_s: f64,
        date: String,
        Subject { component, kind, subject }: Subject<'_>,
        text: String,
    ) -> Option<(Alert, Change)> {
        self.last_time_s = time_s;
        let text: String = text.chars().take(TEXT).collect();
        let is_same = |one: &&mut Alert| {
            one.over_s.is_none() && one.component.as_deref() == component && one.kind == kind && one.subject == subject
        };
        if let Some(known) = self.alerts.iter_mut().find(is_same) {
            if known.text == text {
                return None;
            }
            known.text = text;
            return Some((known.clone(), Change::Changed));
        }
        if self.alerts.len() == KEPT {
            // One that needs nobody any more, or the oldest.
            let least = self.alerts.iter().position(|one| one.over_s.is_some()).unwrap_or(0);
            self.alerts.remove(least);
        }
        self.raised += 1;
        self.count(&kind);
        let acknowledged = self.noted(component, &kind, &subject);
        let component = component.map(str::to_owned);
        let alert = Alert { id: self.raised, kind, component, subject, text, time_s, date, over_s: None, acknowledged };
        self.alerts.push_back(alert.clone());
        Some((alert, Change::Raised))
    }

    /// The acknowledgement of an alert that an earlier program had raised.
    fn noted(&mut self, component: Option<&str>, kind: &str, subject: &str) -> Option<Acknowledgement> {
        if self.last_time_s > self.goes_on_at_s {
            self.noted.clear();
        }
        let place = self.noted.iter().position(|noted| noted.is_about(component, kind, subject))?;
        Some(self.noted.swap_remove(place).acknowledged())
    }

    fn count(&mut self, kind: &str) {
        let kind = if self.kinds.contains_key(kind) || self.kinds.len() < KINDS { kind } else { OTHER };
        *self.kinds.entry(kind.to_owned()).or_default() += 1;
    }

    /// Marks the alerts for which this is true as over; gives them.
    pub(super) fn over(&mut self, time_s: f64, is_over: impl Fn(&Alert) -> bool) -> Vec<Alert> {
        self.last_time_s = time_s;
        let ended = self.alerts.iter_mut().filter(|one| one.over_s.is_none() && is_over(one));
        let mark = |one: &mut Alert| {
            one.over_s = Some(time_s);
            one.clone()
        };
        ended.map(mark).collect()
    }

    /// Acknowledges the alerts of these numbers, or all that wait; gives those that were not before.
    pub(super) fn acknowledge(&mut self, ids: &[u64], by: &str, date: &str) -> Result<Vec<Alert>, u64> {
        if let Some(unknown) = ids.iter().find(|id| !self.alerts.iter().any(|one| one.id == **id)) {
            return Err(*unknown);
        }
        let is_meant = |one: &&mut Alert| match ids {
            [] => one.waits(),
            ids => one.acknowledged.is_none() && ids.contains(&one.id),
        };
        let mark = |one: &mut Alert| {
            one.acknowledged = Some(Acknowledgement { by: by.to_owned(), date: date.to_owned() });
            one.clone()
        };
        Ok(self.alerts.iter_mut().filter(is_meant).map(mark).collect())
    }

    /// By kind: those that wait, those that are acknowledged and not over, and all that were raised.
    pub(super) fn counts(&self) -> Vec<(String, [u64; 3])> {
        let mut counts: BTreeMap<&str, [u64; 3]> =
            self.kinds.iter().map(|(kind, raised)| (kind.as_str(), [0, 0, *raised])).collect();
        for alert in self.alerts.iter().filter(|one| one.over_s.is_none()) {
            let kind = if counts.contains_key(&*alert.kind) { &*alert.kind } else { OTHER };
            counts.entry(kind).or_default()[usize::from(alert.acknowledged.is_some())] += 1;
        }
        counts.into_iter().map(|(kind, counts)| (kind.to_owned(), counts)).collect()
    }
}
