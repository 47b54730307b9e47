use std::ffi::c_void;

use saoms_abi::{Bytes, ClassTable, ComponentTable, FindingSink, HostHandle, PropertyView, Sink, Status};

use crate::host::contain::contained;
use crate::host::{DynComponent, Invocation};
use crate::{Class, Context, Failure, Properties, ReportValue, Saved};

use super::context_state::ContextState;
use super::convert::read_properties;
use super::guard::{guarded, guarded_call, guarded_construct};
use super::service::BytesCall;

/// The table of a class.
pub const fn class_table<C: Class>() -> ClassTable {
    ClassTable { size: size_of::<ClassTable>(), construct: construct::<C>, component: &ExportedComponent::<C>::TABLE }
}

unsafe extern "C" fn construct<C: Class>(
    values: *const PropertyView,
    count: usize,
    instance: *mut *mut c_void,
    findings: FindingSink,
    error: Sink,
) -> Status {
    let make = || {
        // SAFETY: the host lends the values to this call.
        let values = unsafe { read_properties(values, count) }?;
        Ok(ExportedComponent::into_pointer(C::new(C::Properties::from_values(&values)?)?))
    };
    // SAFETY: the host waits for the call with its sinks, and has a place for the pointer.
    unsafe { guarded_construct(findings, error, make, instance) }
}

/// A component of this side as the other one holds it, behind a pointer.
struct ExportedComponent<C> {
    component: C,
    state: ContextState,
}

impl<C: DynComponent> ExportedComponent<C> {
    /// Gives the component away; [`ComponentTable::destroy`] takes it back.
    pub(super) fn into_pointer(component: C) -> *mut c_void {
        let instance = ExportedComponent { component, state: ContextState::default() };
        Box::into_raw(Box::new(instance)).cast()
    }

    /// The functions of components of this type.
    pub(super) const TABLE: ComponentTable = ComponentTable {
        size: size_of::<ComponentTable>(),
        initialize: Self::initialize,
        execute: Self::execute,
        shutdown: Self::shutdown,
        serve: Self::serve,
        destroy: Self::destroy,
        save: Some(Self::save),
        restore: Some(Self::restore),
        waits_for: Some(Self::waits_for),
        status: Some(Self::status),
        react: Some(Self::react),
        update: Some(Self::update),
    };

    /// # Safety
    /// `this` comes from `into_pointer` and is used by this call alone; the handle is that of the call.
    #[inline]
    unsafe fn call<E: From<Failure>>(
        this: *mut c_void,
        handle: *const HostHandle,
        takes_in: bool,
        code: impl FnOnce(&mut C, &mut Context<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        // SAFETY: as the caller promises.
        unsafe {
            let ExportedComponent { component, state } = &mut *this.cast::<Self>();
            state.with(&*handle, takes_in, |context| code(component, context))
        }
    }

    unsafe extern "C" fn initialize(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: the host calls with what the table's contract says.
        unsafe {
            guarded(error, || Self::call(this, handle, false, |component, context| component.initialize(context)))
        }
    }

    unsafe extern "C" fn execute(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: as in `initialize`.
        unsafe { guarded(error, || Self::call(this, handle, true, |component, context| component.execute(context))) }
    }

    unsafe extern "C" fn react(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: as in `initialize`.
        unsafe { guarded(error, || Self::call(this, handle, true, |component, context| component.react(context))) }
    }

    unsafe extern "C" fn update(this: *mut c_void, values: *const PropertyView, count: usize, error: Sink) -> Status {
        // SAFETY: the host calls with what the table's contract says; `this` comes from `into_pointer` and is used by
        // this call alone.
        unsafe { guarded(error, || (*this.cast::<Self>()).component.update(&read_properties(values, count)?)) }
    }

    unsafe extern "C" fn shutdown(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: as in `initialize`.
        unsafe { guarded(error, || Self::call(this, handle, false, |component, context| component.shutdown(context))) }
    }

    unsafe extern "C" fn serve(
        this: *mut c_void,
        handle: *const HostHandle,
        service: Bytes,
        operation: u32,
        arguments: Bytes,
        reply: Sink,
        error: Sink,
    ) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded_call(error, || {
                let mut call = BytesCall::new(operation, arguments.get()?, reply);
                let mut invocation = Invocation { service: service.get_text()?, call: &mut call };
                Self::call(this, handle, false, |component, context| component.serve(&mut invocation, context))
            })
        }
    }

    unsafe extern "C" fn save(this: *mut c_void, saved: Sink, error: Sink) -> Status {
        // SAFETY: the host calls with what the table's contract says; `this` comes from `into_pointer` and is used by
        // this call alone.
        unsafe {
            guarded(error, || {
                saved.put((*this.cast::<Self>()).component.save()?.bytes());
                Ok(())
            })
        }
    }

    unsafe extern "C" fn restore(this: *mut c_void, saved: Bytes, error: Sink) -> Status {
        // SAFETY: as in `save`.
        unsafe {
            guarded(error, || (*this.cast::<Self>()).component.restore(&Saved::from_bytes(saved.get()?.to_vec())))
        }
    }

    unsafe extern "C" fn waits_for(this: *mut c_void, text: Sink, error: Sink) -> Status {
        // SAFETY: as in `save`.
        unsafe {
            guarded(error, || {
                if let Some(what) = (*this.cast::<Self>()).component.waits_for()? {
                    text.put(what.as_bytes());
                }
                Ok(())
            })
        }
    }

    unsafe extern "C" fn status(this: *mut c_void, values: Sink, error: Sink) -> Status {
        // SAFETY: as in `save`.
        unsafe {
            guarded(error, || {
                let shown = (*this.cast::<Self>()).component.status()?;
                if !shown.is_empty() {
                    values.put(ReportValue::Map(shown).to_string().as_bytes());
                }
                Ok(())
            })
        }
    }

    unsafe extern "C" fn destroy(this: *mut c_void) {
        // A panic while the component is dropped says nothing that its shutdown has not said.
        // SAFETY: the pointer is that of `into_pointer`, given back once.
        let _ = contained(|| drop(unsafe { Box::from_raw(this.cast::<Self>()) }));
    }
}
