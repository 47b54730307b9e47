use std::ffi::c_void;

use saoms_abi::{FindingSink, ReadError, Sink, Status};

use crate::host::contain::{contained, contained_or};
use crate::host::shown;
use crate::{CallError, Failure};

use super::convert::put_findings;

/// Runs code of this side for a caller on the other: nothing unwinds, and the failure goes to the sink.
///
/// # Safety
/// The sink's owner waits for this call.
#[inline]
pub(super) unsafe fn guarded(error: Sink, code: impl FnOnce() -> Result<(), Failure>) -> Status {
    let failed = |failure: &Failure, status| {
        let (text, status) = match failure.busy_provider() {
            Some(provider) => (provider, Status::BUSY),
            None => (failure.message(), status),
        };
        // SAFETY: as the caller promises.
        unsafe { put_failure(error, text, status) }
    };
    let code = || match code() {
        Ok(()) => Status::OK,
        Err(failure) => failed(&failure, Status::FAILED),
    };
    contained_or(code, |panic| failed(&panic, Status::PANICKED), |status| status)
}

/// # Safety
/// The sink's owner waits for this call.
#[cold]
unsafe fn put_failure(error: Sink, text: &str, status: Status) -> Status {
    // SAFETY: as the caller promises.
    unsafe { error.put(text.as_bytes()) };
    status
}

/// The same for a constructor, whose failures can have findings.
///
/// # Safety
/// The owner of the sinks waits for this call.
pub(super) unsafe fn guarded_construct(
    findings: FindingSink,
    error: Sink,
    code: impl FnOnce() -> Result<*mut c_void, Failure>,
    instance: *mut *mut c_void,
) -> Status {
    // SAFETY: as the caller promises; the instance has a place.
    unsafe {
        guarded(error, || {
            *instance = code().inspect_err(|failure| put_findings(findings, failure.findings()))?;
            Ok(())
        })
    }
}

/// The same for a call of a service, whose errors are of several kinds.
///
/// # Safety
/// The sink's owner waits for this call.
pub(super) unsafe fn guarded_call(error: Sink, code: impl FnOnce() -> Result<(), CallError>) -> Status {
    let failed = match contained(code) {
        Ok(Ok(())) => return Status::OK,
        Ok(Err(failed)) => failed,
        Err(panic) => {
            // SAFETY: as the caller promises.
            unsafe { error.put(panic.message().as_bytes()) };
            return Status::PANICKED;
        }
    };
    let (status, texts): (_, [&str; 2]) = match &failed {
        CallError::NotWired { reference } => (Status::NOT_WIRED, [reference, ""]),
        CallError::Busy { provider } => (Status::BUSY, [provider, ""]),
        CallError::NotRunning { provider } => (Status::NOT_RUNNING, [provider, ""]),
        CallError::Mismatch { message } => (Status::MISMATCH, [message, ""]),
        CallError::Failed { provider, failure } => (Status::PROVIDER_FAILED, [provider, failure.message()]),
    };
    // SAFETY: as the caller promises.
    unsafe {
        error.put(texts[0].as_bytes());
        if status == Status::PROVIDER_FAILED {
            error.put(b"\0");
            error.put(texts[1].as_bytes());
        }
    }
    status
}

/// Runs code of this side that cannot answer with a failure: after a panic the answer is `otherwise`.
pub(super) fn guarded_value<T>(otherwise: T, code: impl FnOnce() -> T) -> T {
    contained(code).unwrap_or(otherwise)
}

/// The outcome of a call across the boundary, with the text that the other side put into the error sink.
#[inline]
pub(super) fn outcome(status: Status, error: &[u8]) -> Result<(), Failure> {
    if status == Status::OK { Ok(()) } else { Err(failure(status, error)) }
}

#[cold]
fn failure(status: Status, error: &[u8]) -> Failure {
    let message = shown(error);
    match (status, message.is_empty()) {
        (Status::BUSY, true) => Failure::new("answered that a component is busy, but not which"),
        (Status::BUSY, false) => CallError::Busy { provider: message.into_owned() }.into(),
        // What a call of its own answered, which it passes on as it is.
        (Status::NOT_WIRED | Status::NOT_RUNNING | Status::MISMATCH | Status::PROVIDER_FAILED, false) => {
            call_outcome(status, error).map_or_else(Failure::from, |()| Failure::new(message))
        }
        (_, false) => Failure::new(message),
        (Status::FAILED, true) => Failure::new("failed without a message"),
        (Status::PANICKED, true) => Failure::new("panicked without a message"),
        (Status::NOT_WIRED | Status::NOT_RUNNING | Status::MISMATCH | Status::PROVIDER_FAILED, true) => {
            Failure::new("answered that a call failed, but not why")
        }
        (Status(other), true) => Failure::new(format!("answered with the unknown status {other}")),
    }
}

/// The same for a call of a service.
pub(super) fn call_outcome(status: Status, error: &[u8]) -> Result<(), CallError> {
    let text = || shown(error).into_owned();
    Err(match status {
        Status::OK => return Ok(()),
        Status::NOT_WIRED => CallError::NotWired { reference: text() },
        Status::BUSY => CallError::Busy { provider: text() },
        Status::NOT_RUNNING => CallError::NotRunning { provider: text() },
        Status::MISMATCH => CallError::Mismatch { message: text() },
        Status::PROVIDER_FAILED => {
            let text = text();
            let (provider, message) = text.split_once('\0').unwrap_or(("", &text));
            CallError::Failed { provider: provider.to_owned(), failure: Failure::new(message) }
        }
        other => CallError::from(failure(other, error)),
    })
}

impl From<ReadError> for CallError {
    fn from(error: ReadError) -> CallError {
        Failure::from(error).into()
    }
}
