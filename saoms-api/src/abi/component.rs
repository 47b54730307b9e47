use std::ffi::c_void;

use crate::contain::contained;
use crate::{Context, DynComponent, Failure, Header, Invocation, Saved, SharedMessage};

use super::data::MessageView;
use super::guard::{guarded, guarded_call};
use super::link::Link;
use super::service::BytesCall;
use super::{Bytes, HostHandle, Sink, Status};

/// The functions of the components of a class. The first argument of each is the component.
///
/// They are called from one thread at a time and never twice at once. One that answers something else than `OK` has failed, with the text
/// that it put into `error`; the component's `restart` policy decides then.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ComponentTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// Asks for topics and references. Called once, when the component is scheduled.
    pub initialize:
        unsafe extern "C" fn(component: *mut c_void, host: *const HostHandle, error: Sink) -> Status,
    /// Does the work of one period, with what arrived since the last one. Never called for a passive component. It must not wait for
    /// anything.
    pub execute: unsafe extern "C" fn(component: *mut c_void, host: *const HostHandle, error: Sink) -> Status,
    /// Ends the work; what it sends still leaves. Called once, when the component is unscheduled or the run ends.
    pub shutdown:
        unsafe extern "C" fn(component: *mut c_void, host: *const HostHandle, error: Sink) -> Status,
    /// Serves a call of one of the services that the class declares: the number of the operation, arguments and reply in their CDR form.
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
    /// Puts what a component of a new build goes on with, when that takes its place in a running fleet; nothing where it begins anew. `FAILED`: it
    /// cannot be replaced now. May be null: there is nothing to go on with.
    pub save: Option<unsafe extern "C" fn(component: *mut c_void, saved: Sink, error: Sink) -> Status>,
    /// Goes on with what a component of an earlier build put, after `initialize`. May be null: it cannot.
    pub restore: Option<unsafe extern "C" fn(component: *mut c_void, saved: Bytes, error: Sink) -> Status>,
}

/// A component of this side as the other one holds it, behind a pointer.
pub struct Instance<C> {
    component: C,
    desk: Desk,
}

/// What a component or a loop of this side has beside itself.
#[derive(Default)]
pub(super) struct Desk {
    /// By the index of the subscription; only its own are ever filled.
    inboxes: Vec<Vec<SharedMessage>>,
    subscribed: Vec<u32>,
    /// Whether there is a message in them.
    is_filled: bool,
    buffer: Vec<u8>,
}

impl Desk {
    /// Runs code with the context behind a handle. Messages are taken in when the code `takes_in`, and stay until the next time.
    ///
    /// # Safety
    /// The handle is that of a call that goes on.
    #[inline]
    pub(super) unsafe fn with<E: From<Failure>>(
        &mut self,
        handle: &HostHandle,
        takes_in: bool,
        code: impl FnOnce(&mut Context<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        if !takes_in {
            // SAFETY: as the caller promises.
            unsafe { handle.has_all() }?;
        } else if handle.inbox_count != 0 || self.is_filled {
            // SAFETY: as the caller promises.
            unsafe { self.take_in(handle) }?;
        }
        // SAFETY: as the caller promises.
        let mut link = unsafe { Link::new(handle, &mut self.buffer, &mut self.subscribed) };
        code(&mut Context::new(&mut link, &self.inboxes))
    }

    /// Copies what arrived for the own subscriptions.
    ///
    /// # Safety
    /// As [`with`](Desk::with).
    unsafe fn take_in(&mut self, handle: &HostHandle) -> Result<(), Failure> {
        self.is_filled = handle.inbox_count != 0;
        for subscription in &self.subscribed {
            let place = *subscription as usize;
            if self.inboxes.len() <= place {
                self.inboxes.resize_with(place + 1, Vec::new);
            }
            let inbox = &mut self.inboxes[place];
            inbox.clear();
            if place >= handle.inbox_count {
                continue;
            }
            // SAFETY: the host lends `inbox_count` inboxes with their messages for the time of the call.
            unsafe {
                let lent = *handle.inboxes.add(place);
                for message in 0..lent.count {
                    inbox.push(copy(&*lent.messages.add(message))?);
                }
            }
        }
        Ok(())
    }
}

impl<C: DynComponent> Instance<C> {
    /// Gives the component away; [`ComponentTable::destroy`] takes it back.
    pub(super) fn into_pointer(component: C) -> *mut c_void {
        let instance = Instance { component, desk: Desk::default() };
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
            let Instance { component, desk } = &mut *this.cast::<Self>();
            desk.with(&*handle, takes_in, |context| code(component, context))
        }
    }

    unsafe extern "C" fn initialize(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: the host calls with what the table's contract says.
        unsafe {
            guarded(error, || {
                Self::call(this, handle, false, |component, context| component.initialize(context))
            })
        }
    }

    unsafe extern "C" fn execute(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || Self::call(this, handle, true, |component, context| component.execute(context)))
        }
    }

    unsafe extern "C" fn shutdown(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || {
                Self::call(this, handle, false, |component, context| component.shutdown(context))
            })
        }
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
                Self::call(this, handle, false, |component, context| {
                    component.serve(&mut invocation, context)
                })
            })
        }
    }

    unsafe extern "C" fn save(this: *mut c_void, saved: Sink, error: Sink) -> Status {
        // SAFETY: the host calls with what the table's contract says; `this` comes from `into_pointer` and is used by this call alone.
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
            guarded(error, || {
                (*this.cast::<Self>()).component.restore(&Saved::from_bytes(saved.get()?.to_vec()))
            })
        }
    }

    unsafe extern "C" fn destroy(this: *mut c_void) {
        // A panic while the component is dropped says nothing that its shutdown has not said.
        // SAFETY: the pointer is that of `into_pointer`, given back once.
        let _ = contained(|| drop(unsafe { Box::from_raw(this.cast::<Self>()) }));
    }
}

/// # Safety
/// The view's bytes are readable.
unsafe fn copy(view: &MessageView) -> Result<SharedMessage, Failure> {
    let header =
        Header { sender: view.sender, sent: super::host::time(view.sent), cause: crate::Cause(view.cause) };
    // SAFETY: as the caller promises.
    let bytes = unsafe { view.bytes.get() }?;
    Ok(SharedMessage::from_bytes(header, (view.has_key != 0).then_some(view.key), bytes.to_vec()))
}

#[cfg(test)]
mod tests {
    use super::super::HostFunctions;
    use super::super::host::FUNCTIONS;
    use super::*;

    #[test]
    fn a_program_that_is_older_than_the_library_is_refused() {
        let older = HostFunctions { size: size_of::<HostFunctions>() - size_of::<usize>(), ..FUNCTIONS };
        let host = |functions| HostHandle {
            state: std::ptr::null_mut(),
            functions,
            inboxes: std::ptr::null(),
            inbox_count: 0,
        };
        let initialized = |functions| {
            // SAFETY: the handle is there; nothing is called through it.
            unsafe { Desk::default().with(&host(functions), false, |_| Ok::<(), Failure>(())) }
        };
        assert_eq!(initialized(&raw const FUNCTIONS), Ok(()));
        let failure = initialized(&raw const older).unwrap_err();
        assert!(failure.message().starts_with("the program is older than the library"), "{failure}");
    }
}
