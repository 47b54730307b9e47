use std::collections::VecDeque;

use super::JournalEntry;

/// The fewest records from outside that are kept.
const LEAST: usize = 128;

/// The newest records of what came from outside the fleet.
#[derive(Debug, Default)]
pub(crate) struct OutsideRing {
    pub(super) entries: VecDeque<JournalEntry>,
    pub(super) overwritten: u64,
}

impl OutsideRing {
    /// Takes a record, and keeps at most so many.
    pub(crate) fn push(&mut self, entry: JournalEntry, capacity: usize) {
        if self.entries.len() >= capacity.max(LEAST) {
            self.entries.pop_front();
            self.overwritten += 1;
        }
        self.entries.push_back(entry);
    }
}
