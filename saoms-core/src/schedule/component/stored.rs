use std::sync::Arc;

use crate::store::Entries;

/// What a component keeps beyond its crash.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stored {
    entries: Entries,
    size: usize,
    /// True if an earlier program left the entries, and none has changed since.
    is_earlier: bool,
}

/// Bytes under a number, or their removal.
pub(crate) type StoredChange = (u64, Option<Arc<[u8]>>);

impl Stored {
    pub(crate) fn new(entries: Entries) -> Stored {
        let size = entries.values().map(|bytes| bytes.len()).sum();
        Stored { is_earlier: !entries.is_empty(), entries, size }
    }

    pub(crate) fn entries(&self) -> &Entries {
        &self.entries
    }

    /// True if an earlier program left the entries, and none has changed since.
    pub(crate) fn is_earlier(&self) -> bool {
        self.is_earlier
    }

    /// Number of bytes of all entries.
    pub(crate) fn size(&self) -> usize {
        self.size
    }

    /// Makes a change, and gives the one that takes it back.
    pub(crate) fn change(&mut self, (key, bytes): StoredChange) -> StoredChange {
        self.is_earlier = false;
        self.size += bytes.as_ref().map_or(0, |bytes| bytes.len());
        let before = match bytes {
            Some(bytes) => self.entries.insert(key, bytes),
            None => self.entries.remove(&key),
        };
        self.size -= before.as_ref().map_or(0, |before| before.len());
        (key, before)
    }
}
