//! What waits for the thread that writes.

use std::mem;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::drawer::{Heard, HeardTopic};
use crate::file::{ChannelForm, Item};

/// Bytes that wait at most, beside those of one message.
const MOST: usize = 32 << 20;
/// Messages that wait at most, and as many that only drawings hear.
const MOST_ITEMS: usize = 1 << 18;
/// Bytes that wake the thread; fewer wait until it wakes by itself.
const WAKE: usize = 1 << 19;

/// Messages in the order in which they came, and the channels that are new with them.
#[derive(Default)]
pub(crate) struct Batch {
    /// The channels, which have numbers in the order in which they come, from 0 on.
    pub(crate) channels: Vec<ChannelForm>,
    pub(crate) items: Vec<Item>,
    pub(crate) bytes: Vec<u8>,
    /// What drawings hear, in its order.
    pub(crate) heard: Vec<Heard>,
    /// True if nothing follows.
    pub(crate) is_last: bool,
}

#[derive(Default)]
struct Waiting {
    batch: Batch,
    reader_sleeps: bool,
    writers_sleep: bool,
    closed: bool,
}

/// A queue with an end: who puts something into a full one waits in virtual time, and else does not get it in.
pub(crate) struct Queue {
    waiting: Mutex<Waiting>,
    filled: Condvar,
    emptied: Condvar,
}

impl Queue {
    pub(crate) fn new() -> Queue {
        Queue { waiting: Mutex::default(), filled: Condvar::new(), emptied: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a channel.
    pub(crate) fn open(&self, channel: ChannelForm) {
        self.lock().batch.channels.push(channel);
    }

    /// Has drawings hear a topic.
    pub(crate) fn hear(&self, topic: HeardTopic) {
        self.lock().batch.heard.push(Heard::Topic(topic));
    }

    /// Adds messages with their bytes, and what drawings hear of them; false if there is no room.
    pub(crate) fn put(&self, items: &[Item], bytes: &[u8], heard: Option<Heard>, waits: bool) -> bool {
        let mut waiting = self.lock();
        while waiting.batch.is_full_for(bytes.len()) {
            if !waits || waiting.closed {
                return false;
            }
            waiting.writers_sleep = true;
            self.wake(&mut waiting);
            waiting = self.emptied.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
        let start = waiting.batch.bytes.len();
        waiting.batch.bytes.extend_from_slice(bytes);
        waiting.batch.items.extend(items.iter().map(|item| Item { end: start + item.end, ..item.clone() }));
        waiting.batch.heard.extend(heard);
        if waiting.batch.is_much() {
            self.wake(&mut waiting);
        }
        true
    }

    fn wake(&self, waiting: &mut Waiting) {
        if mem::take(&mut waiting.reader_sleeps) {
            self.filled.notify_one();
        }
    }

    /// Nothing follows.
    pub(crate) fn close(&self) {
        let mut waiting = self.lock();
        waiting.closed = true;
        self.wake(&mut waiting);
        drop(waiting);
        self.emptied.notify_all();
    }

    /// What has come until a moment, or earlier if it is much. The batch that is given is reused.
    pub(crate) fn take(&self, until: Instant, mut empty: Batch) -> Batch {
        empty.channels.clear();
        empty.items.clear();
        empty.bytes.clear();
        empty.heard.clear();
        let mut waiting = self.lock();
        while !waiting.batch.is_much() && !waiting.closed && !waiting.writers_sleep {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            waiting.reader_sleeps = true;
            waiting = self.filled.wait_timeout(waiting, left).unwrap_or_else(PoisonError::into_inner).0;
        }
        waiting.reader_sleeps = false;
        let mut batch = mem::replace(&mut waiting.batch, empty);
        batch.is_last = waiting.closed;
        if mem::take(&mut waiting.writers_sleep) {
            self.emptied.notify_all();
        }
        batch
    }
}

impl Batch {
    fn is_full_for(&self, more: usize) -> bool {
        let is_full = self.bytes.len() + more > MOST || self.items.len() >= MOST_ITEMS;
        !self.items.is_empty() && is_full || self.heard.len() >= MOST_ITEMS
    }

    /// True if the thread is woken for it.
    fn is_much(&self) -> bool {
        self.bytes.len() >= WAKE || self.items.len().max(self.heard.len()) >= MOST_ITEMS / 2
    }
}

#[cfg(test)]
mod tests {
    use std::thread;
    use std::time::Duration;

    use super::*;

    fn put(queue: &Queue, bytes: &[u8], waits: bool) -> bool {
        queue.put(&[Item { channel: 0, sender: None, time: 0, end: bytes.len() }], bytes, None, waits)
    }

    #[test]
    fn a_full_queue_refuses_or_waits() {
        let queue = Queue::new();
        let large = vec![7; MOST / 2 + 1];
        assert!(put(&queue, &large, false));
        assert!(!put(&queue, &large, false), "there is no room");
        let now = Instant::now() + Duration::from_secs(60);
        thread::scope(|scope| {
            let waits = scope.spawn(|| put(&queue, &large, true));
            let batch = queue.take(now, Batch::default());
            assert_eq!((batch.items.len(), batch.is_last), (1, false));
            assert!(waits.join().unwrap());
        });
        queue.close();
        let batch = queue.take(now, Batch::default());
        assert_eq!((batch.items.len(), batch.bytes.len(), batch.is_last), (1, large.len(), true));
    }
}
