use core::ffi::c_void;

use crate::{Bytes, Construct, EntriesHandle, HostHandle, Sink, Status};

/// A function of a loop, with its component's knowledge.
pub type Step = unsafe extern "C" fn(
    looping: *mut c_void,
    knowledge: *const EntriesHandle,
    host: *const HostHandle,
    error: Sink,
) -> Status;

/// A loop class: how to make loops of it, and their functions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct LoopClassTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// Makes a loop of it.
    pub construct: Construct,
    /// The functions of its loops.
    pub looping: *const LoopTable,
}

// SAFETY: what the pointer leads to is constant.
unsafe impl Sync for LoopClassTable {}

/// The functions of a loop. The first argument of each is the loop.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct LoopTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// The name of an entry that it changes, by its number from 0; empty behind the last. It stays as long as the
    /// program runs.
    pub effect: unsafe extern "C" fn(looping: *mut c_void, number: u32) -> Bytes,
    /// The entries that it adds to the knowledge; 0 where there are none.
    pub entries: unsafe extern "C" fn(looping: *mut c_void, given: *mut EntriesHandle) -> u32,
    /// Asks for topics, references and entries. Called once, after all loops have added their entries.
    pub initialize: Step,
    /// Takes in messages and measurements. Called in each execution, for all loops before the first one adapts.
    pub monitor: Step,
    /// Analyzes, plans and executes, and writes symptom and decision to the journal. The caller finds the changes by
    /// itself.
    pub adapt: Step,
    /// Ends the work.
    pub shutdown: Step,
    /// Frees the loop.
    pub destroy: unsafe extern "C" fn(looping: *mut c_void),
}

/// A loop that is given away, with its functions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct LoopInstance {
    /// The loop.
    pub instance: *mut c_void,
    /// Its functions.
    pub table: *const LoopTable,
}
