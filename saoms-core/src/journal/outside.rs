use std::collections::VecDeque;

use saoms_api::Cause;

use super::JournalEntry;

/// Minimum number of records from outside that are kept.
const LEAST: usize = 128;

/// The newest records of messages from outside the fleet.
#[derive(Debug, Default)]
pub(crate) struct OutsideRing {
    pub(super) entries: VecDeque<JournalEntry>,
    pub(super) overwritten: u64,
}

impl OutsideRing {
    /// Adds a record and drops the oldest beyond `capacity`.
    pub(crate) fn push(&mut self, entry: JournalEntry, capacity: usize) {
        if self.entries.len() >= capacity.max(LEAST) {
            self.entries.pop_front();
            self.overwritten += 1;
        }
        self.entries.push_back(entry);
    }

    /// The record with this number: they grow.
    pub(crate) fn find(&self, id: Cause) -> Option<JournalEntry> {
        let place = self.entries.binary_search_by_key(&id, JournalEntry::id).ok()?;
        self.entries.get(place).cloned()
    }
}
