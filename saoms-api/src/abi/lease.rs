use std::cell::{Cell, UnsafeCell};
use std::ffi::c_void;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::{fmt, mem, ptr};

use crate::{CallError, Context, Failure, Host, Knowledge, SharedMessage};

use super::data::Buffer;
use super::entries::KNOWLEDGE;
use super::finding::{FindingView, Findings, take};
use super::guard::{call_outcome, outcome};
use super::host::FUNCTIONS;
use super::{Bytes, EntriesHandle, FindingSink, HostHandle, Inbox, MessageView, Sink, Status};

/// What the other side is lent for the time of a call: a context, knowledge, sinks.
///
/// Code in C can keep a pointer that it was lent, and use it later or from a thread of its own. So what it is lent is never freed, and
/// says which thread may use it now. Nobody but a thread itself stores its own token, so the comparison needs no order.
struct Lease {
    /// The token of the thread whose call goes on; 0: nobody may use this.
    holder: AtomicUsize,
    /// How often somebody else tried.
    strays: AtomicU32,
    /// Whether a function of the host or of the knowledge runs. What those call on the other side must not call them again.
    in_use: Cell<bool>,
    host: Cell<Option<*mut dyn Host>>,
    knowledge: Cell<Option<*mut dyn Knowledge>>,
    handle: UnsafeCell<HostHandle>,
    entries: UnsafeCell<EntriesHandle>,
    /// Used again and again, so that nothing is allocated once they have grown.
    messages: UnsafeCell<Vec<MessageView>>,
    inboxes: UnsafeCell<Vec<Inbox>>,
    error: UnsafeCell<Buffer>,
    reply: UnsafeCell<Buffer>,
    findings: UnsafeCell<Findings>,
}

// SAFETY: all but the two atomic fields is used by the holder alone, or by the one owner of the `Lent` while there is no holder.
unsafe impl Sync for Lease {}
// SAFETY: the same; what the pointers lead to is used during calls alone, by the thread that lends it.
unsafe impl Send for Lease {}

/// Leases that nobody has at present.
static FREE: Mutex<Vec<&'static Lease>> = Mutex::new(Vec::new());

/// Buffers that grew beyond this are not kept.
const KEPT: usize = 1 << 16;

/// What the present thread is known by.
#[inline]
fn token() -> usize {
    thread_local!(static HERE: u8 = const { 0 });
    HERE.with(|here| ptr::from_ref(here) as usize)
}

impl Lease {
    fn new() -> &'static Lease {
        let lease: &'static Lease = Box::leak(Box::new(Lease {
            holder: AtomicUsize::new(0),
            strays: AtomicU32::new(0),
            in_use: Cell::new(false),
            host: Cell::new(None),
            knowledge: Cell::new(None),
            handle: UnsafeCell::new(HostHandle {
                state: ptr::null_mut(),
                functions: &FUNCTIONS,
                inboxes: ptr::null(),
                inbox_count: 0,
            }),
            entries: UnsafeCell::new(EntriesHandle { state: ptr::null_mut(), functions: &KNOWLEDGE }),
            messages: UnsafeCell::default(),
            inboxes: UnsafeCell::default(),
            error: UnsafeCell::default(),
            reply: UnsafeCell::default(),
            findings: UnsafeCell::default(),
        }));
        let state: *mut c_void = ptr::from_ref(lease).cast_mut().cast();
        // SAFETY: nobody else has the lease yet.
        unsafe {
            (*lease.handle.get()).state = state;
            (*lease.entries.get()).state = state;
        }
        lease
    }

    /// Whether the present thread may use what is lent; one that may not is remembered.
    #[inline]
    fn is_held(&self) -> bool {
        let held = self.holder.load(Ordering::Relaxed) == token();
        if !held {
            self.strays.fetch_add(1, Ordering::Relaxed);
        }
        held
    }

    fn begin_use(&self) -> Result<(), Failure> {
        if !self.is_held() {
            return Err(Failure::new(
                "a context was used from another thread, or when no call went on: it is lent for the time of a call",
            ));
        }
        if self.in_use.replace(true) {
            self.strays.fetch_add(1, Ordering::Relaxed);
            return Err(Failure::new("a context was used by what it called itself"));
        }
        Ok(())
    }
}

/// Something that is lent, while a function of it runs.
pub(super) struct InUse<T: ?Sized + 'static> {
    lease: &'static Lease,
    lent: *mut T,
}

impl<T: ?Sized> Deref for InUse<T> {
    type Target = T;

    fn deref(&self) -> &T {
        // SAFETY: the thread that lends it waits, as it is this one; `in_use` keeps others from it.
        unsafe { &*self.lent }
    }
}

impl<T: ?Sized> DerefMut for InUse<T> {
    fn deref_mut(&mut self) -> &mut T {
        // SAFETY: as above.
        unsafe { &mut *self.lent }
    }
}

impl<T: ?Sized> Drop for InUse<T> {
    fn drop(&mut self) {
        self.lease.in_use.set(false);
    }
}

/// The host that is lent behind this state.
///
/// # Errors
/// It is not lent to this thread now.
///
/// # Safety
/// The state is that of a handle, however old.
#[inline]
pub(super) unsafe fn host(state: *mut c_void) -> Result<InUse<dyn Host>, Failure> {
    // SAFETY: leases are never freed.
    let lease: &'static Lease = unsafe { &*state.cast::<Lease>() };
    lease.begin_use()?;
    let lent = lease.host.get().ok_or_else(|| {
        lease.in_use.set(false);
        Failure::new("no context is lent in this call")
    })?;
    Ok(InUse { lease, lent })
}

/// The knowledge that is lent behind this state.
///
/// # Errors
/// It is not lent to this thread now.
///
/// # Safety
/// The state is that of a handle, however old.
#[inline]
pub(super) unsafe fn knowledge(state: *mut c_void) -> Result<InUse<dyn Knowledge>, Failure> {
    // SAFETY: leases are never freed.
    let lease: &'static Lease = unsafe { &*state.cast::<Lease>() };
    lease.begin_use()?;
    let lent = lease.knowledge.get().ok_or_else(|| {
        lease.in_use.set(false);
        Failure::new("no knowledge is lent in this call")
    })?;
    Ok(InUse { lease, lent })
}

unsafe extern "C" fn put_error(state: *mut c_void, bytes: Bytes) {
    // SAFETY: leases are never freed; the buffer is the holder's, which the callee lends the bytes to.
    unsafe {
        let lease = &*state.cast::<Lease>();
        if lease.is_held() {
            (*lease.error.get()).take(bytes);
        }
    }
}

unsafe extern "C" fn put_reply(state: *mut c_void, bytes: Bytes) {
    // SAFETY: as in `put_error`.
    unsafe {
        let lease = &*state.cast::<Lease>();
        if lease.is_held() {
            (*lease.reply.get()).take(bytes);
        }
    }
}

unsafe extern "C" fn put_finding(state: *mut c_void, view: *const FindingView) {
    // SAFETY: as in `put_error`.
    unsafe {
        let lease = &*state.cast::<Lease>();
        if lease.is_held() {
            take(&mut *lease.findings.get(), view);
        }
    }
}

/// A lease of one's own, for one call after the other.
pub(super) struct Lent(&'static Lease);

impl Default for Lent {
    fn default() -> Lent {
        let free = FREE.lock().unwrap_or_else(PoisonError::into_inner).pop();
        Lent(free.unwrap_or_else(Lease::new))
    }
}

impl fmt::Debug for Lent {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("Lent")
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        let lease = self.0;
        lease.strays.store(0, Ordering::Relaxed);
        // SAFETY: there is no holder between calls, so this thread alone uses it.
        unsafe {
            (*lease.error.get()).reset(KEPT);
            (*lease.reply.get()).reset(KEPT);
            (*lease.findings.get()).clear();
        }
        FREE.lock().unwrap_or_else(PoisonError::into_inner).push(lease);
    }
}

impl Lent {
    /// Runs code of the other side.
    #[inline]
    fn hold(&mut self, code: impl FnOnce(Sink) -> Status) -> Status {
        let lease = self.0;
        lease.holder.store(token(), Ordering::Relaxed);
        // Nothing unwinds out of functions of the other side.
        let status = code(Sink { state: ptr::from_ref(lease).cast_mut().cast(), put: put_error });
        lease.holder.store(0, Ordering::Relaxed);
        status
    }

    /// What the call came to, with what the other side put for an error.
    #[inline]
    fn outcome(&mut self, status: Status) -> Result<(), Failure> {
        if status == Status::OK && self.0.strays.load(Ordering::Relaxed) == 0 {
            return Ok(());
        }
        self.failure(status)
    }

    #[cold]
    fn failure(&mut self, status: Status) -> Result<(), Failure> {
        // SAFETY: there is no holder, so this thread alone uses it.
        let error = unsafe { &mut *self.0.error.get() };
        let result = outcome(status, &error.bytes);
        error.reset(KEPT);
        let strays = self.0.strays.swap(0, Ordering::Relaxed);
        if strays == 0 {
            return result;
        }
        let stray = format!(
            "what is lent for the time of a call was used {strays} times from another thread, when no call went on, or by what it called, which was refused"
        );
        Err(Failure::new(match result {
            Ok(()) => stray,
            Err(failure) => format!("{failure} ({stray})"),
        }))
    }

    /// Lends a context to code on the other side.
    #[inline]
    fn with_context(
        &mut self,
        context: &mut Context<'_>,
        code: impl FnOnce(&mut Lent, *const HostHandle) -> Status,
    ) -> Status {
        let lease = self.0;
        let (host, inboxes) = context.parts();
        // SAFETY: this changes the lifetime alone; the pointer is taken out below, before the host's life can end.
        let host = unsafe { mem::transmute::<*mut (dyn Host + '_), *mut (dyn Host + 'static)>(host) };
        lease.host.set(Some(host));
        let arrived = inboxes.iter().any(|inbox| !inbox.is_empty());
        if arrived {
            self.lend(inboxes);
        }
        let status = code(self, lease.handle.get());
        lease.host.set(None);
        if arrived {
            self.take_back();
        }
        status
    }

    /// Calls a function with a context.
    #[inline]
    pub(super) fn call(
        &mut self,
        context: &mut Context<'_>,
        code: impl FnOnce(*const HostHandle, Sink) -> Status,
    ) -> Result<(), Failure> {
        let status = self.with_context(context, |lent, handle| lent.hold(|error| code(handle, error)));
        self.outcome(status)
    }

    /// Calls a function of a loop with knowledge and a context.
    pub(super) fn step(
        &mut self,
        knowledge: &mut dyn Knowledge,
        context: &mut Context<'_>,
        code: impl FnOnce(*const EntriesHandle, *const HostHandle, Sink) -> Status,
    ) -> Result<(), Failure> {
        let lease = self.0;
        // SAFETY: this changes the lifetime alone; the pointer is taken out below, before the knowledge's life can end.
        let knowledge =
            unsafe { mem::transmute::<*mut (dyn Knowledge + '_), *mut (dyn Knowledge + 'static)>(knowledge) };
        lease.knowledge.set(Some(knowledge));
        let status = self.with_context(context, |lent, handle| {
            lent.hold(|error| code(lease.entries.get(), handle, error))
        });
        lease.knowledge.set(None);
        self.outcome(status)
    }

    /// Calls a service; the reply is to be seen in place.
    pub(super) fn serve(
        &mut self,
        context: &mut Context<'_>,
        code: impl FnOnce(*const HostHandle, Sink, Sink) -> Status,
    ) -> Result<&[u8], CallError> {
        let into_reply = self.reply();
        let status =
            self.with_context(context, |lent, handle| lent.hold(|error| code(handle, into_reply, error)));
        // SAFETY: there is no holder, so this thread alone uses it.
        let error = unsafe { &mut *self.0.error.get() };
        let result = call_outcome(status, &error.bytes);
        error.reset(KEPT);
        result?;
        self.outcome(Status::OK)?;
        Ok(self.replied()?)
    }

    /// A sink for the reply of the next call.
    fn reply(&mut self) -> Sink {
        // SAFETY: there is no holder, so this thread alone uses it.
        unsafe { (*self.0.reply.get()).reset(KEPT) };
        Sink { state: ptr::from_ref(self.0).cast_mut().cast(), put: put_reply }
    }

    fn replied(&mut self) -> Result<&[u8], Failure> {
        // SAFETY: there is no holder, so this thread alone uses it.
        unsafe { &*self.0.reply.get() }.get()
    }

    /// Makes the messages of this period readable for the other side.
    fn lend(&mut self, inboxes: &[Vec<SharedMessage>]) {
        // SAFETY: there is no holder, so this thread alone uses them.
        let (messages, lent, handle) =
            unsafe { (&mut *self.0.messages.get(), &mut *self.0.inboxes.get(), &mut *self.0.handle.get()) };
        for message in inboxes.iter().flatten() {
            let header = message.header();
            messages.push(MessageView {
                bytes: Bytes::lend(message.bytes()),
                sent: header.sent.as_nanos(),
                cause: header.cause.0,
                key: message.key().unwrap_or(0),
                sender: header.sender,
                has_key: u32::from(message.key().is_some()),
            });
        }
        let mut rest = &messages[..];
        for inbox in inboxes {
            let (own, others) = rest.split_at(inbox.len());
            lent.push(Inbox { messages: own.as_ptr(), count: own.len() });
            rest = others;
        }
        (handle.inboxes, handle.inbox_count) = (lent.as_ptr(), lent.len());
    }

    fn take_back(&mut self) {
        // SAFETY: as in `lend`.
        unsafe {
            (*self.0.messages.get()).clear();
            (*self.0.inboxes.get()).clear();
            let handle = &mut *self.0.handle.get();
            (handle.inboxes, handle.inbox_count) = (ptr::null(), 0);
        }
    }
}

/// Calls a function that is lent a sink for errors.
pub(super) fn call(code: impl FnOnce(Sink) -> Status) -> Result<(), Failure> {
    let mut lent = Lent::default();
    let status = lent.hold(code);
    lent.outcome(status)
}

/// Calls a function that is lent a sink for bytes and one for errors.
pub(super) fn call_for_bytes(
    bytes: &mut Vec<u8>,
    code: impl FnOnce(Sink, Sink) -> Status,
) -> Result<(), Failure> {
    bytes.clear();
    let mut lent = Lent::default();
    let into_bytes = lent.reply();
    let status = lent.hold(|error| code(into_bytes, error));
    lent.outcome(status)?;
    bytes.extend_from_slice(lent.replied()?);
    Ok(())
}

/// Calls a function that is lent a sink for findings and one for errors.
pub(super) fn call_with_findings(
    code: impl FnOnce(FindingSink, Sink) -> Status,
) -> (Result<(), Failure>, Findings) {
    let mut lent = Lent::default();
    let sink = FindingSink { state: ptr::from_ref(lent.0).cast_mut().cast(), put: put_finding };
    let status = lent.hold(|error| code(sink, error));
    // SAFETY: there is no holder, so this thread alone uses it.
    let findings = mem::take(unsafe { &mut *lent.0.findings.get() });
    (lent.outcome(status), findings)
}
