//! The messages of another program on one topic, on their way to the components of this one.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::sync::Arc;

use super::around::ReadCells;
use super::outgoing::StateKey;
use super::wire::{Covered, InCell, KnownState};
use crate::bus::Cell;

/// A message of another program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrived {
    /// The component that sent it: its path.
    pub component: Arc<str>,
    /// The component that it is for; empty: all readers of the topic.
    pub to: String,
    /// The key, of a message of a state topic.
    pub key: Option<u64>,
    /// Wall clock of its sending, in nanoseconds since 1970.
    pub sent: u64,
    /// The record of the sender's journal with the reason; 0 is none.
    pub cause: u64,
    /// The message.
    pub bytes: Vec<u8>,
    /// The first start of the program that sent it.
    pub origin: u64,
    /// Its number there, on its topic.
    pub number: u64,
}

/// Signs of life that say what was received, since some of them may be lost.
const REPEATS: u32 = 4;
/// Messages that wait for an earlier one, at most.
pub(super) const MOST_WAITING: usize = 16_384;

/// The incoming messages of a topic.
#[derive(Debug, Default)]
pub(super) struct Incoming {
    /// The number of the first message that was not received; 0: the sender has not said where this program begins.
    pub(super) next: u64,
    /// The number of the first message that was not carried out: with a state folder, this is what the sender hears.
    pub(super) done: u64,
    /// The number of the last message that the sender is known to have sent.
    pub(super) last: u64,
    /// Those that came before an earlier one. Of a state topic their content has been delivered.
    waiting: BTreeMap<u64, Option<Arrived>>,
    /// Of a state topic, messages that are outdated: the number of the first of each stretch, with that of the last.
    outdated: BTreeMap<u64, u64>,
    /// Of a state topic, the number of the newest message of each component and key, and its cell.
    newest: HashMap<StateKey, (u64, Option<Cell>)>,
    /// Of a state topic, true if the sender says in which cells its messages are.
    pub(super) is_by_cells: bool,
    /// Of such a topic, what is read of it, if that is not all.
    pub(super) around: Option<ReadCells>,
    /// Time at which missing messages are asked for (again).
    pub(super) ask_at: Option<u64>,
    /// Number of times that they were asked for without an answer.
    pub(super) asked: u32,
    /// The number of the last message that was asked for.
    pub(super) asked_up_to: u64,
    /// The number of the first missing message when somebody looked last.
    pub(super) seen: u64,
    /// What signs of life said of it, and how many did since it was that.
    said: (u64, u32),
}

impl Incoming {
    /// Those of a program of which an earlier start of this one had received all up to this number.
    pub(super) fn after(next: u64) -> Incoming {
        Incoming { next, done: next, ..Incoming::default() }
    }

    /// Takes a message of an event topic. Adds what can be delivered now to `ready`, in order.
    pub(super) fn take_event(&mut self, number: u64, arrived: Arrived, ready: &mut Vec<Arrived>) {
        self.last = self.last.max(number);
        if number == self.next && number != 0 && self.waiting.is_empty() {
            self.next += 1;
            ready.push(arrived);
            return;
        }
        if self.next != 0 && number < self.next || self.waiting.len() >= MOST_WAITING && number != self.next {
            return;
        }
        self.waiting.insert(number, Some(arrived));
        ready.extend(self.advance());
    }

    /// Takes a message of a state topic, which waits for no other. Gives it unless a newer one of its component and key
    /// was here before.
    pub(super) fn take_state(&mut self, number: u64, arrived: Arrived, cells: &[InCell]) -> Option<Arrived> {
        self.last = self.last.max(number);
        let cell = cells.iter().find(|cell| !cell.has_left).map(|cell| (cell.x, cell.y));
        // What is not here, although all of its cell is, has left that meanwhile.
        let is_outdated = self.around.as_ref().zip(cell).is_some_and(|(around, cell)| around.has_all(cell, number));
        if let Some(around) = &mut self.around {
            cells.iter().for_each(|cell| around.take(number, *cell));
        } else if (self.next == 0 || number >= self.next) && self.waiting.len() < MOST_WAITING {
            self.waiting.insert(number, None);
            self.advance();
        }
        if is_outdated { None } else { self.take_newest(number, arrived, cell) }
    }

    /// Gives a message of a state topic, unless a newer one of its component and key was here before.
    pub(super) fn take_newest(&mut self, number: u64, arrived: Arrived, cell: Option<Cell>) -> Option<Arrived> {
        let newest = self.newest.entry((Arc::clone(&arrived.component), arrived.key)).or_default();
        (number > newest.0).then(|| {
            *newest = (number, cell);
            arrived
        })
    }

    /// The messages that are here, and were in these cells.
    pub(super) fn known_in(&self, cells: &BTreeSet<Cell>) -> Vec<KnownState> {
        let inside = self.newest.iter().filter(|(_, (_, cell))| cell.is_some_and(|cell| cells.contains(&cell)));
        let known = inside.map(|((component, key), (number, _))| KnownState {
            component: component.to_string(),
            key: key.unwrap_or_default(),
            has_key: key.is_some(),
            number: *number,
        });
        let mut known: Vec<KnownState> = known.collect();
        known.sort_unstable_by_key(|known| known.number);
        known
    }

    /// The cells in which messages are here, up to this number, that are not among those that are there.
    pub(super) fn ghosts(&self, cells: &BTreeSet<Cell>, last: u64, here: &HashSet<u64>) -> BTreeSet<Cell> {
        let gone = self.newest.values().filter(|(number, _)| *number <= last && !here.contains(number));
        gone.filter_map(|(_, cell)| cell.filter(|cell| cells.contains(cell))).collect()
    }

    /// Reads all of a topic of which some cells were read: asks again for what there is.
    pub(super) fn read_all(&mut self) {
        if self.around.take().is_some() {
            (self.next, self.ask_at) = (1, None);
            (self.waiting, self.outdated) = Default::default();
        }
    }

    /// What a sign of life says of it: the number of the first message that may be missing, of those that concern what
    /// is read. `None` where that has been said: of a state topic nobody waits for it.
    pub(super) fn say_received(&mut self, is_state: bool, has_folder: bool, is_full: bool) -> Option<u64> {
        let next = if has_folder && !is_state { self.done } else { self.next };
        let next = self.around.as_ref().map_or(next, |around| around.next);
        if next == 0 {
            return None;
        }
        let (said, times) = &mut self.said;
        if *said == 0 || *said != next && !is_state {
            *times = 0;
        }
        *said = next;
        *times = times.saturating_add(1);
        (is_full || *times <= REPEATS).then_some(next)
    }

    /// The sender was started again, and goes on with its numbers.
    pub(super) fn go_on(&mut self) {
        (self.ask_at, self.last, self.said) = (None, 0, (0, 0));
    }

    /// The sender has no messages after this one any more: gives how many of them were not delivered.
    pub(super) fn drop_after(&mut self, number: u64) -> u64 {
        self.waiting.retain(|waiting, _| *waiting <= number);
        if self.next == 0 { 0 } else { self.last.saturating_sub(number.max(self.next - 1)) }
    }

    /// The sender says where this program begins, once. Gives what can be delivered now.
    pub(super) fn welcome(&mut self, first: u64) -> Vec<Arrived> {
        if self.next != 0 {
            return Vec::new();
        }
        (self.next, self.done) = (first.max(1), first.max(1));
        self.waiting = self.waiting.split_off(&self.next);
        self.advance()
    }

    /// Goes on behind messages that will not come. Gives their number, and what can be delivered now.
    pub(super) fn skip_to(&mut self, number: u64) -> (u64, Vec<Arrived>) {
        if self.next == 0 || number <= self.next {
            return (0, Vec::new());
        }
        let here = self.waiting.range(self.next..number).count() as u64;
        let missing = number - self.next - here;
        let later = self.waiting.split_off(&number);
        let mut ready: Vec<Arrived> = std::mem::replace(&mut self.waiting, later).into_values().flatten().collect();
        self.next = number;
        ready.extend(self.advance());
        (missing, ready)
    }

    /// Does not wait for messages of a state topic that are outdated: of those that the sender is known to have sent.
    pub(super) fn skip_outdated(&mut self, covered: &Covered) {
        let end = covered.last.min(self.last) + 1;
        if self.next == 0 {
            return;
        }
        let mut first = covered.first.max(self.next);
        for number in covered.numbers.iter().copied().filter(|number| *number < end).chain([end]) {
            if number > first {
                self.outdated.insert(first, number - 1);
            }
            first = first.max(number + 1);
        }
        self.advance();
    }

    /// The numbers of the first messages that are missing.
    pub(super) fn missing(&self) -> Option<(u64, u64)> {
        if self.next == 0 || self.next > self.last || self.around.is_some() {
            return None;
        }
        let waiting = self.waiting.first_key_value().map(|(number, _)| *number);
        let outdated = self.outdated.range(self.next..).next().map(|(number, _)| *number);
        let end = waiting.into_iter().chain(outdated).min().map_or(self.last, |number| number - 1);
        Some((self.next, end))
    }

    /// Number of the messages that are missing; `None` where there is none.
    pub(super) fn lacks(&self) -> Option<u64> {
        let (first, _) = self.missing()?;
        Some(self.last + 1 - first - self.waiting.range(first..=self.last).count() as u64)
    }

    fn advance(&mut self) -> Vec<Arrived> {
        let mut ready = Vec::new();
        if self.next == 0 {
            return ready;
        }
        loop {
            if let Some(entry) = self.waiting.first_entry().filter(|entry| *entry.key() <= self.next) {
                let number = *entry.key();
                let arrived = entry.remove();
                if number == self.next {
                    ready.extend(arrived);
                    self.next += 1;
                }
            } else if let Some(entry) = self.outdated.first_entry().filter(|entry| *entry.key() <= self.next) {
                self.next = self.next.max(entry.remove() + 1);
            } else {
                return ready;
            }
        }
    }
}
