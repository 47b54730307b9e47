use core::ffi::c_void;

use crate::{Bytes, Sink, Status, ValueView};

/// Entries that the other side holds: the knowledge of a component for the time of a call, or the entries that a loop
/// adds to it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EntriesHandle {
    /// The first argument of each function.
    pub state: *mut c_void,
    /// The functions.
    pub functions: *const EntriesFunctions,
}

/// The declaration of an entry.
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
    /// Their declaration, as JSON; empty for entries of a loop.
    pub declaration: unsafe extern "C" fn(state: *mut c_void) -> Bytes,
    /// Their number.
    pub count: unsafe extern "C" fn(state: *mut c_void) -> u32,
    /// The declaration of one that is there.
    pub describe: unsafe extern "C" fn(state: *mut c_void, entry: u32, view: *mut EntryView),
    /// Gives the value of one; 0 where it is no single value.
    pub get: unsafe extern "C" fn(state: *mut c_void, entry: u32, value: *mut ValueView) -> u32,
    /// Sets it.
    pub set: unsafe extern "C" fn(state: *mut c_void, entry: u32, value: *const ValueView, error: Sink) -> Status,
    /// Gives the CDR form of one.
    pub get_bytes: unsafe extern "C" fn(state: *mut c_void, entry: u32, bytes: Sink, error: Sink) -> Status,
    /// Sets it from that.
    pub set_bytes: unsafe extern "C" fn(state: *mut c_void, entry: u32, bytes: Bytes, error: Sink) -> Status,
    /// Frees entries that were given away; does nothing for those that are lent.
    pub destroy: unsafe extern "C" fn(state: *mut c_void),
}
