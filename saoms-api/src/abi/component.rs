use std::ffi::c_void;

use crate::contain::contained;
use crate::{Context, DynComponent, Failure, Header, Invocation, SharedMessage};

use super::data::MessageView;
use super::guard::{guarded, guarded_call, outcome};
use super::link::Link;
use super::service::BytesCall;
use super::{Bytes, HostHandle, Sink, Status};

/// The functions of the components of a class. [`Component`](crate::Component) says when each is called.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "named as the functions of `Component`, which says what they mean")]
pub struct ComponentTable {
    /// The size of this table in bytes.
    pub size: usize,
    pub initialize: unsafe extern "C" fn(*mut c_void, *const HostHandle, Sink) -> Status,
    pub execute: unsafe extern "C" fn(*mut c_void, *const HostHandle, Sink) -> Status,
    pub shutdown: unsafe extern "C" fn(*mut c_void, *const HostHandle, Sink) -> Status,
    /// Serves a call: the service's name, the operation, the arguments, where the reply and an error go.
    pub serve: unsafe extern "C" fn(*mut c_void, *const HostHandle, Bytes, u32, Bytes, Sink, Sink) -> Status,
    /// Frees the component.
    pub destroy: unsafe extern "C" fn(*mut c_void),
}

/// A component of this side as the other one holds it, behind a pointer.
pub struct Instance<C> {
    component: C,
    inboxes: Vec<Vec<SharedMessage>>,
    buffer: Vec<u8>,
}

impl<C: DynComponent> Instance<C> {
    /// Gives the component away; [`ComponentTable::destroy`] takes it back.
    pub(super) fn into_pointer(component: C) -> *mut c_void {
        let instance = Instance { component, inboxes: Vec::new(), buffer: Vec::new() };
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
    };

    /// # Safety
    /// `this` comes from `into_pointer` and is used by this call alone; the handle is that of the call.
    unsafe fn call<T>(
        this: *mut c_void,
        handle: *const HostHandle,
        code: impl FnOnce(&mut C, &mut Context<'_>) -> T,
    ) -> Result<T, Failure> {
        // SAFETY: as the caller promises.
        unsafe {
            let Instance { component, inboxes, buffer } = &mut *this.cast::<Self>();
            let handle = &*handle;
            if handle.inbox_count > 0 {
                take_in(handle, inboxes)?;
            }
            let mut link = Link::new(handle, buffer);
            let result = code(component, &mut Context::new(&mut link, inboxes));
            if handle.inbox_count > 0 {
                inboxes.iter_mut().for_each(Vec::clear);
            }
            Ok(result)
        }
    }

    unsafe extern "C" fn initialize(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: the host calls with what the table's contract says.
        unsafe {
            guarded(error, || Self::call(this, handle, |component, context| component.initialize(context))?)
        }
    }

    unsafe extern "C" fn execute(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || Self::call(this, handle, |component, context| component.execute(context))?)
        }
    }

    unsafe extern "C" fn shutdown(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || Self::call(this, handle, |component, context| component.shutdown(context))?)
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
                Self::call(this, handle, |component, context| component.serve(&mut invocation, context))?
            })
        }
    }

    unsafe extern "C" fn destroy(this: *mut c_void) {
        // A panic while the component is dropped says nothing that its shutdown has not said.
        // SAFETY: the pointer is that of `into_pointer`, given back once.
        let _ = contained(|| drop(unsafe { Box::from_raw(this.cast::<Self>()) }));
    }
}

/// Copies what arrived.
///
/// # Safety
/// The handle is that of a call that goes on.
unsafe fn take_in(handle: &HostHandle, inboxes: &mut Vec<Vec<SharedMessage>>) -> Result<(), Failure> {
    inboxes.resize_with(handle.inbox_count, Vec::new);
    for (place, inbox) in inboxes.iter_mut().enumerate() {
        inbox.clear();
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

/// # Safety
/// The view's bytes are readable.
unsafe fn copy(view: &MessageView) -> Result<SharedMessage, Failure> {
    let header =
        Header { sender: view.sender, sent: super::host::time(view.sent), cause: crate::Cause(view.cause) };
    // SAFETY: as the caller promises.
    let bytes = unsafe { view.bytes.get() }?;
    Ok(SharedMessage::from_bytes(header, (view.has_key != 0).then_some(view.key), bytes.to_vec()))
}

/// What is left over from a call of the other side: its text, if it said one.
pub(super) fn call(code: impl FnOnce(Sink) -> Status) -> Result<(), Failure> {
    let mut error = Vec::new();
    let status = code(Sink::into(&mut error));
    outcome(status, &error)
}
