use std::cell::{Cell, UnsafeCell};
use std::ffi::c_void;
use std::ops::{Deref, DerefMut};
use std::ptr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

use saoms_abi::{Bytes, EntriesHandle, FindingView, HostHandle, Inbox, MessageView};

use crate::host::Host;
use crate::{Failure, Knowledge};

use super::buffer::Buffer;
use super::convert::{Findings, take_finding};
use super::entries::KNOWLEDGE;
use super::host::HOST_FUNCTIONS;

/// The memory behind a [`Lease`]: a context, knowledge and sinks that the other side is lent for the time of a call.
///
/// Code in C can keep a pointer that it was lent, and use it later or from a thread of its own. So a cell is never
/// freed, and records which thread may use it now. Only a thread itself stores its own token, so the comparison needs
/// no order.
pub(super) struct LeaseCell {
    /// The token of the thread with the active call; 0: no thread may use the cell.
    pub(super) holder: AtomicUsize,
    /// The number of refused uses.
    pub(super) misuses: AtomicU32,
    /// True while a function of the host or of the knowledge runs. Code that those call on the other side must not call
    /// them again.
    in_use: Cell<bool>,
    pub(super) host: Cell<Option<*mut dyn Host>>,
    pub(super) knowledge: Cell<Option<*mut dyn Knowledge>>,
    pub(super) handle: UnsafeCell<HostHandle>,
    pub(super) entries: UnsafeCell<EntriesHandle>,
    /// Kept between calls, so that nothing is allocated once they have grown.
    pub(super) messages: UnsafeCell<Vec<MessageView>>,
    pub(super) inboxes: UnsafeCell<Vec<Inbox>>,
    pub(super) error: UnsafeCell<Buffer>,
    pub(super) reply: UnsafeCell<Buffer>,
    pub(super) findings: UnsafeCell<Findings>,
}

// SAFETY: all but the two atomic fields is used by the holder alone, or by the one owner of the `Lease` while there is
// no holder.
unsafe impl Sync for LeaseCell {}
// SAFETY: the same; what the pointers lead to is used during calls alone, by the thread that lends it.
unsafe impl Send for LeaseCell {}

/// The cells without a [`Lease`].
pub(super) static FREE: Mutex<Vec<&'static LeaseCell>> = Mutex::new(Vec::new());

/// The token of the present thread.
#[inline]
pub(super) fn token() -> usize {
    thread_local!(static HERE: u8 = const { 0 });
    HERE.with(|here| ptr::from_ref(here) as usize)
}

impl LeaseCell {
    pub(super) fn new() -> &'static LeaseCell {
        let lease: &'static LeaseCell = Box::leak(Box::new(LeaseCell {
            holder: AtomicUsize::new(0),
            misuses: AtomicU32::new(0),
            in_use: Cell::new(false),
            host: Cell::new(None),
            knowledge: Cell::new(None),
            handle: UnsafeCell::new(HostHandle {
                state: ptr::null_mut(),
                functions: &HOST_FUNCTIONS,
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
        // SAFETY: no other thread has the lease yet.
        unsafe {
            (*lease.handle.get()).state = state;
            (*lease.entries.get()).state = state;
        }
        lease
    }

    /// True if the present thread may use the cell; otherwise the misuse is counted.
    #[inline]
    fn is_held(&self) -> bool {
        let held = self.holder.load(Ordering::Relaxed) == token();
        if !held {
            self.misuses.fetch_add(1, Ordering::Relaxed);
        }
        held
    }

    fn begin_use(&self) -> Result<(), Failure> {
        if !self.is_held() {
            return Err(Failure::new(
                "a context was used from another thread or after its call: it is valid only during the call",
            ));
        }
        if self.in_use.replace(true) {
            self.misuses.fetch_add(1, Ordering::Relaxed);
            return Err(Failure::new("a context was used by code that it had called"));
        }
        Ok(())
    }
}

/// A context or knowledge that is lent, while a function of it runs.
pub(super) struct InUse<T: ?Sized + 'static> {
    lease: &'static LeaseCell,
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
    // SAFETY: cells are never freed.
    let lease: &'static LeaseCell = unsafe { &*state.cast::<LeaseCell>() };
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
    // SAFETY: cells are never freed.
    let lease: &'static LeaseCell = unsafe { &*state.cast::<LeaseCell>() };
    lease.begin_use()?;
    let lent = lease.knowledge.get().ok_or_else(|| {
        lease.in_use.set(false);
        Failure::new("no knowledge is lent in this call")
    })?;
    Ok(InUse { lease, lent })
}

pub(super) unsafe extern "C" fn put_error(state: *mut c_void, bytes: Bytes) {
    // SAFETY: cells are never freed; the buffer is the holder's, which the callee lends the bytes to.
    unsafe {
        let lease = &*state.cast::<LeaseCell>();
        if lease.is_held() {
            (*lease.error.get()).take(bytes);
        }
    }
}

pub(super) unsafe extern "C" fn put_reply(state: *mut c_void, bytes: Bytes) {
    // SAFETY: as in `put_error`.
    unsafe {
        let lease = &*state.cast::<LeaseCell>();
        if lease.is_held() {
            (*lease.reply.get()).take(bytes);
        }
    }
}

pub(super) unsafe extern "C" fn put_finding(state: *mut c_void, view: *const FindingView) {
    // SAFETY: as in `put_error`.
    unsafe {
        let lease = &*state.cast::<LeaseCell>();
        if lease.is_held() {
            take_finding(&mut *lease.findings.get(), view);
        }
    }
}
