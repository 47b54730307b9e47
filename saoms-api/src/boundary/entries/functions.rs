use std::ffi::c_void;

use saoms_abi::{Bytes, EntriesFunctions, EntriesHandle, EntryView, Sink, Status, ValueView};

use crate::adaptation::kept;
use crate::boundary::convert::{read_value, value_view};
use crate::boundary::guard::{guarded, guarded_value};
use crate::boundary::lease_cell::knowledge;
use crate::boundary::null::given;
use crate::host::contain::contained;
use crate::host::{DynEntries, EntryDeclaration};
use crate::{Failure, Knowledge, Value};

/// Gives entries away.
pub(in crate::boundary) fn export_entries(entries: Box<dyn DynEntries>) -> EntriesHandle {
    EntriesHandle { state: Box::into_raw(Box::new(entries)).cast(), functions: &OWNED }
}

/// A kind of handle, by which functions find the entries behind its state.
trait EntriesKind {
    /// Runs code with the entries.
    ///
    /// # Errors
    /// They are not lent now.
    ///
    /// # Safety
    /// The pointer is the `state` of a handle of this kind, and nothing else uses it during the call.
    unsafe fn with<T>(state: *mut c_void, code: impl FnOnce(&mut dyn EntryList) -> T) -> Result<T, Failure>;
}

/// Entries as one list: of a component's knowledge also those that loops added.
trait EntryList {
    fn declaration(&self) -> &'static str;
    fn declared(&self, entry: u32) -> Option<&'static EntryDeclaration>;
    fn count(&self) -> usize;
    fn get(&self, entry: u32) -> Option<Value>;
    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure>;
    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure>;
    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure>;
}

struct LentKnowledge;
struct OwnedEntries;

impl EntriesKind for LentKnowledge {
    unsafe fn with<T>(state: *mut c_void, code: impl FnOnce(&mut dyn EntryList) -> T) -> Result<T, Failure> {
        // SAFETY: as the caller promises.
        let mut lent = unsafe { knowledge(state) }?;
        Ok(code(&mut &mut *lent))
    }
}

impl EntriesKind for OwnedEntries {
    unsafe fn with<T>(state: *mut c_void, code: impl FnOnce(&mut dyn EntryList) -> T) -> Result<T, Failure> {
        // SAFETY: `export_entries` made it from a box that `destroy` alone frees.
        let given = unsafe { &mut *state.cast::<Box<dyn DynEntries>>() };
        Ok(code(&mut &mut **given))
    }
}

impl EntryList for &mut dyn Knowledge {
    fn declaration(&self) -> &'static str {
        (**self).declaration()
    }

    fn declared(&self, entry: u32) -> Option<&'static EntryDeclaration> {
        self.all_declared().nth(entry as usize)
    }

    fn count(&self) -> usize {
        self.all_declared().count()
    }

    fn get(&self, entry: u32) -> Option<Value> {
        self.value(entry)
    }

    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure> {
        self.set_value(entry, value)
    }

    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure> {
        self.bytes(entry, bytes)
    }

    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure> {
        self.set_to_bytes(entry, bytes)
    }
}

impl EntryList for &mut dyn DynEntries {
    fn declaration(&self) -> &'static str {
        ""
    }

    fn declared(&self, entry: u32) -> Option<&'static EntryDeclaration> {
        (**self).declared().get(entry as usize)
    }

    fn count(&self) -> usize {
        (**self).declared().len()
    }

    fn get(&self, entry: u32) -> Option<Value> {
        (**self).get(entry)
    }

    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure> {
        (**self).set(entry, value)
    }

    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure> {
        (**self).get_bytes(entry, bytes)
    }

    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure> {
        (**self).set_bytes(entry, bytes)
    }
}

/// Runs code with the entries behind a state, for a function that cannot answer with a failure: then the answer is
/// `otherwise`.
///
/// # Safety
/// As [`EntriesKind::with`].
unsafe fn with_all<B: EntriesKind, T: Copy>(
    state: *mut c_void,
    otherwise: T,
    code: impl FnOnce(&mut dyn EntryList) -> T,
) -> T {
    // SAFETY: as the caller promises.
    guarded_value(otherwise, || unsafe { B::with(state, code) }.unwrap_or(otherwise))
}

unsafe extern "C" fn declaration<B: EntriesKind>(state: *mut c_void) -> Bytes {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_all::<B, _>(state, Bytes::NONE, |all| Bytes::text(all.declaration())) }
}

unsafe extern "C" fn count<B: EntriesKind>(state: *mut c_void) -> u32 {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_all::<B, _>(state, 0, |all| all.count() as u32) }
}

unsafe extern "C" fn describe<B: EntriesKind>(state: *mut c_void, entry: u32, view: *mut EntryView) {
    // SAFETY: callers pass the state of their handle, and a place for the view.
    unsafe {
        if let (Some(found), Some(view)) = (with_all::<B, _>(state, None, |all| all.declared(entry)), view.as_mut()) {
            *view = EntryView {
                name: Bytes::text(found.name),
                of: Bytes::text(found.of),
                effector: u32::from(found.effector),
            };
        }
    }
}

unsafe extern "C" fn get<B: EntriesKind>(state: *mut c_void, entry: u32, value: *mut ValueView) -> u32 {
    // SAFETY: callers pass the state of their handle, and a place for the value.
    unsafe {
        match (with_all::<B, _>(state, None, |all| all.get(entry)), value.as_mut()) {
            (Some(found), Some(value)) => {
                // The value outlives this call, so its text has to.
                let found = match found {
                    Value::Text(text) => kept(text.as_str()).map_or(Value::Nothing, Value::Word),
                    found => found,
                };
                *value = value_view(&found);
                1
            }
            _ => 0,
        }
    }
}

unsafe extern "C" fn set<B: EntriesKind>(
    state: *mut c_void,
    entry: u32,
    value: *const ValueView,
    error: Sink,
) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the value.
    unsafe {
        guarded(error, || B::with(state, |all| all.set(entry, read_value(*given(value, "the value of an entry")?)?))?)
    }
}

unsafe extern "C" fn get_bytes<B: EntriesKind>(state: *mut c_void, entry: u32, bytes: Sink, error: Sink) -> Status {
    // SAFETY: callers pass the state of their handle, and wait for the bytes.
    unsafe {
        guarded(error, || {
            let mut buffer = Vec::new();
            B::with(state, |all| all.get_bytes(entry, &mut buffer))??;
            bytes.put(&buffer);
            Ok(())
        })
    }
}

unsafe extern "C" fn set_bytes<B: EntriesKind>(state: *mut c_void, entry: u32, bytes: Bytes, error: Sink) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the bytes.
    unsafe { guarded(error, || B::with(state, |all| all.set_bytes(entry, bytes.get()?))?) }
}

unsafe extern "C" fn keep(_state: *mut c_void) {}

unsafe extern "C" fn destroy(state: *mut c_void) {
    // SAFETY: the pointer is that of `export_entries`, given back once.
    let _ = contained(|| drop(unsafe { Box::from_raw(state.cast::<Box<dyn DynEntries>>()) }));
}

pub(in crate::boundary) static KNOWLEDGE: EntriesFunctions = functions::<LentKnowledge>(keep);
static OWNED: EntriesFunctions = functions::<OwnedEntries>(destroy);

const fn functions<B: EntriesKind>(destroy: unsafe extern "C" fn(*mut c_void)) -> EntriesFunctions {
    EntriesFunctions {
        size: size_of::<EntriesFunctions>(),
        declaration: declaration::<B>,
        count: count::<B>,
        describe: describe::<B>,
        get: get::<B>,
        set: set::<B>,
        get_bytes: get_bytes::<B>,
        set_bytes: set_bytes::<B>,
        destroy,
    }
}
