use std::collections::BTreeMap;
use std::sync::Arc;

/// A change of what a component keeps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Change {
    /// Path of the component.
    pub(crate) component: Arc<str>,
    pub(crate) key: u64,
    /// The bytes; `None` to remove those that are there.
    pub(crate) bytes: Option<Arc<[u8]>>,
}

/// What one component keeps, by its keys.
pub(crate) type Entries = BTreeMap<u64, Arc<[u8]>>;

/// What all components keep, by their paths.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Contents {
    of: BTreeMap<Arc<str>, Entries>,
    /// Number of bytes in the form of the log, roughly.
    size: u64,
}

/// Bytes that an entry takes besides its own and the name of its component.
const OVERHEAD: usize = 16;

impl Contents {
    pub(super) fn apply(&mut self, change: &Change) {
        let Change { component, key, bytes } = change;
        let size = |bytes: &[u8]| (component.len() + bytes.len() + OVERHEAD) as u64;
        if !self.of.contains_key(component) && bytes.is_some() {
            self.of.insert(Arc::clone(component), Entries::new());
        }
        let Some(entries) = self.of.get_mut(component) else { return };
        let before = match bytes {
            Some(bytes) => {
                self.size += size(bytes);
                entries.insert(*key, Arc::clone(bytes))
            }
            None => entries.remove(key),
        };
        self.size -= before.map_or(0, |before| size(&before));
        if entries.is_empty() {
            self.of.remove(component);
        }
    }

    /// Number of bytes in the form of the log, roughly.
    pub(super) fn size(&self) -> u64 {
        self.size
    }

    /// What a component keeps.
    pub(crate) fn of(&self, component: &str) -> Option<&Entries> {
        self.of.get(component)
    }

    /// Forgets what a component keeps.
    pub(crate) fn forget(&mut self, component: &str) {
        self.of.remove(component);
    }

    /// The paths of the components.
    pub(crate) fn components(&self) -> impl Iterator<Item = &Arc<str>> {
        self.of.keys()
    }

    /// All that is kept, as changes of nothing.
    pub(super) fn changes(&self) -> impl Iterator<Item = Change> {
        self.of.iter().flat_map(|(component, entries)| {
            entries.iter().map(|(key, bytes)| Change {
                component: Arc::clone(component),
                key: *key,
                bytes: Some(Arc::clone(bytes)),
            })
        })
    }
}
