use std::collections::HashMap;
use std::sync::Arc;

use saoms_api::Cause;
use saoms_api::host::Phase;
use serde::{Deserialize, Serialize};

use super::{JournalEntry, OutsideRing, Ring, Selection};

/// The kept records of a run, and counts of all that were written.
///
/// ```
/// use saoms_core::journal::Journal;
///
/// let json = r#"{"records": 2, "overwritten": 0, "lost": 0, "loops": [], "entries": [
///     {"id": 1, "time_s": 1.0, "component": "Gate", "phase": "symptom", "text": "a piece waits"},
///     {"id": 2, "time_s": 1.1, "component": "Robot", "loop": "Path", "phase": "decision",
///      "text": "drives to it", "cause": 1}]}"#;
/// let journal: Journal = serde_json::from_str(json)?;
/// let decision = journal.of("Robot").of_loop("Path").decisions().last().unwrap();
/// let (reasons, missing) = journal.reasons(decision);
/// assert_eq!(reasons[0].text(), "a piece waits");
/// assert_eq!(missing, None);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Journal {
    /// Number of records written.
    pub records: u64,
    /// Number of records overwritten by newer ones of the same component.
    pub overwritten: u64,
    /// Number of records that did not reach the observers of the journal (`--journal`), because they were too slow or
    /// failed. 0 without such an observer.
    pub lost: u64,
    /// Counts of the records of each loop that wrote any.
    pub loops: Vec<LoopCounts>,
    /// Ordered by number.
    pub(super) entries: Vec<JournalEntry>,
}

/// Counts of the records of one loop.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LoopCounts {
    /// The path of the component.
    pub component: String,
    /// The loop; `null` is the component itself, outside all loops.
    #[serde(rename = "loop")]
    pub loop_name: Option<String>,
    /// Symptoms, without repetitions.
    pub symptoms: u64,
    /// Decisions, without repetitions.
    pub decisions: u64,
    /// Effects, including changes of the knowledge.
    pub effects: u64,
    /// Decisions from which nothing followed: no effect, no message, no call. `None` where that was not noted: records
    /// alone do not tell it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_effect: Option<u64>,
}

impl LoopCounts {
    /// The counts of these records, by component and loop in the order of their first record.
    pub(super) fn of(entries: &[JournalEntry]) -> Vec<LoopCounts> {
        let mut all: Vec<LoopCounts> = Vec::new();
        let mut places = HashMap::new();
        for entry in entries {
            let place = *places.entry((entry.component(), entry.loop_name())).or_insert_with(|| {
                let (component, loop_name) = (entry.component().to_owned(), entry.loop_name().map(str::to_owned));
                all.push(LoopCounts { component, loop_name, ..LoopCounts::default() });
                all.len() - 1
            });
            let counts = &mut all[place];
            *match entry.phase() {
                Phase::Symptom => &mut counts.symptoms,
                Phase::Decision => &mut counts.decisions,
                Phase::Effect => &mut counts.effects,
            } += 1;
        }
        all
    }

    /// The counts of the loops of a component that wrote any record.
    pub(crate) fn of_ring<'a>(component: &'a str, ring: &'a Ring) -> impl Iterator<Item = LoopCounts> + 'a {
        let tallies = ring.tallies.iter().enumerate().filter(|(_, tally)| tally.total() > 0);
        tallies.map(|(index, tally)| LoopCounts {
            component: component.to_owned(),
            loop_name: ring.name((index as u16).wrapping_sub(1)).map(|name| name.to_string()),
            symptoms: tally.symptoms,
            decisions: tally.decisions,
            effects: tally.effects,
            without_effect: Some(tally.without_effect()),
        })
    }

    /// All records together.
    pub fn records(&self) -> u64 {
        self.symptoms + self.decisions + self.effects
    }
}

impl Journal {
    /// The counts of the journal, without its records.
    #[must_use]
    pub fn without_records(&self) -> Journal {
        let Journal { records, overwritten, lost, ref loops, .. } = *self;
        Journal { records, overwritten, lost, loops: loops.clone(), entries: Vec::new() }
    }

    /// The journal of a run, collected from the rings of its components.
    pub(crate) fn of_rings<'a>(
        rings: impl Iterator<Item = (&'a Arc<str>, &'a Ring)>,
        outside: &OutsideRing,
    ) -> Journal {
        let mut journal = Journal::default();
        for (component, ring) in rings {
            journal.overwritten += ring.overwritten;
            let before = journal.loops.len();
            journal.loops.extend(LoopCounts::of_ring(component, ring));
            journal.records += journal.loops[before..].iter().map(LoopCounts::records).sum::<u64>();
            for batch in ring.batches() {
                journal.entries.extend(batch.heads().iter().map(|head| ring.entry(component, batch, head)));
            }
        }
        journal.entries.extend(outside.entries.iter().cloned());
        let symptoms = outside.overwritten + outside.entries.len() as u64;
        if let Some(entry) = outside.entries.front() {
            journal.records += symptoms;
            journal.overwritten += outside.overwritten;
            let component = entry.component().to_owned();
            journal.loops.push(LoopCounts { component, symptoms, ..LoopCounts::default() });
        }
        journal.entries.sort_unstable_by_key(|entry| entry.id);
        journal
    }

    /// All kept records, oldest first.
    pub fn entries(&self) -> &[JournalEntry] {
        &self.entries
    }

    /// A selection of all kept records.
    pub fn all(&self) -> Selection<'_> {
        Selection::new(self.entries.iter())
    }

    /// A selection of the kept records of one component, by its path.
    pub fn of(&self, component: &str) -> Selection<'_> {
        Selection::new(self.entries.iter().filter(|entry| entry.component() == component))
    }

    /// The record with this number, if it is kept.
    pub fn entry(&self, id: Cause) -> Option<&JournalEntry> {
        self.entries.binary_search_by_key(&id, JournalEntry::id).ok().map(|place| &self.entries[place])
    }

    /// The causes of a record: the record that it follows from, then the cause of that one, and so on to the root. The
    /// number is that of the first cause that is missing, because it was overwritten.
    pub fn reasons(&self, entry: &JournalEntry) -> (Vec<&JournalEntry>, Option<Cause>) {
        let mut reasons = Vec::new();
        let mut next = entry.cause();
        while next != Cause::default() {
            let Some(entry) = self.entry(next) else { return (reasons, Some(next)) };
            reasons.push(entry);
            // A cause has a smaller number than its record (the reader of files checks it), so this ends.
            next = entry.cause();
        }
        (reasons, None)
    }
}
