//! The messages of this program on one topic, as long as another program may lack them.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::sync::Arc;

use super::cells::Cells;
use super::wire::InCell;
use crate::bus::Cell;

/// A message that was sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Sent {
    /// Its number on its topic.
    pub(super) number: u64,
    pub(super) component: Arc<str>,
    /// The component that it is for; `None`: all readers.
    pub(super) to: Option<Arc<str>>,
    pub(super) key: Option<u64>,
    /// Wall clock of its sending, in nanoseconds since 1970.
    pub(super) sent: u64,
    pub(super) schema: u64,
    pub(super) cause: u64,
    pub(super) bytes: Arc<[u8]>,
    /// The cells that it concerns.
    pub(super) cells: Vec<InCell>,
}

impl Sent {
    /// Its component and key.
    pub(super) fn key(&self) -> StateKey {
        (Arc::clone(&self.component), self.key)
    }

    /// The cell that it is in.
    pub(super) fn cell(&self) -> Option<Cell> {
        self.cells.iter().find(|cell| !cell.has_left).map(|cell| (cell.x, cell.y))
    }

    fn size(&self) -> usize {
        // What stands around its bytes counts, too: small messages are the usual ones.
        self.bytes.len() + size_of::<Sent>() + 64
    }
}

/// Key of a message of a state topic: its component, and its own key.
pub(super) type StateKey = (Arc<str>, Option<u64>);

/// What is kept to be sent again.
#[derive(Debug)]
pub(super) enum Kept {
    /// Of an event topic: all that a reader may lack.
    Events(VecDeque<Sent>),
    /// Of a state topic: the newest of each key, by number.
    States { newest: BTreeMap<u64, Sent>, numbers: HashMap<StateKey, u64> },
}

/// The outgoing messages of a topic.
#[derive(Debug)]
pub(super) struct Outgoing {
    /// The number of the last message.
    pub(super) last: u64,
    pub(super) kept: Kept,
    /// The size of what is kept, in bytes.
    pub(super) size: usize,
    /// Of a state topic whose messages have a place, where they are.
    pub(super) cells: Option<Cells>,
    /// The number of the last message of an earlier start.
    pub(super) before: u64,
    /// The number of the first event that may be in the state folder.
    pub(super) stored: u64,
    /// Events that found no room on their way here, without numbers yet: readers hear of them once nothing is kept.
    pub(super) owed: u64,
}

impl Outgoing {
    pub(super) fn new(is_state: bool) -> Outgoing {
        let kept = match is_state {
            true => Kept::States { newest: BTreeMap::new(), numbers: HashMap::new() },
            false => Kept::Events(VecDeque::new()),
        };
        Outgoing { last: 0, kept, size: 0, cells: None, before: 0, stored: 1, owed: 0 }
    }

    pub(super) fn is_state(&self) -> bool {
        matches!(self.kept, Kept::States { .. })
    }

    /// Keeps a message, whose number is the next one.
    pub(super) fn keep(&mut self, sent: Sent) {
        self.last = sent.number;
        self.size += sent.size();
        match &mut self.kept {
            Kept::Events(events) => events.push_back(sent),
            Kept::States { newest, numbers } => {
                let key = sent.key();
                if let Some(before) = numbers.insert(key, sent.number).and_then(|number| newest.remove(&number)) {
                    self.size -= before.size();
                }
                newest.insert(sent.number, sent);
            }
        }
    }

    /// The newest message of a state topic with this component and key.
    pub(super) fn newest(&self, key: &StateKey) -> Option<&Sent> {
        match &self.kept {
            Kept::Events(_) => None,
            Kept::States { newest, numbers } => newest.get(numbers.get(key)?),
        }
    }

    /// Notes in which cell the next message of a state topic is. Gives those that it concerns.
    pub(super) fn place(&mut self, key: &StateKey, cell: Option<Cell>) -> Vec<InCell> {
        if !self.is_state() || cell.is_none() && self.cells.is_none() {
            return Vec::new();
        }
        let (number, before) = (self.last + 1, self.newest(key).and_then(Sent::cell));
        self.cells.get_or_insert_default().note(number, before, cell)
    }

    /// The number of the first message that can be sent again.
    pub(super) fn oldest(&self) -> u64 {
        match &self.kept {
            Kept::Events(events) => events.front().map_or(self.last + 1, |sent| sent.number),
            // What is not there any more is outdated, and nobody lacks it.
            Kept::States { .. } => 1,
        }
    }

    /// Forgets events before this number. Gives how many these were.
    pub(super) fn forget_before(&mut self, number: u64) -> u64 {
        let Kept::Events(events) = &mut self.kept else { return 0 };
        let mut count = 0;
        while let Some(sent) = events.pop_front_if(|sent| sent.number < number) {
            self.size -= sent.size();
            count += 1;
        }
        count
    }

    /// The next message has this number: those before it that were not kept are lost. So are kept ones before them,
    /// since nothing says that some in between are missing. Gives how many these were.
    pub(super) fn skip_before(&mut self, number: u64) -> u64 {
        let count = self.forget_before(number);
        self.last = self.last.max(number - 1);
        count
    }

    /// Gives numbers to events that found no room, after all others. True if there are some: readers have to learn it.
    pub(super) fn number_owed(&mut self) -> bool {
        let owed = std::mem::take(&mut self.owed);
        self.last = self.last.saturating_add(owed);
        owed > 0
    }

    /// The size of the kept events from a number up to before another one, in bytes, as far as they are of the same
    /// size.
    pub(super) fn size_between(&self, first: u64, end: u64) -> usize {
        let Kept::Events(events) = &self.kept else { return 0 };
        let place = |number: u64| events.partition_point(|sent| sent.number < number);
        let count = place(end).saturating_sub(place(first));
        self.size / events.len().max(1) * count
    }

    /// The kept messages of these numbers.
    pub(super) fn between(&self, first: u64, last: u64) -> Box<dyn Iterator<Item = &Sent> + '_> {
        match &self.kept {
            Kept::Events(events) => {
                let skipped = events.partition_point(|sent| sent.number < first);
                Box::new(events.iter().skip(skipped).take_while(move |sent| sent.number <= last))
            }
            Kept::States { .. } if first > last => Box::new(std::iter::empty()),
            Kept::States { newest, .. } => Box::new(newest.range(first..=last).map(|(_, sent)| sent)),
        }
    }
}
