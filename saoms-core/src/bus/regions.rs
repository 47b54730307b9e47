//! Readers that receive the messages of a region of blocks alone. Blocks are kept in cells of a grid, so that a message
//! looks at the readers around its block, and a region that moves at the messages around it, however many there are.

use std::collections::{HashMap, VecDeque};

use saoms_api::host::SharedMessage;
use saoms_api::{Departed, Region};

use super::hash::KeyHashing;
use super::state::StateTable;

/// Number of blocks along a side of a cell, as a power of two.
const CELL: u32 = 4;
/// Greatest number of cells in which a region is noted; a larger one is looked at for each message.
const CELLS: i64 = 1024;

/// Least number of changes at which a reader makes those of one entry one.
const TIDY: usize = 64;

/// A reader among those of a cell, with its region: a message looks at all of them, and concerns few.
#[derive(Clone, Copy)]
struct InCell {
    place: u32,
    region: Region,
}

/// A cell: its column and row.
pub type Cell = (i32, i32);
type Block = (i32, i32);

/// The readers of a topic that have a region.
#[derive(Clone, Default)]
pub(super) struct RegionReaders {
    readers: Vec<RegionReader>,
    /// Whether a collection has anything to do, for each reader: most have no news most of the time, and their state is
    /// far apart in memory.
    stirred: Vec<bool>,
    free: Vec<u32>,
    /// The readers whose region has blocks in a cell, and those whose region is too large for that.
    cells: HashMap<Cell, Vec<InCell>, KeyHashing>,
    wide: Vec<InCell>,
    /// The entries of a state topic by the cell of their block.
    entries: HashMap<Cell, Vec<u32>, KeyHashing>,
}

#[derive(Clone)]
struct RegionReader {
    region: Region,
    is_in_use: bool,
    /// Events that wait, at most so many, and how many were lost.
    events: VecDeque<SharedMessage>,
    queue: usize,
    lost: u64,
    /// Entries of a state topic that changed or came into the region, and those that the reader knows.
    changed: Vec<u32>,
    /// Number of changes at which those of one entry become one, so that they take no memory without end while nobody
    /// collects.
    tidy_at: usize,
    known: HashMap<u32, Departed, KeyHashing>,
    /// Entries that the reader knew and that left its region.
    departed: Vec<(u32, Departed)>,
    /// The last collection, which may be put back: entries, each with whether it was new, and those that had left.
    collected: Vec<(u32, bool)>,
    reported: Vec<(u32, Departed)>,
}

/// The cell of a block.
pub fn cell_of((x, y): Block) -> Cell {
    (x >> CELL, y >> CELL)
}

/// The cells of a region; `None` where there are too many.
fn cells(region: &Region) -> Option<impl Iterator<Item = Cell> + use<>> {
    let (least, most) = (cell_of(region.least()), cell_of(region.most()));
    let side = |least: i32, most: i32| (i64::from(most) - i64::from(least) + 1).max(0);
    let count = side(least.0, most.0).saturating_mul(side(least.1, most.1));
    (count <= CELLS).then(|| (least.1..=most.1).flat_map(move |y| (least.0..=most.0).map(move |x| (x, y))))
}

impl RegionReaders {
    /// The readers of a topic that retains these messages.
    pub(super) fn of(table: Option<&StateTable>) -> RegionReaders {
        let mut readers = RegionReaders::default();
        for (entry, message) in table.into_iter().flat_map(StateTable::messages) {
            readers.note_entry(entry, message.place());
        }
        readers
    }

    fn note_entry(&mut self, entry: u32, block: Option<Block>) {
        if let Some(block) = block {
            self.entries.entry(cell_of(block)).or_default().push(entry);
        }
    }

    /// Adds a reader; gives its place.
    pub(super) fn join(&mut self, region: Region, queue: usize, table: Option<&StateTable>) -> u32 {
        let reader = RegionReader {
            region,
            is_in_use: true,
            events: VecDeque::new(),
            queue: queue.max(1),
            lost: 0,
            changed: Vec::new(),
            tidy_at: TIDY,
            known: HashMap::default(),
            departed: Vec::new(),
            collected: Vec::new(),
            reported: Vec::new(),
        };
        let place = match self.free.pop() {
            Some(place) => {
                self.readers[place as usize] = reader;
                place
            }
            None => {
                self.readers.push(reader);
                self.stirred.push(false);
                self.readers.len() as u32 - 1
            }
        };
        self.enter_cells(place);
        self.look_around(place, table);
        place
    }

    /// Removes a reader; gives the number of events that it lost since its last collection.
    pub(super) fn leave(&mut self, place: u32) -> u64 {
        self.leave_cells(place);
        self.free.push(place);
        let reader = &mut self.readers[place as usize];
        reader.is_in_use = false;
        (reader.events, reader.known, reader.changed) = Default::default();
        std::mem::take(&mut reader.lost)
    }

    /// Removes all readers but one.
    pub(super) fn keep(&mut self, place: u32) {
        let others = (0..self.readers.len() as u32).filter(|other| *other != place);
        for other in others.filter(|other| self.readers[*other as usize].is_in_use).collect::<Vec<_>>() {
            self.leave(other);
        }
    }

    /// The region of a reader.
    pub(super) fn region(&self, place: u32) -> Region {
        self.readers[place as usize].region
    }

    /// Gives a reader another region.
    pub(super) fn move_to(&mut self, place: u32, region: Region, table: Option<&StateTable>) {
        if self.readers[place as usize].region == region {
            return;
        }
        self.leave_cells(place);
        let reader = &mut self.readers[place as usize];
        reader.region = region;
        if let Some(table) = table {
            let mut gone: Vec<u32> = reader.known.keys().copied().collect();
            gone.retain(|entry| !is_in(&region, table.message(*entry)));
            gone.sort_unstable();
            reader.departed.extend(gone.iter().filter_map(|entry| Some((*entry, reader.known.remove(entry)?))));
        }
        self.stirred[place as usize] = true;
        self.enter_cells(place);
        self.look_around(place, table);
    }

    fn enter_cells(&mut self, place: u32) {
        let region = self.readers[place as usize].region;
        let reader = InCell { place, region };
        match cells(&region) {
            Some(all) => all.for_each(|cell| self.cells.entry(cell).or_default().push(reader)),
            None => self.wide.push(reader),
        }
    }

    fn leave_cells(&mut self, place: u32) {
        let Some(all) = cells(&self.readers[place as usize].region) else {
            self.wide.retain(|other| other.place != place);
            return;
        };
        for cell in all {
            if let Some(readers) = self.cells.get_mut(&cell) {
                readers.retain(|other| other.place != place);
                if readers.is_empty() {
                    self.cells.remove(&cell);
                }
            }
        }
    }

    /// Notes the entries in the region of a reader that it does not know.
    fn look_around(&mut self, place: u32, table: Option<&StateTable>) {
        let Some(table) = table else { return };
        self.stirred[place as usize] = true;
        let reader = &mut self.readers[place as usize];
        let mut changed = std::mem::take(&mut reader.changed);
        let mut look = |entries: &[u32]| {
            let new = entries
                .iter()
                .filter(|entry| !reader.known.contains_key(entry) && is_in(&reader.region, table.message(**entry)));
            changed.extend(new);
        };
        match cells(&reader.region) {
            Some(all) if all.size_hint().0 <= self.entries.len() => {
                for cell in cells(&reader.region).into_iter().flatten() {
                    look(self.entries.get(&cell).map_or(&[], Vec::as_slice));
                }
            }
            _ => self.entries.values().for_each(|entries| look(entries)),
        }
        reader.changed = changed;
        reader.tidy();
    }

    /// Notes a change of an entry of a state topic, whose block was another one before.
    pub(super) fn changed(&mut self, entry: u32, before: Option<Block>, now: Option<Block>) {
        let (old, new) = (before.map(cell_of), now.map(cell_of));
        if old != new {
            if let Some(entries) = old.and_then(|old| self.entries.get_mut(&old)) {
                entries.retain(|other| *other != entry);
            }
            self.note_entry(entry, now);
        }
        let around = [old, new.filter(|new| Some(*new) != old)].into_iter().flatten();
        let around = around.filter_map(|cell| self.cells.get(&cell)).flatten().chain(&self.wide);
        for InCell { place, region } in around {
            // A reader knows no entry that was outside of its region, or the change by which it left still waits.
            if now.is_some_and(|now| region.contains(now)) || before.is_some_and(|before| region.contains(before)) {
                self.stirred[*place as usize] = true;
                let reader = &mut self.readers[*place as usize];
                reader.changed.push(entry);
                reader.tidy();
            }
        }
    }

    /// Gives an event to the readers in whose region it is.
    pub(super) fn event(&mut self, message: &SharedMessage) {
        let Some(block) = message.place() else { return };
        let around = self.cells.get(&cell_of(block)).into_iter().flatten().chain(&self.wide);
        for InCell { place, region } in around {
            if !region.contains(block) {
                continue;
            }
            let reader = &mut self.readers[*place as usize];
            if reader.events.len() >= reader.queue {
                reader.events.pop_front();
                reader.lost += 1;
            }
            reader.events.push_back(message.clone());
            self.stirred[*place as usize] = true;
        }
    }

    /// The events that wait for a reader.
    pub(super) fn unread(&self, place: u32) -> impl Iterator<Item = &SharedMessage> {
        self.readers[place as usize].events.iter()
    }

    /// True if events wait for a reader.
    pub(super) fn has_unread(&self) -> bool {
        self.readers.iter().any(|reader| !reader.events.is_empty())
    }

    /// True if a collection has anything to do.
    #[inline]
    pub(super) fn is_stirred(&self, place: u32) -> bool {
        self.stirred[place as usize]
    }

    pub(super) fn has_news(&self, place: u32) -> bool {
        self.readers[place as usize].has_news()
    }

    /// Appends what is new to a reader, oldest first, and what is not in its region any more. Returns the number of
    /// events that it lost since its last collection.
    pub(super) fn collect(
        &mut self,
        place: u32,
        table: Option<&StateTable>,
        inbox: &mut Vec<SharedMessage>,
        departed: &mut Vec<Departed>,
    ) -> u64 {
        if !self.stirred[place as usize] {
            return 0;
        }
        let reader = &mut self.readers[place as usize];
        // What this collection leaves behind to be put back is cleared by the next one.
        self.stirred[place as usize] = reader.has_news();
        inbox.extend(reader.events.drain(..));
        if let Some(table) = table {
            reader.collect_changes(table, inbox);
        }
        reader.reported.clear();
        reader.reported.append(&mut reader.departed);
        // What came back in the meantime has not left; but it has, if this collection is put back.
        let left = reader.reported.iter().filter(|(entry, _)| !reader.known.contains_key(entry));
        departed.extend(left.map(|(_, departed)| *departed));
        std::mem::take(&mut reader.lost)
    }

    /// Puts back the last collection from a state topic: its messages come again. False for an event topic, whose
    /// messages stay in the inbox.
    pub(super) fn put_back(&mut self, place: u32, is_state: bool) -> bool {
        self.stirred[place as usize] = true;
        let reader = &mut self.readers[place as usize];
        for (entry, is_new) in reader.collected.drain(..) {
            if is_new {
                reader.known.remove(&entry);
            }
            reader.changed.push(entry);
        }
        let reported = std::mem::take(&mut reader.reported);
        reader.departed.splice(0..0, reported);
        is_state
    }

    /// Lets a reader receive again all that is retained in its region.
    pub(super) fn rewind(&mut self, place: u32, table: Option<&StateTable>) {
        self.stirred[place as usize] = true;
        let reader = &mut self.readers[place as usize];
        reader.known.clear();
        (reader.changed, reader.departed) = Default::default();
        (reader.collected, reader.reported) = Default::default();
        self.look_around(place, table);
    }

    #[cfg(test)]
    pub(super) fn waiting_changes(&self, place: u32) -> usize {
        self.readers[place as usize].changed.len()
    }

    pub(super) fn resize(&mut self, place: u32, queue: usize) {
        self.readers[place as usize].queue = queue.max(1);
    }
}

impl RegionReader {
    fn has_news(&self) -> bool {
        !(self.events.is_empty() && self.changed.is_empty() && self.departed.is_empty()) || self.lost > 0
    }

    /// Makes the changes of one entry one, once there are many.
    fn tidy(&mut self) {
        if self.changed.len() >= self.tidy_at {
            self.changed.sort_unstable();
            self.changed.dedup();
            self.tidy_at = TIDY.max(2 * self.changed.len());
        }
    }

    fn collect_changes(&mut self, table: &StateTable, inbox: &mut Vec<SharedMessage>) {
        let mut changed = std::mem::take(&mut self.changed);
        changed.sort_unstable_by_key(|entry| (table.change(*entry), *entry));
        changed.dedup();
        self.collected.clear();
        for entry in changed.drain(..) {
            let message = table.message(entry);
            if is_in(&self.region, message) {
                let departed = Departed { sender: message.header().sender, key: message.key().unwrap_or_default() };
                let is_new = self.known.insert(entry, departed).is_none();
                self.collected.push((entry, is_new));
                inbox.push(message.clone());
            } else if let Some(departed) = self.known.remove(&entry) {
                self.departed.push((entry, departed));
            }
        }
        self.changed = changed;
    }
}

fn is_in(region: &Region, message: &SharedMessage) -> bool {
    message.place().is_some_and(|block| region.contains(block))
}
