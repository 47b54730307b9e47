use std::fmt;
use std::ops::RangeInclusive;

use saoms_api::Time;
use saoms_api::host::Phase;

use super::JournalEntry;

/// Records of a journal, oldest first: all, or those that are left after some were filtered out.
///
/// `Display` writes one line for each record, so that a test can compare a selection with a text.
#[derive(Clone, Debug, Default)]
pub struct Selection<'a> {
    entries: Vec<&'a JournalEntry>,
}

impl<'a> Selection<'a> {
    pub(super) fn new(entries: impl Iterator<Item = &'a JournalEntry>) -> Selection<'a> {
        Selection { entries: entries.collect() }
    }

    /// The records of one component, by its path.
    #[must_use]
    pub fn of(self, component: &str) -> Selection<'a> {
        self.only(|entry| entry.component() == component)
    }

    /// The records of the loops with this name.
    #[must_use]
    pub fn of_loop(self, name: &str) -> Selection<'a> {
        self.only(|entry| entry.loop_name() == Some(name))
    }

    /// The symptoms.
    #[must_use]
    pub fn symptoms(self) -> Selection<'a> {
        self.only(|entry| entry.phase() == Phase::Symptom)
    }

    /// The decisions.
    #[must_use]
    pub fn decisions(self) -> Selection<'a> {
        self.only(|entry| entry.phase() == Phase::Decision)
    }

    /// The effects, including changes of knowledge.
    #[must_use]
    pub fn effects(self) -> Selection<'a> {
        self.only(|entry| entry.phase() == Phase::Effect)
    }

    /// The records with this id, as `low_battery`: unlike their texts, it stays.
    #[must_use]
    pub fn of_record(self, id: &str) -> Selection<'a> {
        self.only(|entry| !entry.change && entry.record_id() == id)
    }

    /// The changes of this entry of the knowledge.
    #[must_use]
    pub fn changes(self, entry: &str) -> Selection<'a> {
        self.only(|one| one.change().is_some_and(|change| change.entry == entry))
    }

    /// The records of this period of the run.
    #[must_use]
    pub fn during(self, times: RangeInclusive<Time>) -> Selection<'a> {
        self.only(|entry| times.contains(&entry.time()))
    }

    /// The records whose text contains `text`.
    #[must_use]
    pub fn with(self, text: &str) -> Selection<'a> {
        self.only(|entry| entry.text().contains(text))
    }

    /// The records for which `holds` is true.
    #[must_use]
    pub fn only(mut self, holds: impl Fn(&JournalEntry) -> bool) -> Selection<'a> {
        self.entries.retain(|entry| holds(entry));
        self
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// True if there is no record.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The oldest.
    pub fn first(&self) -> Option<&'a JournalEntry> {
        self.entries.first().copied()
    }

    /// The newest.
    pub fn last(&self) -> Option<&'a JournalEntry> {
        self.entries.last().copied()
    }

    /// The records, oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &'a JournalEntry> {
        self.entries.iter().copied()
    }

    /// The texts of the records, oldest first.
    pub fn texts(&self) -> Vec<String> {
        self.iter().map(JournalEntry::text).collect()
    }
}

impl fmt::Display for Selection<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.iter().try_for_each(|entry| writeln!(formatter, "{entry}"))
    }
}
