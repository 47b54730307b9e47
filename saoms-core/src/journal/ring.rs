use std::collections::VecDeque;
use std::sync::Arc;

use saoms_api::Cause;
use saoms_api::host::Phase;

use super::JournalEntry;
use super::batch::{Batch, Head, OUTSIDE};
use super::entry::Content;
use super::recorder::{Notice, Recorder};

/// Number of records in a chunk. A chunk is allocated and overwritten as a whole, so that no record is ever moved.
const CHUNK: usize = 64;

/// The newest records of one component, and counts of all that it has written.
#[derive(Debug, Default)]
pub(crate) struct Ring {
    chunks: VecDeque<Batch>,
    pub(super) overwritten: u64,
    /// Counts of each loop by its place, after those of records outside all loops.
    pub(super) tallies: Vec<Tally>,
    names: LoopNames,
}

/// Names of the loops of a component.
#[derive(Debug, Default)]
pub(super) struct LoopNames(Vec<Option<Arc<str>>>);

impl LoopNames {
    pub(super) fn set(&mut self, place: u16, name: &str) {
        let place = usize::from(place);
        if self.0.len() <= place {
            self.0.resize(place + 1, None);
        }
        self.0[place] = Some(Arc::from(name));
    }

    /// The name of a loop; `None` outside all of them.
    pub(super) fn get(&self, place: u16) -> Option<Arc<str>> {
        if place == OUTSIDE {
            return None;
        }
        let name = self.0.get(usize::from(place)).cloned().flatten();
        Some(name.unwrap_or_else(|| Arc::from(format!("loop {}", place + 1))))
    }
}

/// Counts of the records of one loop by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tally {
    pub(super) symptoms: u64,
    pub(super) decisions: u64,
    pub(super) effects: u64,
    /// Decisions without effect, before the present one.
    idle: u64,
    /// True if the present decision has had no effect.
    waiting: bool,
}

impl Tally {
    pub(super) fn without_effect(&self) -> u64 {
        self.idle + u64::from(self.waiting)
    }

    pub(super) fn total(&self) -> u64 {
        self.symptoms + self.decisions + self.effects
    }
}

impl Ring {
    /// Moves in the new records of a component, and keeps at most `capacity` records.
    pub(crate) fn take(&mut self, recorder: &mut Recorder, capacity: usize) {
        for notice in recorder.notices.drain(..) {
            match notice {
                Notice::Name(place, name) => self.names.set(place, &name),
                Notice::Acted(place) => self.tally(place).waiting = false,
            }
        }
        for head in recorder.batch.heads() {
            self.count(head);
            self.room(capacity).copy(head, &recorder.batch);
        }
        recorder.batch.clear();
    }

    fn count(&mut self, head: &Head) {
        let tally = self.tally(head.place);
        match head.phase {
            Phase::Symptom => tally.symptoms += 1,
            Phase::Decision => {
                tally.decisions += 1;
                tally.idle += u64::from(std::mem::replace(&mut tally.waiting, !head.acted));
            }
            Phase::Effect => tally.effects += 1,
        }
    }

    fn tally(&mut self, place: u16) -> &mut Tally {
        let index = usize::from(place.wrapping_add(1));
        if self.tallies.len() <= index {
            self.tallies.resize(index + 1, Tally::default());
        }
        &mut self.tallies[index]
    }

    /// The chunk with room for the next record.
    fn room(&mut self, capacity: usize) -> &mut Batch {
        if self.chunks.back().is_none_or(|chunk| chunk.len() >= CHUNK) {
            // At least two chunks: overwriting the only one would leave no record.
            let full = self.chunks.len() >= capacity.div_ceil(CHUNK).max(2);
            let mut chunk = full.then(|| self.chunks.pop_front()).flatten().unwrap_or_default();
            self.overwritten += chunk.len() as u64;
            chunk.clear();
            self.chunks.push_back(chunk);
        }
        let last = self.chunks.len() - 1;
        &mut self.chunks[last]
    }

    /// The kept records, oldest first.
    pub(super) fn batches(&self) -> impl Iterator<Item = &Batch> {
        self.chunks.iter()
    }

    /// Number of records that newer ones have replaced.
    pub(crate) fn overwritten(&self) -> u64 {
        self.overwritten
    }

    /// The name of a loop; `None` outside all of them.
    pub(super) fn name(&self, place: u16) -> Option<Arc<str>> {
        self.names.get(place)
    }

    /// A record of a batch of this ring.
    pub(super) fn entry(&self, component: &Arc<str>, batch: &Batch, head: &Head) -> JournalEntry {
        JournalEntry {
            id: head.id,
            time: head.time(),
            component: Arc::clone(component),
            loop_name: self.name(head.place),
            phase: head.phase,
            cause: head.cause,
            change: head.change,
            what: Content::Noted(batch.record(head)),
        }
    }

    /// The record with this number. The numbers of a ring grow, so that it is found by halves.
    pub(crate) fn find(&self, component: &Arc<str>, id: Cause) -> Option<JournalEntry> {
        let batch = self.chunk_from(id)?;
        let place = batch.heads().binary_search_by_key(&id, |head| head.id).ok()?;
        Some(self.entry(component, batch, &batch.heads()[place]))
    }

    /// The records of one chunk from this number on: of the first that has any.
    pub(crate) fn piece(&self, component: &Arc<str>, from: Cause) -> Vec<JournalEntry> {
        let Some(batch) = self.chunk_from(from) else { return Vec::new() };
        let heads = batch.heads();
        let first = heads.partition_point(|head| head.id < from);
        heads[first..].iter().map(|head| self.entry(component, batch, head)).collect()
    }

    /// The first chunk with this number or a greater one.
    fn chunk_from(&self, id: Cause) -> Option<&Batch> {
        let is_before = |chunk: &Batch| chunk.heads().last().is_none_or(|last| last.id < id);
        self.chunks.get(self.chunks.partition_point(is_before))
    }
}
