//! What ends a simulation from outside: signals.

use std::process::Child;
use std::sync::{Arc, Mutex, PoisonError};

use crate::command::signals::at_first_signal;
use crate::output::eprint;

/// A process that runs seeds, for those who end it.
pub(super) type Shared = Arc<Mutex<Child>>;

/// The processes that run seeds.
static WORKERS: Mutex<Vec<Shared>> = Mutex::new(Vec::new());

/// Ends the process and those that run seeds for it at the first signal.
pub(super) fn end_at_signals() {
    let handled = at_first_signal(|| {
        // One whose end is waited for has nothing to do any more.
        let workers = WORKERS.lock().unwrap_or_else(PoisonError::into_inner);
        for worker in workers.iter() {
            let _ = worker.try_lock().map(|mut child| child.kill());
        }
        // It stays locked until the process has ended, so that nobody starts another one.
        std::mem::forget(workers);
    });
    if let Err(error) = handled {
        eprint(&format!("warning: a signal will end the command with another exit code than 130: {error}\n"));
    }
}

/// Notes a process that a signal ends, too.
pub(super) fn share(child: Child) -> Shared {
    let child = Arc::new(Mutex::new(child));
    WORKERS.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::clone(&child));
    child
}

/// Waits for the end of a process; gives how it ended.
pub(super) fn wait_for(child: &Shared) -> String {
    let ended = child.lock().unwrap_or_else(PoisonError::into_inner).wait();
    WORKERS.lock().unwrap_or_else(PoisonError::into_inner).retain(|one| !Arc::ptr_eq(one, child));
    ended.map_or_else(|error| error.to_string(), |status| status.to_string())
}
