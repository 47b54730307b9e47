use std::collections::HashMap;

use saoms_api::event::fault::FaultCall;
use saoms_api::host::Phase;

use super::Samples;
use super::event::Event;
use super::known::{Known, KnownRecords, Origin};
use super::names::Names;
use super::report::{AdaptationReport, tables};
use super::switches::{Closed, Switches};
use crate::journal::{ComponentName, JournalEntry};

/// Events that are measured at most; those beyond are counted.
const MOST_EVENTS: usize = 100_000;
/// Kinds of events at most; those beyond are one kind.
const MOST_KINDS: usize = 64;
const OTHER_KINDS: &str = "(others)";

/// Number of periods of a component after which what it did lasts: long enough for an answer of others.
const QUIET: u64 = 10;

/// What came of the events of a run, from the records of its journal as they come.
///
/// Memory is bounded: what is left out is counted in the [report](AdaptationReport).
#[derive(Debug, Default)]
pub struct Adaptations {
    names: Names,
    /// [`QUIET`] periods in nanoseconds, by component.
    quiet: HashMap<u32, u64>,
    known: KnownRecords,
    switches: Switches,
    pub(super) events: Vec<Event>,
    pub(super) kinds: Vec<String>,
    /// Events beyond those that are measured.
    pub(super) unmeasured: u64,
    /// Records whose cause is not known.
    pub(super) detached: u64,
}

impl Adaptations {
    /// Takes in a component: without its period, nothing that it does lasts.
    pub fn join(&mut self, component: &ComponentName) {
        if let Some(period) = component.period_us {
            let quiet = period.saturating_mul(1000 * QUIET);
            self.quiet.insert(self.names.number(&component.name), quiet);
        }
    }

    /// Takes in a record. Causes come before what follows from them.
    pub fn take(&mut self, entry: &JournalEntry) {
        let component = self.names.number(entry.component());
        let loop_name = entry.loop_name().map(|name| self.names.number(name));
        let (id, phase, time) = (entry.id(), entry.phase(), entry.time().as_nanos());
        let mut record = Known { id, origin: Origin::Nothing, is_beyond: false, component, loop_name, phase, time };
        let cause = Some(entry.cause()).filter(|cause| cause.0 > 0);
        match cause.map(|cause| self.known.get(cause)) {
            Some(None) => {
                self.detached += 1;
                record.origin = Origin::Unknown;
            }
            Some(Some(Known { origin: Origin::Unknown, .. })) => record.origin = Origin::Unknown,
            Some(Some(cause @ Known { origin: Origin::Event(event), .. })) => {
                record.origin = cause.origin;
                self.follow(entry, event, &cause, &mut record);
            }
            Some(Some(Known { origin: Origin::Nothing, .. })) | None if phase != Phase::Effect => {
                record.origin = self.begin(entry, record.time);
            }
            Some(Some(_)) | None => {}
        }
        self.known.put(record);
    }

    /// A new event.
    fn begin(&mut self, entry: &JournalEntry, at: u64) -> Origin {
        if self.events.len() >= MOST_EVENTS {
            self.unmeasured += 1;
            return Origin::Unknown;
        }
        let kind = self.kind(entry);
        self.events.push(Event::new(kind, entry.loop_name().is_some(), entry.id().0, at));
        Origin::Event(self.events.len() as u32 - 1)
    }

    /// The number of an event's kind: the id of its record; of a message from outside the first word of its line.
    fn kind(&mut self, entry: &JournalEntry) -> u32 {
        let text = if entry.is_from_outside() { Some(entry.text()) } else { None };
        let name = match &text {
            Some(line) => match FaultCall::read(line) {
                Ok(call) if FaultCall::is_one(line) => call.kind.word(),
                _ => line.split_whitespace().next().unwrap_or_default(),
            },
            None => entry.record_id(),
        };
        let known = self.kinds.iter().position(|kind| kind == name);
        let place = known.unwrap_or_else(|| {
            if self.kinds.len() <= MOST_KINDS {
                let is_last = self.kinds.len() == MOST_KINDS;
                self.kinds.push(if is_last { OTHER_KINDS } else { name }.to_owned());
            }
            self.kinds.len() - 1
        });
        place as u32
    }

    /// A record that follows from an event.
    fn follow(&mut self, entry: &JournalEntry, event: u32, cause: &Known, record: &mut Known) {
        let quiet = self.quiet.get(&record.component).copied().unwrap_or(u64::MAX);
        record.is_beyond = cause.is_beyond || self.is_aftermath(event, cause, record, quiet);
        let now = record.time;
        if !record.is_beyond
            && let Some(event) = self.events.get_mut(event as usize)
        {
            let first = match record.phase {
                Phase::Symptom => &mut event.detected,
                Phase::Decision => &mut event.decided,
                Phase::Effect => &mut event.acted,
            };
            first.get_or_insert(now);
            if record.phase == Phase::Effect {
                event.settled = Some(now);
            }
        }
        if entry.is_switch() {
            self.switch(event, record, entry.record_id(), quiet);
        }
        if !record.is_beyond {
            self.switches.touch(event, record.component, now);
        }
    }

    /// True if a component goes on by itself: all that the event had switched there is back, or one of its loops looks
    /// again at what it did itself, later.
    fn is_aftermath(&self, event: u32, cause: &Known, record: &Known, quiet: u64) -> bool {
        if cause.component != record.component {
            return false;
        }
        match self.switches.of(event, record.component) {
            Some(engagement) => engagement.open == 0,
            None => {
                cause.loop_name == record.loop_name
                    && cause.phase != Phase::Symptom
                    && record.phase == Phase::Symptom
                    && record.time > cause.time.saturating_add(quiet)
            }
        }
    }

    /// An entry that is yes or no changed.
    fn switch(&mut self, event: u32, record: &Known, entry: &str, quiet: u64) {
        let (component, now) = (record.component, record.time);
        let entry = self.names.number(entry);
        let closed = self.switches.close(component, entry);
        if let Some(Closed { event: holder, engagement }) = closed {
            let is_taken = holder != event && now <= engagement.last.saturating_add(quiet);
            let lasted = now.saturating_sub(engagement.since);
            let is_unused = engagement.open == 0 && !self.switches.is_used_since(component, engagement.since);
            if let Some(holder) = self.events.get_mut(holder as usize) {
                holder.is_overtaken |= is_taken;
                let is_needless = is_unused && !is_taken && !holder.is_own && lasted > quiet;
                holder.needless += u32::from(is_needless);
            }
        }
        // What it switched itself is back; what another event had switched is its own from now on.
        let is_back = closed.is_some_and(|closed| closed.event == event);
        if !is_back && !record.is_beyond {
            let is_own = self.events.get(event as usize).is_some_and(|event| event.is_own);
            self.switches.open(event, component, entry, now, !is_own);
        }
    }

    /// What came of all events of a run with these curves.
    pub fn report(&self, samples: &Samples) -> AdaptationReport {
        tables(self, &self.switches, samples)
    }
}
