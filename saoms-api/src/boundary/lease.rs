use std::sync::PoisonError;
use std::sync::atomic::Ordering;
use std::{fmt, mem, process, ptr};

use saoms_abi::{Bytes, EntriesHandle, FindingSink, HostHandle, Inbox, MessageView, Sink, Status};

use crate::host::Host;
use crate::host::SharedMessage;
use crate::host::contain::resume;
use crate::{CallError, Context, Failure, Knowledge};

use super::convert::Findings;
use super::guard::{call_outcome, outcome};
use super::lease_cell::{FREE, LeaseCell, put_error, put_finding, put_reply, token};

/// The size up to which a buffer is kept between calls.
const KEPT: usize = 1 << 16;

/// A context, knowledge and sinks for the other side, lent for one call after the other. Any other use is refused, and
/// fails the call.
pub struct Lease(&'static LeaseCell);

impl Default for Lease {
    fn default() -> Lease {
        let free = FREE.lock().unwrap_or_else(PoisonError::into_inner).pop();
        Lease(free.unwrap_or_else(LeaseCell::new))
    }
}

impl fmt::Debug for Lease {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("Lease")
    }
}

impl Drop for Lease {
    fn drop(&mut self) {
        let lease = self.0;
        lease.misuses.store(0, Ordering::Relaxed);
        // SAFETY: there is no holder between calls, so this thread alone uses it.
        unsafe {
            (*lease.error.get()).reset(KEPT);
            (*lease.reply.get()).reset(KEPT);
            (*lease.findings.get()).clear();
        }
        FREE.lock().unwrap_or_else(PoisonError::into_inner).push(lease);
    }
}

/// Ends the process when it is dropped, while something unwinds.
struct EndsIfUnwound;

impl Drop for EndsIfUnwound {
    fn drop(&mut self) {
        process::abort();
    }
}

impl Lease {
    /// Runs code of the other side.
    #[inline]
    fn hold(&mut self, code: impl FnOnce(Sink) -> Status) -> Status {
        let lease = self.0;
        lease.holder.store(token(), Ordering::Relaxed);
        // Nothing unwinds out of functions of the other side, or the process ends here: an exception of another
        // language cannot be caught, and behind this it would not be known any more whose it was.
        let ends = EndsIfUnwound;
        let status = code(Sink { state: ptr::from_ref(lease).cast_mut().cast(), put: put_error });
        mem::forget(ends);
        lease.holder.store(0, Ordering::Relaxed);
        status
    }

    /// The outcome of a call, with the text that the other side put for an error.
    #[inline]
    fn outcome(&mut self, status: Status) -> Result<(), Failure> {
        if status == Status::OK && self.0.misuses.load(Ordering::Relaxed) == 0 {
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
        let misuses = self.0.misuses.swap(0, Ordering::Relaxed);
        if misuses == 0 {
            return result;
        }
        let misuse = format!(
            "the context or knowledge of a call was used {misuses} times from another thread, after the call, or by code that it called: this was refused"
        );
        Err(Failure::new(match result {
            Ok(()) => misuse,
            Err(failure) => format!("{failure} ({misuse})"),
        }))
    }

    /// Lends a context to code on the other side.
    #[inline]
    fn with_context(
        &mut self,
        context: &mut Context<'_>,
        code: impl FnOnce(&mut Lease, *const HostHandle) -> Status,
    ) -> Status {
        let lease = self.0;
        let has_departed = context.has_departed();
        let (host, inboxes) = context.parts();
        let arrived = has_departed || inboxes.iter().any(|inbox| !inbox.is_empty());
        // SAFETY: this changes the lifetime alone; the pointer is taken out below, before the host's life can end.
        let host = unsafe { mem::transmute::<*mut (dyn Host + '_), *mut (dyn Host + 'static)>(host) };
        lease.host.set(Some(host));
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
    ///
    /// # Errors
    /// The code answers with a failure, or the lease was misused.
    ///
    /// # Panics
    /// The code panicked.
    #[inline]
    pub fn call(
        &mut self,
        context: &mut Context<'_>,
        code: impl FnOnce(*const HostHandle, Sink) -> Status,
    ) -> Result<(), Failure> {
        let status = self.with_context(context, |lent, handle| lent.hold(|error| code(handle, error)));
        resumed(status, self.outcome(status))
    }

    /// Calls a function of a loop with knowledge and a context.
    ///
    /// # Errors
    /// As [`call`](Lease::call).
    pub fn step(
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
        let status =
            self.with_context(context, |lent, handle| lent.hold(|error| code(lease.entries.get(), handle, error)));
        lease.knowledge.set(None);
        self.outcome(status)
    }

    /// Calls a service; the reply stays in the lease.
    ///
    /// # Errors
    /// The code answers with an error, or the lease was misused.
    ///
    /// # Panics
    /// The code panicked.
    pub fn serve(
        &mut self,
        context: &mut Context<'_>,
        code: impl FnOnce(*const HostHandle, Sink, Sink) -> Status,
    ) -> Result<&[u8], CallError> {
        let into_reply = self.reply();
        let status = self.with_context(context, |lent, handle| lent.hold(|error| code(handle, into_reply, error)));
        if status == Status::PANICKED {
            resumed(status, self.outcome(status))?;
        }
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

/// The outcome, unless the other side panicked: that goes on here, so that it is handled as a panic of linked code.
#[inline]
fn resumed(status: Status, outcome: Result<(), Failure>) -> Result<(), Failure> {
    match outcome {
        Err(failure) if status == Status::PANICKED => resume(failure),
        outcome => outcome,
    }
}

/// Calls a function that is lent a sink for errors.
///
/// # Errors
/// It answers with a failure, or the sink was misused.
///
/// # Panics
/// It panicked.
pub fn call(code: impl FnOnce(Sink) -> Status) -> Result<(), Failure> {
    let mut lent = Lease::default();
    let status = lent.hold(code);
    resumed(status, lent.outcome(status))
}

/// Calls a function that is lent a sink for bytes and one for errors.
///
/// # Errors
/// As [`call`].
///
/// # Panics
/// As [`call`].
pub fn call_for_bytes(bytes: &mut Vec<u8>, code: impl FnOnce(Sink, Sink) -> Status) -> Result<(), Failure> {
    bytes.clear();
    let mut lent = Lease::default();
    let into_bytes = lent.reply();
    let status = lent.hold(|error| code(into_bytes, error));
    resumed(status, lent.outcome(status))?;
    bytes.extend_from_slice(lent.replied()?);
    Ok(())
}

/// Calls a function that is lent a sink for findings and one for errors.
pub fn call_with_findings(code: impl FnOnce(FindingSink, Sink) -> Status) -> (Result<(), Failure>, Findings) {
    let mut lent = Lease::default();
    let sink = FindingSink { state: ptr::from_ref(lent.0).cast_mut().cast(), put: put_finding };
    let status = lent.hold(|error| code(sink, error));
    // SAFETY: there is no holder, so this thread alone uses it.
    let findings = mem::take(unsafe { &mut *lent.0.findings.get() });
    (lent.outcome(status), findings)
}
