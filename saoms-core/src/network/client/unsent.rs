//! What a transport had no room for.

use std::collections::VecDeque;
use std::sync::Arc;

/// Bytes that wait for it, at most. What comes beyond is dropped, as networks drop it: who lacks it asks for it.
pub(super) const MOST_BYTES: usize = 64 << 20;

/// Something that is to be put.
#[derive(Debug)]
pub(super) struct Unsent {
    pub(super) key: String,
    pub(super) bytes: Arc<[u8]>,
    /// The envelope of messages of components.
    pub(super) envelope: Option<Arc<[u8]>>,
    pub(super) is_urgent: bool,
}

/// What waits for room in the transport, in order.
#[derive(Debug, Default)]
pub(super) struct UnsentQueue {
    all: VecDeque<Unsent>,
    bytes: usize,
}

impl UnsentQueue {
    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Lets something wait, if there is room for it.
    pub(super) fn push(&mut self, unsent: Unsent) {
        let size = size(&unsent);
        if self.bytes + size <= MOST_BYTES {
            self.bytes += size;
            self.all.push_back(unsent);
        }
    }

    /// Takes from the front what this puts.
    pub(super) fn put(&mut self, put: impl Fn(&Unsent) -> bool) {
        while let Some(first) = self.all.pop_front_if(|first| put(first)) {
            self.bytes -= size(&first);
        }
    }
}

fn size(Unsent { key, bytes, envelope, .. }: &Unsent) -> usize {
    key.len() + bytes.len() + envelope.as_ref().map_or(0, |envelope| envelope.len()) + size_of::<Unsent>()
}
