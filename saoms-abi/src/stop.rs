use core::ffi::c_void;

use crate::{Sink, Status};

/// A function that stops the hardware of a component. The host calls it from any of its threads, at any time and any
/// number of times, also while another function of the component runs or hangs, and never after `release`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StopView {
    /// The size of this structure in bytes.
    pub size: usize,
    /// The library's own; the first argument of the functions.
    pub state: *mut c_void,
    /// Stops the hardware, and may wait for it. `FAILED`, with a text in `error`: it may still move.
    pub stop: Option<unsafe extern "C" fn(state: *mut c_void, error: Sink) -> Status>,
    /// Tells the hardware that its component is alive: it stops by itself when it hears nothing for twice the period,
    /// which is in nanoseconds. Must not wait. `FAILED`, with a text in `error`: whoever has executed fails. May be
    /// null: there is no heartbeat.
    pub heartbeat: Option<unsafe extern "C" fn(state: *mut c_void, period: u64, error: Sink) -> Status>,
    /// Frees the state. May be null: there is nothing to free.
    pub release: Option<unsafe extern "C" fn(state: *mut c_void)>,
}
