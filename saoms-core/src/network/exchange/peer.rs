//! What is known of another program.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::call::Served;
use super::incoming::Incoming;
use super::memory::KnownReader;
use super::wire::Vote;

/// Another program of the network.
#[derive(Debug)]
pub(super) struct Peer {
    pub(super) name: Arc<str>,
    /// The first program that had its state folder, and the number of its start; 0 without a state folder.
    pub(super) origin: u64,
    pub(super) start: u64,
    /// When it began, as it says.
    pub(super) began: u64,
    /// True if it is known from an earlier start of this program, and was not heard since.
    pub(super) is_recalled: bool,
    /// What the state folder knows of it.
    pub(super) known: Option<KnownReader>,
    /// The number of its last sign of life.
    pub(super) sign: u64,
    /// When it was heard first, and last.
    pub(super) since: u64,
    pub(super) heard: u64,
    /// Time after which it is missed, in nanoseconds.
    pub(super) patience: u64,
    pub(super) vote: Vote,
    pub(super) is_reachable: bool,
    /// True if nothing is kept for it any more: it was away for too long.
    pub(super) is_given_up: bool,
    /// True if components of it run in a program that began later: nothing is kept for it, and it has no vote.
    pub(super) is_over: bool,
    /// Number of its signs of life that were heard, as far as that matters.
    pub(super) signs: u8,
    /// Of each topic of this program that it reads, where it begins and what it has received.
    pub(super) reading: BTreeMap<Arc<str>, Reading>,
    /// What arrives from it on each topic that this program reads.
    pub(super) incoming: BTreeMap<Arc<str>, Incoming>,
    /// The topics whose messages have another schema there.
    pub(super) differing: BTreeSet<Arc<str>>,
    /// Its last call on each of its lines.
    pub(super) served: BTreeMap<u64, Served>,
}

/// The state of a reader of a topic.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reading {
    /// The number of the first message that it lacks.
    pub(super) next: u64,
    /// True if it knows where it begins.
    pub(super) is_welcomed: bool,
    /// Of a program that was given up: what it lacks before this number was counted as lost.
    pub(super) counted: u64,
}

impl Peer {
    pub(super) fn new(name: &str, now: u64) -> Peer {
        Peer {
            name: Arc::from(name),
            origin: 0,
            start: 0,
            began: 0,
            is_recalled: false,
            known: None,
            sign: 0,
            since: now,
            heard: 0,
            patience: 0,
            vote: Vote::Open,
            is_reachable: true,
            is_given_up: false,
            is_over: false,
            signs: 0,
            reading: BTreeMap::new(),
            incoming: BTreeMap::new(),
            differing: BTreeSet::new(),
            served: BTreeMap::new(),
        }
    }

    /// True if a program that ends waits for it, and lingers for so long: it is there, or was heard within that time.
    pub(super) fn is_awaited(&self, now: u64, linger: u64) -> bool {
        self.is_reachable || now.saturating_sub(self.heard) <= linger
    }

    /// The number of the first message of a topic that it may ask for; `None` if it asks for none.
    pub(super) fn needs(&self, topic: &str) -> Option<u64> {
        self.reading.get(topic).filter(|_| !self.is_given_up && !self.is_over).map(|reading| reading.next)
    }
}
