use saoms_abi::EntriesHandle;

use crate::adaptation::no_entry;
use crate::host::{DynEntries, EntryDeclaration};
use crate::{Extras, Failure, Knowledge, Value};

use super::remote::RemoteEntries;

/// The knowledge of a component on the other side, for a loop on this one. All its entries, those that loops added too,
/// count as its own.
pub(in crate::boundary) struct RemoteKnowledge {
    remote: RemoteEntries,
    /// Empty but for the list of entries that the loop may change.
    extras: Extras,
}

impl RemoteKnowledge {
    /// # Safety
    /// As [`RemoteEntries::new`].
    pub(in crate::boundary) unsafe fn new(handle: EntriesHandle) -> Result<RemoteKnowledge, Failure> {
        // SAFETY: as the caller promises.
        Ok(RemoteKnowledge { remote: unsafe { RemoteEntries::new(handle) }?, extras: Extras::default() })
    }

    /// Goes on with the handle of another call for the same component.
    ///
    /// # Safety
    /// As [`RemoteEntries::new`].
    pub(in crate::boundary) unsafe fn renew(&mut self, handle: EntriesHandle) {
        self.remote.handle = handle;
    }
}

impl DynEntries for RemoteKnowledge {
    fn declared(&self) -> &'static [EntryDeclaration] {
        self.remote.declared
    }

    fn get(&self, entry: u32) -> Option<Value> {
        self.remote.get(entry)
    }

    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure> {
        if entry as usize >= self.remote.declared.len() {
            return Err(no_entry(entry));
        }
        self.remote.set(entry, value)
    }

    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure> {
        self.remote.get_bytes(entry, bytes)
    }

    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure> {
        self.remote.set_bytes(entry, bytes)
    }

    fn read(&self, values: &mut Vec<Value>) {
        self.remote.read(values);
    }
}

impl Knowledge for RemoteKnowledge {
    fn declaration(&self) -> &'static str {
        // SAFETY: the handle keeps the rules; the text is a constant of a library or of the program, which stay.
        unsafe { (self.remote.functions().declaration)(self.remote.handle.state).get_text() }.unwrap_or_default()
    }

    fn extras(&self) -> &Extras {
        &self.extras
    }

    fn extras_mut(&mut self) -> &mut Extras {
        &mut self.extras
    }
}
