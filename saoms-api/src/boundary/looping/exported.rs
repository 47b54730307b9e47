use std::ffi::c_void;

use saoms_abi::{
    Bytes, EntriesHandle, FindingSink, HostHandle, LoopClassTable, LoopInstance, LoopTable, PropertyView, Sink, Status,
};

use crate::adaptation::Writable;
use crate::boundary::context_state::ContextState;
use crate::boundary::convert::read_properties;
use crate::boundary::entries::{RemoteKnowledge, export_entries};
use crate::boundary::guard::{guarded, guarded_construct, guarded_value};
use crate::host::contain::contained;
use crate::host::{DynLoop, LoopRegistration, Snapshot};
use crate::{Context, Failure, Knowledge, LoopClass};

/// The table of a loop class.
pub const fn loop_class_table<L: LoopClass>() -> LoopClassTable {
    LoopClassTable { size: size_of::<LoopClassTable>(), construct: construct::<L>, looping: &TABLE }
}

unsafe extern "C" fn construct<L: LoopClass>(
    values: *const PropertyView,
    count: usize,
    instance: *mut *mut c_void,
    findings: FindingSink,
    error: Sink,
) -> Status {
    let make = || {
        // SAFETY: the host lends the values to this call.
        let values = unsafe { read_properties(values, count) }?;
        Ok(ExportedLoop::into_pointer(LoopRegistration::of::<L>().construct(&values)?))
    };
    // SAFETY: the host waits for the call with its sinks, and has a place for the pointer.
    unsafe { guarded_construct(findings, error, make, instance) }
}

/// Gives a loop of this side away.
pub(in crate::boundary) fn export_loop(instance: Box<dyn DynLoop>) -> LoopInstance {
    LoopInstance { instance: ExportedLoop::into_pointer(instance), table: &TABLE }
}

/// A loop of this side as the other one holds it, behind a pointer.
struct ExportedLoop {
    instance: Box<dyn DynLoop>,
    state: ContextState,
    knowledge: Option<RemoteKnowledge>,
    /// Sees nothing: the side of the knowledge finds the changes.
    snapshot: Snapshot,
}

static TABLE: LoopTable = LoopTable {
    size: size_of::<LoopTable>(),
    effect: ExportedLoop::effect,
    entries: ExportedLoop::entries,
    initialize: ExportedLoop::initialize,
    monitor: ExportedLoop::monitor,
    adapt: ExportedLoop::adapt,
    shutdown: ExportedLoop::shutdown,
    destroy: ExportedLoop::destroy,
};

impl ExportedLoop {
    fn into_pointer(instance: Box<dyn DynLoop>) -> *mut c_void {
        let snapshot = Snapshot::disabled();
        let exported = ExportedLoop { instance, state: ContextState::default(), knowledge: None, snapshot };
        Box::into_raw(Box::new(exported)).cast()
    }

    unsafe extern "C" fn effect(this: *mut c_void, number: u32) -> Bytes {
        // SAFETY: `this` comes from `into_pointer` and is used by this call alone.
        let exported = unsafe { &*this.cast::<Self>() };
        let effects = guarded_value(&[][..], || exported.instance.effects());
        effects.get(number as usize).map_or(Bytes::NONE, |name| Bytes::text(name))
    }

    unsafe extern "C" fn entries(this: *mut c_void, handle: *mut EntriesHandle) -> u32 {
        // SAFETY: as in `effect`; the caller gives a place for the handle.
        unsafe {
            let exported = &*this.cast::<Self>();
            let Ok(Some(entries)) = contained(|| exported.instance.entries()) else { return 0 };
            *handle = export_entries(entries);
        }
        1
    }

    /// # Safety
    /// `this` comes from `into_pointer` and is used by this call alone; the handles are those of the call.
    unsafe fn step(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        takes_in: bool,
        code: impl FnOnce(&mut dyn DynLoop, &mut Snapshot, &mut dyn Knowledge, &mut Context<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        // SAFETY: as the caller promises.
        unsafe {
            let ExportedLoop { instance, state, knowledge: known, snapshot } = &mut *this.cast::<Self>();
            let known = match known {
                Some(known) => {
                    known.renew(*knowledge);
                    known
                }
                none => {
                    let known = none.insert(RemoteKnowledge::new(*knowledge)?);
                    let own = instance.entries().map_or(&[][..], |entries| entries.declared());
                    known.extras_mut().permit(Writable { effects: instance.effects(), own });
                    known
                }
            };
            state.with(&*host, takes_in, |context| code(&mut **instance, snapshot, known, context))
        }
    }

    unsafe extern "C" fn initialize(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: the caller keeps the table's contract.
        unsafe {
            guarded(error, || {
                Self::step(this, knowledge, host, false, |instance, _, knowledge, context| {
                    instance.initialize(knowledge, context)
                })
            })
        }
    }

    unsafe extern "C" fn monitor(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || {
                Self::step(this, knowledge, host, true, |instance, _, knowledge, context| {
                    instance.monitor(knowledge, context)
                })
            })
        }
    }

    unsafe extern "C" fn adapt(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || {
                Self::step(this, knowledge, host, false, |instance, snapshot, knowledge, context| {
                    instance.adapt(knowledge, snapshot, context)
                })
            })
        }
    }

    unsafe extern "C" fn shutdown(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || {
                Self::step(this, knowledge, host, false, |instance, _, knowledge, context| {
                    instance.shutdown(knowledge, context)
                })
            })
        }
    }

    unsafe extern "C" fn destroy(this: *mut c_void) {
        // SAFETY: the pointer is that of `into_pointer`, given back once.
        let _ = contained(|| drop(unsafe { Box::from_raw(this.cast::<Self>()) }));
    }
}
