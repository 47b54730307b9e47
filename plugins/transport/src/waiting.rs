//! What waits to be written to a broker, and what the program wants of it.

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use crate::link::{Cut, Link};

/// Bytes that are written at once, about.
pub(crate) const BATCH: usize = 64 << 10;

/// What the program wants, by its keys.
#[derive(Default)]
pub(crate) struct Subscriptions {
    pub(crate) all: HashMap<Arc<str>, Subscription>,
    pub(crate) last: u16,
}

pub(crate) struct Subscription {
    /// Its number at the broker.
    pub(crate) number: u16,
    pub(crate) tokens: Vec<u64>,
}

/// What waits to be written.
#[derive(Default)]
pub(crate) struct Queue {
    pub(crate) urgent: Lane,
    pub(crate) usual: Lane,
    /// The connection, while there is one that is joined.
    pub(crate) link: Option<Arc<Link>>,
    /// The end of a connection that is about to be joined, by which it is cut.
    pub(crate) joining: Option<Cut>,
    /// The longest frame that the broker takes.
    pub(crate) longest: usize,
    pub(crate) is_closed: bool,
    /// True once the thread that connects has ended.
    pub(crate) has_ended: bool,
}

/// Frames that wait in their order.
#[derive(Default)]
pub(crate) struct Lane {
    pub(crate) frames: VecDeque<Vec<u8>>,
    pub(crate) bytes: usize,
}

impl Lane {
    pub(crate) fn add(&mut self, frame: Vec<u8>) {
        self.bytes += frame.len();
        self.frames.push_back(frame);
    }

    pub(crate) fn take(&mut self) -> Option<Vec<u8>> {
        let frame = self.frames.pop_front()?;
        self.bytes -= frame.len();
        Some(frame)
    }
}

impl Queue {
    /// Takes as much as is written at once.
    pub(crate) fn take(&mut self) -> Vec<u8> {
        let mut batch = Vec::new();
        while batch.len() < BATCH {
            let Some(frame) = self.urgent.take().or_else(|| self.usual.take()) else { break };
            if batch.is_empty() {
                batch = frame;
            } else {
                batch.extend_from_slice(&frame);
            }
        }
        batch
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.urgent.frames.is_empty() && self.usual.frames.is_empty()
    }
}

impl Subscriptions {
    /// A number that no subscription has.
    pub(crate) fn free(&mut self) -> Option<u16> {
        if self.all.len() >= usize::from(u16::MAX) {
            return None;
        }
        loop {
            self.last = self.last.checked_add(1).unwrap_or(1);
            if self.all.values().all(|one| one.number != self.last) {
                return Some(self.last);
            }
        }
    }

    /// Removes a token; gives the keys that nobody wants any more, and their number.
    pub(crate) fn remove(&mut self, token: u64) -> Option<(Arc<str>, u16)> {
        let (keys, one) = self.all.iter_mut().find(|(_, one)| one.tokens.contains(&token))?;
        one.tokens.retain(|other| *other != token);
        let gone = one.tokens.is_empty().then(|| (Arc::clone(keys), one.number))?;
        self.all.remove(&gone.0);
        Some(gone)
    }
}
