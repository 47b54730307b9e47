use core::ffi::c_void;

use crate::{Bytes, FindingSink, HostHandle, PropertyView, Sink, Status};

/// The function that makes a component or a loop from the values of the composite, which it may refuse with findings.
/// The checker makes components that never run, so it does no work, opens nothing and sends nothing.
pub type Construct = unsafe extern "C" fn(
    values: *const PropertyView,
    value_count: usize,
    made: *mut *mut c_void,
    findings: FindingSink,
    error: Sink,
) -> Status;

/// A class: how to make components of it, and their functions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ClassTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// Makes a component of it.
    pub construct: Construct,
    /// The functions of its components.
    pub component: *const ComponentTable,
}

// SAFETY: what the pointer leads to is constant.
unsafe impl Sync for ClassTable {}

/// The functions of the components of a class. The first argument of each is the component.
///
/// They are called from one thread at a time and never twice at once. One that answers something else than `OK` has
/// failed, with the text that it put into `error`; the component's `restart` policy decides then.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ComponentTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// Asks for topics and references. Called once, when the component is scheduled.
    pub initialize: unsafe extern "C" fn(component: *mut c_void, host: *const HostHandle, error: Sink) -> Status,
    /// Does the work of one period, with what arrived since the last one. Never called for a passive component. It must
    /// not wait for anything.
    pub execute: unsafe extern "C" fn(component: *mut c_void, host: *const HostHandle, error: Sink) -> Status,
    /// Ends the work; messages that it sends still leave. Called once, when the component is unscheduled or the run
    /// ends.
    pub shutdown: unsafe extern "C" fn(component: *mut c_void, host: *const HostHandle, error: Sink) -> Status,
    /// Serves a call of one of the services that the class declares: the number of the operation, arguments and reply
    /// in their CDR form.
    pub serve: unsafe extern "C" fn(
        component: *mut c_void,
        host: *const HostHandle,
        service: Bytes,
        operation: u32,
        arguments: Bytes,
        reply: Sink,
        error: Sink,
    ) -> Status,
    /// Frees the component.
    pub destroy: unsafe extern "C" fn(component: *mut c_void),
    /// Puts the state from which a component of a new build continues, when that takes its place in a running fleet;
    /// nothing where it begins anew. `FAILED`: it cannot be replaced now. May be null: there is no state.
    pub save: Option<unsafe extern "C" fn(component: *mut c_void, saved: Sink, error: Sink) -> Status>,
    /// Continues from the state that a component of an earlier build put, after `initialize`. May be null: it cannot.
    pub restore: Option<unsafe extern "C" fn(component: *mut c_void, saved: Bytes, error: Sink) -> Status>,
    /// Puts what the component waits for, which completes "it waits for": it does none of the work that is left until
    /// a message or a call reaches it. Puts nothing where it may act by itself. Asked when nothing has happened in the
    /// fleet for a while. May be null, or beyond the `size` of the table: it may act by itself.
    pub waits_for: Option<unsafe extern "C" fn(component: *mut c_void, text: Sink, error: Sink) -> Status>,
    /// Handles messages of the topics that the composite names in `trigger`, which come here alone. Supervised like
    /// `execute`. Of a class whose declaration says `"reacts": true`; else it may be null.
    pub react: Option<unsafe extern "C" fn(component: *mut c_void, host: *const HostHandle, error: Sink) -> Status>,
    /// Takes new values of properties whose declaration says `"live": true`, between two executions: all values are
    /// given. `FAILED`: it refuses them, and goes on with those that it has. May be null where there is no such
    /// property.
    pub update: Option<
        unsafe extern "C" fn(
            component: *mut c_void,
            values: *const PropertyView,
            value_count: usize,
            error: Sink,
        ) -> Status,
    >,
    /// Puts what an operator wants to know of the component now, as one JSON object of named values:
    /// `{"battery": 80.5, "block": [3, 1]}`. Asked while nothing else of the component runs, when somebody looks at the
    /// running fleet. It must not wait, and changes nothing. May be null, or beyond the `size` of the table: there is
    /// nothing to tell beyond what the program counts itself.
    pub status: Option<unsafe extern "C" fn(component: *mut c_void, values: Sink, error: Sink) -> Status>,
}
