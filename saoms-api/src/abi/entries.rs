use std::ffi::c_void;
use std::sync::{Mutex, PoisonError};

use crate::adaptation::no_entry;
use crate::contain::contained;
use crate::{DynEntries, EntryDeclaration, Extras, Failure, Knowledge, Value};

use super::guard::{guarded, guarded_value};
use super::lease::{call, call_for_bytes, knowledge};
use super::{Bytes, Sink, Status, ValueView};

/// Entries that the other side holds: the knowledge of a component for the time of a call, or the entries that a loop adds to it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EntriesHandle {
    /// The first argument of each function.
    pub state: *mut c_void,
    /// The functions.
    pub functions: *const EntriesFunctions,
}

/// What is declared of an entry.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EntryView {
    /// Its name; stays as long as the program runs.
    pub name: Bytes,
    /// Its type as a fragment of a schema; stays as long as the program runs.
    pub of: Bytes,
    /// 1 if of the loops of a component only one may change it.
    pub effector: u32,
}

/// The functions of entries. The first argument of each is the `state` of their handle. An entry is known by its place.
#[repr(C)]
#[derive(Debug)]
pub struct EntriesFunctions {
    /// The size of this table in bytes.
    pub size: usize,
    /// What is declared of them, as JSON; empty for entries of a loop.
    pub declaration: unsafe extern "C" fn(state: *mut c_void) -> Bytes,
    /// How many there are.
    pub count: unsafe extern "C" fn(state: *mut c_void) -> u32,
    /// What is declared of one that is there.
    pub describe: unsafe extern "C" fn(state: *mut c_void, entry: u32, view: *mut EntryView),
    /// Gives the value of one; 0 where it is no single value.
    pub get: unsafe extern "C" fn(state: *mut c_void, entry: u32, value: *mut ValueView) -> u32,
    /// Sets it.
    pub set:
        unsafe extern "C" fn(state: *mut c_void, entry: u32, value: *const ValueView, error: Sink) -> Status,
    /// Gives the CDR form of one.
    pub get_bytes: unsafe extern "C" fn(state: *mut c_void, entry: u32, bytes: Sink, error: Sink) -> Status,
    /// Sets it from that.
    pub set_bytes: unsafe extern "C" fn(state: *mut c_void, entry: u32, bytes: Bytes, error: Sink) -> Status,
    /// Frees entries that were given away; does nothing for those that are lent.
    pub destroy: unsafe extern "C" fn(state: *mut c_void),
}

/// Gives entries away.
pub(super) fn give(entries: Box<dyn DynEntries>) -> EntriesHandle {
    EntriesHandle { state: Box::into_raw(Box::new(entries)).cast(), functions: &GIVEN }
}

/// The entries behind a pointer, as one list: of a component's knowledge also those that loops added.
trait Behind {
    /// Runs code with them.
    ///
    /// # Errors
    /// They are not lent now.
    ///
    /// # Safety
    /// The pointer is the `state` of a handle of this kind, and nothing else uses it during the call.
    unsafe fn with<T>(state: *mut c_void, code: impl FnOnce(&mut dyn All) -> T) -> Result<T, Failure>;
}

trait All {
    fn declaration(&self) -> &'static str;
    fn declared(&self, entry: u32) -> Option<&'static EntryDeclaration>;
    fn count(&self) -> usize;
    fn get(&self, entry: u32) -> Option<Value>;
    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure>;
    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure>;
    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure>;
}

struct Lent;
struct Given;

impl Behind for Lent {
    unsafe fn with<T>(state: *mut c_void, code: impl FnOnce(&mut dyn All) -> T) -> Result<T, Failure> {
        // SAFETY: as the caller promises.
        let mut lent = unsafe { knowledge(state) }?;
        Ok(code(&mut &mut *lent))
    }
}

impl Behind for Given {
    unsafe fn with<T>(state: *mut c_void, code: impl FnOnce(&mut dyn All) -> T) -> Result<T, Failure> {
        // SAFETY: `give` made it from a box that `destroy` alone frees.
        let given = unsafe { &mut *state.cast::<Box<dyn DynEntries>>() };
        Ok(code(&mut &mut **given))
    }
}

impl All for &mut dyn Knowledge {
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

impl All for &mut dyn DynEntries {
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

/// Runs code with the entries behind a state, for a function that has no way to say what went wrong: the answer is `otherwise` then.
///
/// # Safety
/// As [`Behind::with`].
unsafe fn with_all<B: Behind, T: Copy>(
    state: *mut c_void,
    otherwise: T,
    code: impl FnOnce(&mut dyn All) -> T,
) -> T {
    // SAFETY: as the caller promises.
    guarded_value(otherwise, || unsafe { B::with(state, code) }.unwrap_or(otherwise))
}

unsafe extern "C" fn declaration<B: Behind>(state: *mut c_void) -> Bytes {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_all::<B, _>(state, Bytes::NONE, |all| Bytes::text(all.declaration())) }
}

unsafe extern "C" fn count<B: Behind>(state: *mut c_void) -> u32 {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_all::<B, _>(state, 0, |all| all.count() as u32) }
}

unsafe extern "C" fn describe<B: Behind>(state: *mut c_void, entry: u32, view: *mut EntryView) {
    // SAFETY: callers pass the state of their handle, and a place for the view.
    unsafe {
        if let Some(found) = with_all::<B, _>(state, None, |all| all.declared(entry)) {
            *view = EntryView {
                name: Bytes::text(found.name),
                of: Bytes::text(found.of),
                effector: u32::from(found.effector),
            };
        }
    }
}

unsafe extern "C" fn get<B: Behind>(state: *mut c_void, entry: u32, value: *mut ValueView) -> u32 {
    // SAFETY: callers pass the state of their handle, and a place for the value.
    unsafe {
        match with_all::<B, _>(state, None, |all| all.get(entry)) {
            Some(found) => {
                *value = ValueView::of(found);
                1
            }
            None => 0,
        }
    }
}

unsafe extern "C" fn set<B: Behind>(
    state: *mut c_void,
    entry: u32,
    value: *const ValueView,
    error: Sink,
) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the value.
    unsafe { guarded(error, || B::with(state, |all| all.set(entry, (*value).read()?))?) }
}

unsafe extern "C" fn get_bytes<B: Behind>(
    state: *mut c_void,
    entry: u32,
    bytes: Sink,
    error: Sink,
) -> Status {
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

unsafe extern "C" fn set_bytes<B: Behind>(
    state: *mut c_void,
    entry: u32,
    bytes: Bytes,
    error: Sink,
) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the bytes.
    unsafe { guarded(error, || B::with(state, |all| all.set_bytes(entry, bytes.get()?))?) }
}

unsafe extern "C" fn keep(_state: *mut c_void) {}

unsafe extern "C" fn destroy(state: *mut c_void) {
    // SAFETY: the pointer is that of `give`, given back once.
    let _ = contained(|| drop(unsafe { Box::from_raw(state.cast::<Box<dyn DynEntries>>()) }));
}

pub(super) static KNOWLEDGE: EntriesFunctions = functions::<Lent>(keep);
static GIVEN: EntriesFunctions = functions::<Given>(destroy);

const fn functions<B: Behind>(destroy: unsafe extern "C" fn(*mut c_void)) -> EntriesFunctions {
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

/// Entries of the other side. While they are lent, the handle is that of the present call.
pub(super) struct Remote {
    handle: EntriesHandle,
    declared: &'static [EntryDeclaration],
}

// SAFETY: entries are used by one thread at a time, that of their component.
unsafe impl Send for Remote {}

impl Remote {
    /// # Safety
    /// The handle and its functions keep the rules of the boundary, for as long as the result is used.
    pub(super) unsafe fn new(handle: EntriesHandle) -> Result<Remote, Failure> {
        // SAFETY: as the caller promises.
        let declared = unsafe { declared(&handle) }?;
        Ok(Remote { handle, declared })
    }

    fn functions(&self) -> &EntriesFunctions {
        // SAFETY: `new`'s caller promised it.
        unsafe { &*self.handle.functions }
    }
}

/// What is declared of the entries of the other side. It stays: entries have it as constants, and most handles declare the same.
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

impl DynEntries for Remote {
    fn declared(&self) -> &'static [EntryDeclaration] {
        self.declared
    }

    fn get(&self, entry: u32) -> Option<Value> {
        let mut value = ValueView::of(Value::Nothing);
        // SAFETY: the handle keeps the rules; words are part of a library or of the program, which stay.
        unsafe {
            let found = (self.functions().get)(self.handle.state, entry, &raw mut value);
            if found == 0 { None } else { value.read().ok() }
        }
    }

    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure> {
        let value = ValueView::of(value);
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
        call(|error| unsafe {
            (self.functions().set_bytes)(self.handle.state, entry, Bytes::lend(bytes), error)
        })
    }

    fn read(&self, values: &mut Vec<Value>) {
        values.extend((0..self.declared.len() as u32).map(|entry| self.get(entry).unwrap_or(Value::Nothing)));
    }
}

/// Entries that the other side gave away.
pub(super) struct GivenEntries(pub(super) Remote);

impl Drop for GivenEntries {
    fn drop(&mut self) {
        // SAFETY: they were given away to this, and are given back once.
        unsafe { (self.0.functions().destroy)(self.0.handle.state) }
    }
}

impl DynEntries for GivenEntries {
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

/// The knowledge of a component on the other side, for a loop on this one. All its entries, those that loops added too, count as its own.
pub(super) struct RemoteKnowledge {
    remote: Remote,
    /// Empty but for what the loop may change.
    extras: Extras,
}

impl RemoteKnowledge {
    /// # Safety
    /// As [`Remote::new`].
    pub(super) unsafe fn new(handle: EntriesHandle) -> Result<RemoteKnowledge, Failure> {
        // SAFETY: as the caller promises.
        Ok(RemoteKnowledge { remote: unsafe { Remote::new(handle) }?, extras: Extras::default() })
    }

    /// Goes on with the handle of another call for the same component.
    ///
    /// # Safety
    /// As [`Remote::new`].
    pub(super) unsafe fn renew(&mut self, handle: EntriesHandle) {
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
        unsafe { (self.remote.functions().declaration)(self.remote.handle.state).get_text() }
            .unwrap_or_default()
    }

    fn extras(&self) -> &Extras {
        &self.extras
    }

    fn extras_mut(&mut self) -> &mut Extras {
        &mut self.extras
    }
}
