use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Queue of due times: a heap of absolute times. Equal times are in document order.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    heap: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Queue {
    pub(crate) fn push(&mut self, when: u64, component: u32) {
        self.heap.push(Reverse((when, component)));
    }

    /// The earliest time in the queue.
    pub(crate) fn earliest(&self) -> Option<u64> {
        self.heap.peek().map(|Reverse((when, _))| *when)
    }

    /// The components of the first two entries.
    #[inline]
    pub(crate) fn first_two(&self) -> [Option<u32>; 2] {
        // The second entry of a heap is one of the two below the first.
        let entries = self.heap.as_slice();
        let second = entries.iter().skip(1).take(2).max();
        [entries.first(), second].map(|entry| entry.map(|Reverse((_, component))| *component))
    }

    /// Takes the first entry, if it is due.
    pub(crate) fn pop_due(&mut self, now: u64) -> Option<(u64, u32)> {
        let Reverse((when, _)) = *self.heap.peek()?;
        if when > now {
            return None;
        }
        self.heap.pop().map(|Reverse(entry)| entry)
    }

    pub(crate) fn len(&self) -> usize {
        self.heap.len()
    }

    /// Removes the entries that are not valid any more.
    pub(crate) fn retain(&mut self, mut holds: impl FnMut(u64, u32) -> bool) {
        self.heap.retain(|Reverse((when, component))| holds(*when, *component));
    }

    pub(crate) fn clear(&mut self) {
        self.heap.clear();
    }
}
