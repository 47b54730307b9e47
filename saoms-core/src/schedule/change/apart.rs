//! Code of components that a change runs on threads of their own, so that one which does not return holds up neither
//! the change nor the fleet.

use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use saoms_api::host::contain::contained;
use saoms_api::host::format_duration;
use saoms_api::{Failure, Level};

use super::takeover::Outgoing;
use crate::schedule::component::body::Body;
use crate::schedule::shared::Shared;

#[cfg(test)]
mod tests;

/// Code of a component that has not returned in time.
pub(super) struct Unreturned {
    /// Its body, if its code has not even begun. Otherwise the thread has it, and is left behind.
    pub(super) body: Option<Box<Body>>,
    /// What has not returned.
    pub(super) failure: Failure,
}

/// A body whose code has returned, and its result.
pub(super) type Performed<T> = (Box<Body>, Result<T, Failure>);

/// How far the code on another thread is.
enum Stage<T> {
    Ready(Box<Body>),
    Runs,
    Returned(Box<Body>, Result<T, Failure>),
    /// Nobody waits for it any more.
    LeftBehind,
}

struct Apart<T> {
    stage: Mutex<Stage<T>>,
    returned: Condvar,
}

impl<T> Apart<T> {
    fn lock(&self) -> MutexGuard<'_, Stage<T>> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Runs code with a body on a thread of its own, and gives the body back if the code returns within a time. Otherwise
/// the thread is left behind, and `late` gets what returns later. `what` names the code. A panic of the code is its
/// failure, and its instance is dropped.
pub(super) fn within<T: Send + 'static>(
    shared: &Arc<Shared>,
    (what, time): (&str, Duration),
    body: Box<Body>,
    code: impl FnOnce(&mut Body, &Arc<Shared>) -> Result<T, Failure> + Send + 'static,
    late: impl FnOnce(Box<Body>, Result<T, Failure>, &Arc<Shared>) + Send + 'static,
) -> Result<Performed<T>, Unreturned> {
    let apart = Arc::new(Apart { stage: Mutex::new(Stage::Ready(body)), returned: Condvar::new() });
    let (there, of_fleet) = (Arc::clone(&apart), Arc::clone(shared));
    let run = move || {
        let ready = std::mem::replace(&mut *there.lock(), Stage::Runs);
        let Stage::Ready(mut body) = ready else {
            // It begins too late.
            return;
        };
        let result = contained(|| code(&mut body, &of_fleet)).unwrap_or_else(|panic| {
            body.discard();
            Err(panic)
        });
        let mut stage = there.lock();
        if matches!(*stage, Stage::LeftBehind) {
            drop(stage);
            if let Err(panic) = contained(|| late(body, result, &of_fleet)) {
                of_fleet.note(Level::Error, format!("code that a change of the fleet has left behind {panic}"));
            }
            return;
        }
        *stage = Stage::Returned(body, result);
        drop(stage);
        there.returned.notify_all();
    };
    let spawned = spawn(run);
    let mut stage = apart.lock();
    if spawned.is_ok() {
        let is_awaited = |stage: &mut Stage<T>| !matches!(stage, Stage::Returned(..));
        stage = apart.returned.wait_timeout_while(stage, time, is_awaited).unwrap_or_else(PoisonError::into_inner).0;
    }
    let body = match std::mem::replace(&mut *stage, Stage::LeftBehind) {
        Stage::Returned(body, result) => return Ok((body, result)),
        Stage::Ready(body) => Some(body),
        Stage::Runs | Stage::LeftBehind => None,
    };
    drop(stage);
    let failure = match spawned {
        Err(error) => format!("the system cannot create a thread: {error}"),
        Ok(_) if body.is_some() => format!("{what} has not begun within {}", format_duration(time)),
        Ok(_) => format!("{what} has not returned within {}, and its thread is left behind", format_duration(time)),
    };
    Err(Unreturned { body, failure: Failure::new(failure) })
}

/// The same for code of a component that goes on afterwards, whenever that is: meanwhile its hardware is stopped as
/// that of any other one whose code does not return.
pub(super) fn within_member<T: Send + 'static>(
    shared: &Arc<Shared>,
    limit: (&str, Duration),
    body: Box<Body>,
    code: impl FnOnce(&mut Body, &Arc<Shared>) -> Result<T, Failure> + Send + 'static,
    goes_on: impl FnOnce(Box<Body>, Result<T, Failure>, &Arc<Shared>) + Send + 'static,
) -> Result<Performed<T>, Unreturned> {
    let number = body.part.index;
    shared.lock().enter_code(number);
    let performed = within(shared, limit, body, code, goes_on);
    if !matches!(performed, Err(Unreturned { body: None, .. })) {
        shared.lock().leave_code(number);
    }
    performed
}

/// Starts a thread that may be left behind.
fn spawn(code: impl FnOnce() + Send + 'static) -> io::Result<()> {
    #[cfg(test)]
    if tests::NO_THREADS.load(std::sync::atomic::Ordering::SeqCst) {
        return Err(io::ErrorKind::WouldBlock.into());
    }
    thread::Builder::new().name("saoms-change".to_owned()).spawn(code).map(drop)
}

/// Drops instances that are no part of the fleet any more. Their destructors are code of components, too.
pub(super) fn drop_apart(shared: &Shared, outgoing: Vec<Outgoing>) {
    for one in outgoing {
        let (ends, ended) = std::sync::mpsc::channel::<()>();
        let name = one.name().to_owned();
        let drop_one = move || {
            // A panic of its destructor does not concern its successor.
            let _ = contained(|| drop(one));
            drop(ends);
        };
        let spawned = spawn(drop_one);
        // Where there is no thread for it, it is dropped already.
        let limit = shared.settings.grace;
        if spawned.is_ok() && ended.recv_timeout(limit) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
            let text = format!(
                "the destructor of an instance of component `{name}` that is no part of the fleet any more has not \
                 returned within {}, and its thread is left behind",
                format_duration(limit)
            );
            shared.note(Level::Warning, text);
        }
    }
}
