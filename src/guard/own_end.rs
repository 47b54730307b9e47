//! Signals that end a run or the program, where code of a library sends them to its own process: told by name. What
//! handles them else goes on.

use std::ffi::{c_int, c_void};
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};

use super::blame::{is_program, keep_process};
use super::signals::{action, default_again, set};
use super::stray::Origin;

const ENDINGS: [(c_int, &str); 3] = [(libc::SIGINT, "SIGINT"), (libc::SIGTERM, "SIGTERM"), (libc::SIGHUP, "SIGHUP")];

static TOLD: [AtomicBool; ENDINGS.len()] = [const { AtomicBool::new(false) }; ENDINGS.len()];

/// True while a run handles them, which calls what is installed here before.
static ARE_HANDLED: AtomicBool = AtomicBool::new(false);

/// Watches the senders of those that nobody handles or ignores, as of those that are handled later.
pub(crate) fn watch_ends() {
    keep_process();
    for (signal, _) in ENDINGS {
        if action(signal).is_some_and(|now| now.sa_sigaction == libc::SIG_DFL) {
            let handler: extern "C" fn(c_int, *mut libc::siginfo_t, *mut c_void) = ended;
            // SAFETY: what the handler calls is safe in a signal handler.
            unsafe {
                set(signal, handler as *const () as usize, libc::SA_SIGINFO | libc::SA_ONSTACK | libc::SA_RESTART)
            };
        }
    }
}

/// Says that a run handles them from now on.
pub(crate) fn handles_ends() {
    ARE_HANDLED.store(true, Ordering::SeqCst);
}

/// True if code of a library has sent one.
pub(crate) fn has_own_end() -> bool {
    TOLD.iter().any(|told| told.load(Ordering::SeqCst))
}

extern "C" fn ended(signal: c_int, info: *mut libc::siginfo_t, _: *mut c_void) {
    let top = 0_u8;
    let Some(place) = ENDINGS.iter().position(|(known, _)| *known == signal) else { return };
    let (is_program, is_handled) = (is_program(), ARE_HANDLED.load(Ordering::SeqCst));
    // SAFETY: the system lends what it knows of the signal.
    let origin = unsafe { Origin::of(info) };
    if is_program && origin.is_of_this_process() && !TOLD[place].swap(true, Ordering::SeqCst) {
        let after = if is_handled { ": it ends the run\n" } else { ": it ends the program\n" };
        origin.tell(ptr::from_ref(&top) as usize, "error: ", ENDINGS[place].1, after);
    }
    // A child that code of a library forked would tell the program of its own end.
    if !is_handled || !is_program {
        default_again(signal);
    }
}
