use std::collections::HashMap;

use saoms_api::host::SharedMessage;

use super::hash::KeyHashing;

const NONE: u32 = u32::MAX;

/// Greatest number of keys of one publisher, since no message that is retained ever leaves: ten for each of 10,000
/// robots.
pub(crate) const MOST_KEYS: u32 = 100_000;

/// The messages that a state topic retains: the newest one of each key from each publisher, linked in the order of
/// their changes. A publisher never replaces a message of another publisher, as with the transient-local durability of
/// DDS.
///
/// A publisher has a [bounded](MOST_KEYS) number of keys.
///
/// A change moves its entry to the end, whatever the number of readers. A reader walks back from the end to the last
/// change it knows.
#[derive(Clone)]
pub(super) struct StateTable {
    entries: Vec<Entry>,
    /// Place of the message of a publisher and key.
    places: HashMap<(u32, u64), u32, KeyHashing>,
    /// Number of keys of each publisher.
    keys: HashMap<u32, u32>,
    newest: u32,
    changes: u64,
}

#[derive(Clone)]
struct Entry {
    message: SharedMessage,
    change: u64,
    older: u32,
    newer: u32,
}

impl Default for StateTable {
    fn default() -> StateTable {
        StateTable { entries: Vec::new(), places: HashMap::default(), keys: HashMap::new(), newest: NONE, changes: 0 }
    }
}

impl StateTable {
    /// Takes in a message; gives its entry, and the message that it replaces. `None` if its publisher has too many
    /// keys for a further one.
    pub(super) fn publish(&mut self, message: SharedMessage) -> Option<(u32, Option<SharedMessage>)> {
        // Either all messages of a topic have a key, or none has.
        let key = (message.header().sender, message.key().unwrap_or_default());
        if let Some(&place) = self.places.get(&key) {
            self.changes += 1;
            self.unlink(place);
            let entry = &mut self.entries[place as usize];
            let before = std::mem::replace(&mut entry.message, message);
            entry.change = self.changes;
            self.link(place);
            return Some((place, Some(before)));
        }
        let keys = self.keys.entry(key.0).or_default();
        if *keys >= MOST_KEYS {
            return None;
        }
        *keys += 1;
        self.changes += 1;
        let place = u32::try_from(self.entries.len()).unwrap_or(NONE);
        self.entries.push(Entry { message, change: self.changes, older: NONE, newer: NONE });
        self.places.insert(key, place);
        self.link(place);
        Some((place, None))
    }

    /// The retained messages, by their entries.
    pub(super) fn messages(&self) -> impl Iterator<Item = (u32, &SharedMessage)> {
        (0..).zip(self.entries.iter().map(|entry| &entry.message))
    }

    pub(super) fn message(&self, entry: u32) -> &SharedMessage {
        &self.entries[entry as usize].message
    }

    /// Number of the last change of an entry.
    pub(super) fn change(&self, entry: u32) -> u64 {
        self.entries[entry as usize].change
    }

    fn unlink(&mut self, place: u32) {
        let Entry { older, newer, .. } = self.entries[place as usize];
        match newer {
            NONE => self.newest = older,
            newer => self.entries[newer as usize].older = older,
        }
        if older != NONE {
            self.entries[older as usize].newer = newer;
        }
    }

    fn link(&mut self, place: u32) {
        let newest = std::mem::replace(&mut self.newest, place);
        if newest != NONE {
            self.entries[newest as usize].newer = place;
        }
        let entry = &mut self.entries[place as usize];
        entry.older = newest;
        entry.newer = NONE;
    }

    /// True if something changed after the `read`-th change.
    pub(super) fn has_news(&self, read: u64) -> bool {
        read != self.changes
    }

    /// Appends what changed after the `read`-th change, oldest first.
    pub(super) fn collect(&self, read: &mut u64, inbox: &mut Vec<SharedMessage>) {
        if *read == self.changes {
            return;
        }
        let before = inbox.len();
        let mut place = self.newest;
        while let Some(entry) = self.entries.get(place as usize).filter(|entry| entry.change > *read) {
            inbox.push(entry.message.clone());
            place = entry.older;
        }
        inbox[before..].reverse();
        *read = self.changes;
    }
}
