//! Messages on their way, so that those of one sender stay in order.

use std::collections::BTreeMap;

use crate::bus::TopicId;

/// The messages on each link from each sender.
#[derive(Debug, Default)]
pub(super) struct Flights {
    all: BTreeMap<(TopicId, u32), Flight>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Flight {
    /// The latest time at which a message arrives.
    last: u64,
    /// Number of messages that have not arrived.
    count: u64,
}

impl Flights {
    /// The time at which a message arrives that keeps the order.
    pub(super) fn in_order(&mut self, link: TopicId, sender: u32, arrival: u64) -> u64 {
        let flight = self.all.entry((link, sender)).or_default();
        flight.last = flight.last.max(arrival);
        flight.last
    }

    /// True if messages of the sender are on their way.
    pub(super) fn are_open(&self, link: TopicId, sender: u32) -> bool {
        self.all.get(&(link, sender)).is_some_and(|flight| flight.count > 0)
    }

    pub(super) fn depart(&mut self, link: TopicId, sender: u32) {
        self.all.entry((link, sender)).or_default().count += 1;
    }

    pub(super) fn arrive(&mut self, link: TopicId, sender: u32) {
        if let Some(flight) = self.all.get_mut(&(link, sender)) {
            flight.count = flight.count.saturating_sub(1);
        }
    }
}
