//! What leaves the program once the next cut is committed.

use std::collections::HashSet;
use std::mem;
use std::sync::Arc;

use crate::network::FromRun;

/// Number of messages that wait without a look at which of them are outdated.
const MANY: usize = 1024;

/// The same of their bytes.
pub(in crate::schedule::engine) const MUCH: usize = 8 << 20;

/// Messages for networks, in their order. A full disk may stay full for long: states that newer ones replace are
/// removed then, as on a network that is slow.
#[derive(Debug, Default)]
pub(super) struct Outgoing {
    all: Vec<(u8, FromRun)>,
    bytes: usize,
    /// Number of messages and of bytes beyond which it is looked for outdated ones.
    most: usize,
    most_bytes: usize,
}

/// What a state is replaced by: a later one with the same.
type StateKey = (u8, Arc<str>, Arc<str>, Option<Arc<str>>, Option<u64>);

fn size(from_run: &FromRun) -> usize {
    match from_run {
        FromRun::Message { message, .. } => mem::size_of::<(u8, FromRun)>() + message.bytes().len(),
        _ => mem::size_of::<(u8, FromRun)>(),
    }
}

fn state_key((network, from_run): &(u8, FromRun)) -> Option<StateKey> {
    match from_run {
        FromRun::Message { topic, component, to, is_state: true, message, .. } => {
            Some((*network, Arc::clone(topic), Arc::clone(component), to.clone(), message.key()))
        }
        _ => None,
    }
}

impl Outgoing {
    pub(super) fn push(&mut self, network: u8, from_run: FromRun) {
        self.bytes += size(&from_run);
        self.all.push((network, from_run));
        if self.all.len() > self.most.max(MANY) || self.bytes > self.most_bytes.max(MUCH) {
            self.thin_out();
            (self.most, self.most_bytes) = (2 * self.all.len(), 2 * self.bytes);
        }
    }

    #[cold]
    fn thin_out(&mut self) {
        let mut newer = HashSet::new();
        let mut kept: Vec<(u8, FromRun)> = Vec::new();
        for one in self.all.drain(..).rev() {
            if state_key(&one).is_none_or(|key| newer.insert(key)) {
                kept.push(one);
            } else {
                self.bytes -= size(&one.1);
            }
        }
        kept.reverse();
        self.all = kept;
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Number of bytes, roughly.
    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }

    /// All of it, in its order.
    pub(super) fn into_all(self) -> Vec<(u8, FromRun)> {
        self.all
    }
}

#[cfg(test)]
mod tests {
    use saoms_api::host::SharedMessage;
    use saoms_api::{Cause, Header, Time};

    use super::*;

    fn message(component: &str, is_state: bool, number: u64) -> FromRun {
        message_of(1000, component, is_state, number)
    }

    fn message_of(size: usize, component: &str, is_state: bool, number: u64) -> FromRun {
        let header = Header { sender: 0, sent: Time::from_nanos(number), cause: Cause::default() };
        let message = SharedMessage::from_bytes(header, None, vec![0; size]).of(Some(number % 3), None);
        let (topic, component) = ("TOPIC".into(), component.into());
        FromRun::Message { topic, component, to: None, is_state, schema: 0, number: None, message }
    }

    #[test]
    fn large_states_are_replaced_before_there_are_many() {
        let mut outgoing = Outgoing::default();
        for number in 0..500 {
            outgoing.push(0, message_of(1 << 20, "A", true, number));
            assert!(outgoing.bytes() < 2 * MUCH, "{number}: {}", outgoing.bytes());
        }
        assert!(outgoing.len() >= 3);
    }

    #[test]
    fn states_that_wait_for_long_are_replaced_by_newer_ones() {
        let mut outgoing = Outgoing::default();
        for number in 0..100_000 {
            outgoing.push(0, message(["A", "B"][number as usize % 2], true, number));
            outgoing.push(1, message("A", true, number));
            if number % 1000 == 0 {
                outgoing.push(0, message("A", false, number));
            }
            assert!(outgoing.len() <= MANY.max(2 * (9 + 100)), "{number}");
            assert!(outgoing.bytes() >= 1000 * outgoing.len());
        }
        let all = outgoing.into_all();
        let sent = |(_, from_run): &(u8, FromRun)| match from_run {
            FromRun::Message { message, .. } => message.header().sent,
            _ => Time::START,
        };
        assert!(all.is_sorted_by_key(sent), "they leave in their order");
        let events = |(_, from_run): &&(u8, FromRun)| matches!(from_run, FromRun::Message { is_state: false, .. });
        assert_eq!(all.iter().filter(events).count(), 100, "no event is lost");
        let newest: Vec<u64> = all.iter().rev().take(6).map(|one| sent(one).as_nanos()).collect();
        assert_eq!(newest, [99_999, 99_999, 99_998, 99_998, 99_997, 99_997]);
    }
}
