use std::mem::offset_of;
use std::sync::{Mutex, PoisonError};

use saoms_abi::{Bytes, EntriesFunctions, EntriesHandle, EntryView};

use crate::boundary::convert::{read_value, value_view};
use crate::boundary::lease::{call, call_for_bytes};
use crate::boundary::null::{given, null_in};
use crate::host::{DynEntries, EntryDeclaration};
use crate::{Failure, Value};

/// Entries of the other side. While they are lent, the handle is that of the present call.
pub(in crate::boundary) struct RemoteEntries {
    pub(super) handle: EntriesHandle,
    pub(super) declared: &'static [EntryDeclaration],
}

// SAFETY: entries are used by one thread at a time, that of their component.
unsafe impl Send for RemoteEntries {}

impl RemoteEntries {
    /// # Safety
    /// The handle and its functions keep the rules of the boundary, for as long as the result is used.
    pub(in crate::boundary) unsafe fn new(handle: EntriesHandle) -> Result<RemoteEntries, Failure> {
        // SAFETY: as the caller promises: a table that is there begins with its size.
        let declared = unsafe {
            check(handle.functions)?;
            declared(&handle)
        }?;
        Ok(RemoteEntries { handle, declared })
    }

    pub(super) fn functions(&self) -> &EntriesFunctions {
        // SAFETY: `new`'s caller promised it.
        unsafe { &*self.handle.functions }
    }
}

/// Checks that a table of functions is whole.
///
/// # Safety
/// It is null, or valid for the size that it declares.
unsafe fn check(table: *const EntriesFunctions) -> Result<(), Failure> {
    macro_rules! members {
        ($($member:ident),*) => { [$((stringify!($member), offset_of!(EntriesFunctions, $member))),*] };
    }
    let members = members!(declaration, count, describe, get, set, get_bytes, set_bytes, destroy);
    let name = "SaomsEntriesFunctions";
    // SAFETY: as the caller promises.
    unsafe {
        let (size, least) =
            (*given(table.cast::<usize>(), "the table of functions of its entries")?, size_of::<EntriesFunctions>());
        if size < least {
            return Err(Failure::new(format!("its `{name}` has {size} bytes, expected at least {least}")));
        }
        null_in(table.cast(), &members).map_or(Ok(()), |member| {
            Err(Failure::new(format!("`{member}` in its `{name}` is null, expected a function")))
        })
    }
}

/// The declarations of the entries of the other side. They stay: entries have them as constants, and most handles
/// declare the same.
///
/// # Safety
/// The handle keeps the rules of the boundary.
unsafe fn declared(handle: &EntriesHandle) -> Result<&'static [EntryDeclaration], Failure> {
    static KNOWN: Mutex<Vec<&'static [EntryDeclaration]>> = Mutex::new(Vec::new());
    let mut all = Vec::new();
    // SAFETY: as the caller promises; the texts stay by the rules.
    unsafe {
        let functions = &*handle.functions;
        for entry in 0..(functions.count)(handle.state) {
            let mut view = EntryView { name: Bytes::NONE, of: Bytes::NONE, effector: 0 };
            (functions.describe)(handle.state, entry, &raw mut view);
            all.push(EntryDeclaration {
                name: view.name.get_text()?,
                of: view.of.get_text()?,
                effector: view.effector != 0,
            });
        }
    }
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(same) = known.iter().find(|same| ***same == *all) {
        return Ok(same);
    }
    let new: &'static [EntryDeclaration] = all.leak();
    known.push(new);
    Ok(new)
}

impl DynEntries for RemoteEntries {
    fn declared(&self) -> &'static [EntryDeclaration] {
        self.declared
    }

    fn get(&self, entry: u32) -> Option<Value> {
        let mut value = value_view(&Value::Nothing);
        // SAFETY: the handle keeps the rules; words are part of a library or of the program, which stay.
        unsafe {
            let found = (self.functions().get)(self.handle.state, entry, &raw mut value);
            if found == 0 { None } else { read_value(value).ok() }
        }
    }

    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure> {
        let value = value_view(&value);
        // SAFETY: the handle keeps the rules; the value is lent to the call.
        call(|error| unsafe { (self.functions().set)(self.handle.state, entry, &raw const value, error) })
    }

    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure> {
        // SAFETY: the handle keeps the rules.
        call_for_bytes(bytes, |bytes, error| unsafe {
            (self.functions().get_bytes)(self.handle.state, entry, bytes, error)
        })
    }

    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure> {
        // SAFETY: the handle keeps the rules; the bytes are lent to the call.
        call(|error| unsafe { (self.functions().set_bytes)(self.handle.state, entry, Bytes::lend(bytes), error) })
    }

    fn read(&self, values: &mut Vec<Value>) {
        values.extend((0..self.declared.len() as u32).map(|entry| self.get(entry).unwrap_or(Value::Nothing)));
    }
}

/// Entries that the other side gave away.
pub(in crate::boundary) struct OwnedRemoteEntries(pub(in crate::boundary) RemoteEntries);

impl Drop for OwnedRemoteEntries {
    fn drop(&mut self) {
        // SAFETY: they were given away to this, and are given back once.
        unsafe { (self.0.functions().destroy)(self.0.handle.state) }
    }
}

impl DynEntries for OwnedRemoteEntries {
    fn declared(&self) -> &'static [EntryDeclaration] {
        self.0.declared
    }

    fn get(&self, entry: u32) -> Option<Value> {
        self.0.get(entry)
    }

    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure> {
        self.0.set(entry, value)
    }

    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure> {
        self.0.get_bytes(entry, bytes)
    }

    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure> {
        self.0.set_bytes(entry, bytes)
    }

    fn read(&self, values: &mut Vec<Value>) {
        self.0.read(values);
    }
}
