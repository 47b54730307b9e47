use std::collections::{BTreeMap, HashMap};

use saoms_api::{Cause, Time};
use serde::Serialize;

use super::why::is_act;
use super::{ComponentName, Journal, JournalEntry, LoopCounts};

/// Access to the journal of a fleet that runs: a piece at a time, so that nobody who writes to it waits for long.
pub(crate) trait Pieces {
    /// Some records of the component from this number on, oldest first; empty when there are no more.
    fn piece(&self, from: Cause) -> Vec<JournalEntry>;
    /// The record with this number, of whatever component.
    fn find(&self, id: Cause) -> Option<JournalEntry>;
    /// Number of records of the component that were overwritten.
    fn overwritten(&self) -> u64;
}

/// The records of a running fleet that explain what a component did, in the form of a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LiveJournal {
    /// The present time of the run, in seconds.
    pub time_s: f64,
    /// The component.
    pub components: Vec<ComponentName>,
    /// Its last acts, all records that led to them, and the last changes of its knowledge.
    pub journal: Journal,
}

impl Journal {
    /// The records with which [`why`](Journal::why) gives the same answer as with all: of this component, up to this
    /// time or at all. Records that are newer than the number are left out.
    pub(crate) fn excerpt(pieces: &impl Pieces, component: &str, at: Option<Time>, newest: Cause) -> Journal {
        let mut own = Own::default();
        let mut from = Cause(1);
        loop {
            let piece = pieces.piece(from);
            let Some(last) = piece.last() else { break };
            from = Cause(last.id().0 + 1);
            piece.into_iter().filter(|entry| entry.id() <= newest).for_each(|entry| own.take(entry, at));
            if from > newest {
                break;
            }
        }
        let overwritten = pieces.overwritten();
        let mut entries: BTreeMap<Cause, JournalEntry> = BTreeMap::new();
        for act in own.into_entries() {
            entries.insert(act.id(), act);
        }
        let mut causes: Vec<Cause> = entries.values().map(JournalEntry::cause).collect();
        while let Some(cause) = causes.pop() {
            if cause != Cause::default()
                && !entries.contains_key(&cause)
                && let Some(entry) = pieces.find(cause)
            {
                causes.push(entry.cause());
                entries.insert(cause, entry);
            }
        }
        let entries: Vec<JournalEntry> = entries.into_values().collect();
        // What is left out counts as little as if it had never been written; what was overwritten is missing.
        let mut loops = LoopCounts::of(&entries);
        if overwritten > 0 {
            let component = component.to_owned();
            loops.push(LoopCounts { component, symptoms: overwritten, ..LoopCounts::default() });
        }
        Journal { records: entries.len() as u64 + overwritten, overwritten, lost: 0, loops, entries }
    }
}

/// The records of a component that its answer needs.
#[derive(Default)]
struct Own {
    /// Its oldest one, which says how far its journal reaches back.
    first: Option<JournalEntry>,
    /// Its last acts up to the time.
    acts: Vec<JournalEntry>,
    /// Its last records up to the time, of whatever phase.
    last: Vec<JournalEntry>,
    /// The last change of each entry up to the time, or else the first one after it.
    changes: HashMap<String, JournalEntry>,
}

impl Own {
    fn take(&mut self, entry: JournalEntry, at: Option<Time>) {
        let is_until = at.is_none_or(|at| entry.time() <= at);
        if self.first.is_none() {
            self.first = Some(entry.clone());
        }
        if is_until {
            if is_act(&entry) {
                newest(&mut self.acts, &entry);
            }
            newest(&mut self.last, &entry);
        }
        if !entry.change {
            return;
        }
        match self.changes.get_mut(entry.record_id()) {
            Some(known) if is_until => *known = entry,
            Some(_) => {}
            None => {
                self.changes.insert(entry.record_id().to_owned(), entry);
            }
        }
    }

    fn into_entries(self) -> impl Iterator<Item = JournalEntry> {
        // The last ones are asked for only if there is no act.
        let last = if self.acts.is_empty() { self.last } else { Vec::new() };
        self.acts.into_iter().chain(last).chain(self.changes.into_values()).chain(self.first)
    }
}

/// Keeps the records of the newest time.
fn newest(kept: &mut Vec<JournalEntry>, entry: &JournalEntry) {
    let time = kept.first().map(JournalEntry::time);
    if time.is_some_and(|time| time > entry.time()) {
        return;
    }
    if time.is_some_and(|time| time < entry.time()) {
        kept.clear();
    }
    kept.push(entry.clone());
}
