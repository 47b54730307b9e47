use std::collections::VecDeque;

use saoms_api::host::SharedMessage;
use saoms_lang::assembly::TaskProperties;

/// The messages of an event topic, each once and until the slowest reader has read it, and the positions of the
/// readers.
///
/// Messages are numbered from 0. Messages that all readers have read are removed in batches, so that neither publishing
/// nor reading looks at other readers.
#[derive(Clone)]
pub(super) struct EventLog {
    /// The number of the first message held.
    first: u64,
    pub(super) messages: VecDeque<SharedMessage>,
    readers: Vec<EventReader>,
    free: Vec<u32>,
    /// Number of messages at which those that all readers have read are removed next.
    tidy_at: usize,
    /// Number of readers that have left since messages were removed.
    left: usize,
    /// Number of messages that may wait for a reader whose queue grows with the users of the topic.
    grown: u64,
}

#[derive(Clone)]
struct EventReader {
    /// The number of the next message to read.
    next: u64,
    /// Number of messages that may wait; 0 marks a free place, [`GROWS`] that it grows with the users of the topic.
    queue: u64,
    lost: u64,
}

const GROWS: u64 = u64::MAX;

fn length(queue: Option<usize>) -> u64 {
    queue.map_or(GROWS, |queue| queue.max(1) as u64)
}

impl EventReader {
    /// Gives up the oldest messages that do not fit into the queue.
    #[inline]
    fn overflow(&mut self, end: u64, grown: u64) {
        let oldest = end.saturating_sub(if self.queue == GROWS { grown } else { self.queue });
        if self.next < oldest {
            self.lost += oldest - self.next;
            self.next = oldest;
        }
    }
}

impl Default for EventLog {
    fn default() -> EventLog {
        let grown = TaskProperties::default_queue(0) as u64;
        EventLog {
            first: 0,
            messages: VecDeque::new(),
            readers: Vec::new(),
            free: Vec::new(),
            left: 0,
            tidy_at: 0,
            grown,
        }
    }
}

impl EventLog {
    /// Number of messages that wait for a reader, and of those that may wait.
    pub(super) fn waiting(&self, place: u32) -> (u64, u64) {
        let reader = &self.readers[place as usize];
        let queue = if reader.queue == GROWS { self.grown } else { reader.queue };
        ((self.end() - reader.next).min(queue), queue)
    }

    /// The number of the first message that a reader has not collected.
    pub(super) fn read_up_to(&self, place: u32) -> u64 {
        self.readers[place as usize].next
    }

    /// True unless a reader has half of its queue to read.
    pub(super) fn has_room(&self) -> bool {
        let readers = (0..).zip(&self.readers).filter(|(_, reader)| reader.queue > 0);
        let is_half_full = |place| {
            let (waiting, queue) = self.waiting(place);
            waiting > queue / 2
        };
        !readers.map(|(place, _)| place).any(is_half_full)
    }

    /// The messages that wait for a reader.
    pub(super) fn unread(&self, place: u32) -> impl Iterator<Item = &SharedMessage> {
        let (waiting, _) = self.waiting(place);
        self.messages.range(self.messages.len().saturating_sub(waiting as usize)..)
    }

    /// True if messages wait for a reader.
    pub(super) fn has_unread(&self) -> bool {
        let end = self.end();
        self.readers.iter().any(|reader| reader.queue > 0 && reader.next != end)
    }

    /// Users that leave change nothing: what they sent still waits.
    pub(super) fn set_users(&mut self, users: usize) {
        self.grown = self.grown.max(TaskProperties::default_queue(users) as u64);
    }

    /// The number of the next message.
    pub(super) fn end(&self) -> u64 {
        self.first + self.messages.len() as u64
    }

    pub(super) fn join(&mut self, queue: Option<usize>) -> u32 {
        let reader = EventReader { next: self.end(), queue: length(queue), lost: 0 };
        match self.free.pop() {
            Some(place) => {
                self.readers[place as usize] = reader;
                place
            }
            None => {
                self.readers.push(reader);
                (self.readers.len() - 1) as u32
            }
        }
    }

    /// Frees the places of all readers but one.
    pub(super) fn keep(&mut self, place: Option<u32>) {
        self.free.clear();
        for (other, reader) in (0..).zip(&mut self.readers) {
            if Some(other) != place {
                reader.queue = 0;
                self.free.push(other);
            }
        }
        self.tidy();
    }

    pub(super) fn resize(&mut self, place: u32, queue: Option<usize>) {
        self.readers[place as usize].queue = length(queue);
    }

    /// Frees a reader's place. Returns the number of messages that it lost since its last read.
    pub(super) fn leave(&mut self, place: u32) -> u64 {
        let (end, grown) = (self.end(), self.grown);
        let reader = &mut self.readers[place as usize];
        reader.overflow(end, grown);
        let lost = reader.lost;
        reader.queue = 0;
        self.free.push(place);
        self.left += 1;
        // Once for as many readers, since it looks at all: a fleet that ends has many.
        if self.free.len() == self.readers.len() || self.left > self.readers.len() / 4 {
            self.tidy();
        }
        lost
    }

    #[inline]
    pub(super) fn publish(&mut self, message: SharedMessage) {
        if self.readers.len() == self.free.len() {
            self.first += 1;
            return;
        }
        if self.messages.len() >= self.tidy_at {
            self.tidy();
        }
        self.messages.push_back(message);
    }

    /// Removes the messages that every reader has read. The cost is linear in the number of readers, and is paid once
    /// in as many messages.
    fn tidy(&mut self) {
        self.left = 0;
        let (end, grown) = (self.end(), self.grown);
        let mut needed = end;
        for reader in self.readers.iter_mut().filter(|reader| reader.queue > 0) {
            reader.overflow(end, grown);
            needed = needed.min(reader.next);
        }
        let done = (needed - self.first) as usize;
        self.messages.drain(..done);
        self.first = needed;
        self.tidy_at = self.messages.len() + 16 + self.readers.len() / 4;
    }

    /// True if there are messages that a reader has not read.
    pub(super) fn has_news(&self, place: u32) -> bool {
        self.readers[place as usize].next != self.end()
    }

    /// Appends the messages that are new to a reader. Returns the number of messages that it lost since its last read.
    #[inline]
    pub(super) fn collect(&mut self, place: u32, inbox: &mut Vec<SharedMessage>) -> u64 {
        let (end, grown) = (self.end(), self.grown);
        let reader = &mut self.readers[place as usize];
        if reader.next == end {
            return std::mem::take(&mut reader.lost);
        }
        reader.overflow(end, grown);
        let start = (reader.next - self.first) as usize;
        reader.next = end;
        let lost = std::mem::take(&mut reader.lost);
        inbox.extend(self.messages.range(start..).cloned());
        lost
    }
}
