//! The messages of another program on one topic, on their way to the components of this one.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::wire::Covered;

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
}

/// Messages that wait for an earlier one, at most.
pub(super) const MOST_WAITING: usize = 16_384;

/// The incoming messages of a topic.
#[derive(Debug, Default)]
pub(super) struct Incoming {
    /// The number of the first message that was not received; 0: the sender has not said where this program begins.
    pub(super) next: u64,
    /// The number of the last message that the sender is known to have sent.
    pub(super) last: u64,
    /// Those that came before an earlier one. Of a state topic their content has been delivered.
    waiting: BTreeMap<u64, Option<Arrived>>,
    /// Of a state topic, messages that are outdated: the number of the first of each stretch, with that of the last.
    outdated: BTreeMap<u64, u64>,
    /// Of a state topic, the number of the newest message of each component and key.
    newest: HashMap<(Arc<str>, Option<u64>), u64>,
    /// Time at which missing messages are asked for (again).
    pub(super) ask_at: Option<u64>,
    /// Number of times that they were asked for without an answer.
    pub(super) asked: u32,
    /// The number of the last message that was asked for.
    pub(super) asked_up_to: u64,
    /// The number of the first missing message when somebody looked last.
    pub(super) seen: u64,
}

impl Incoming {
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
    pub(super) fn take_state(&mut self, number: u64, arrived: Arrived) -> Option<Arrived> {
        self.last = self.last.max(number);
        if (self.next == 0 || number >= self.next) && self.waiting.len() < MOST_WAITING {
            self.waiting.insert(number, None);
            self.advance();
        }
        let newest = self.newest.entry((Arc::clone(&arrived.component), arrived.key)).or_default();
        (number > *newest).then(|| {
            *newest = number;
            arrived
        })
    }

    /// The sender says where this program begins, once. Gives what can be delivered now.
    pub(super) fn welcome(&mut self, first: u64) -> Vec<Arrived> {
        if self.next != 0 {
            return Vec::new();
        }
        self.next = first.max(1);
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

    /// Does not wait for messages of a state topic that are outdated.
    pub(super) fn skip_outdated(&mut self, covered: &Covered) {
        let mut first = covered.first.max(self.next);
        for number in covered.numbers.iter().copied().chain([covered.last.saturating_add(1)]) {
            if number > first {
                self.outdated.insert(first, number - 1);
            }
            first = first.max(number.saturating_add(1));
        }
        self.advance();
    }

    /// The numbers of the first messages that are missing.
    pub(super) fn missing(&self) -> Option<(u64, u64)> {
        if self.next == 0 || self.next > self.last {
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
