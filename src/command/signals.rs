//! Signals that end a command from outside.

use std::io;
use std::mem::MaybeUninit;
use std::ptr;

use saoms_core::schedule::start_thread;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::{Exit, guard};

/// The signals that end a command: those of a terminal and of whoever stops processes. Who starts it with `nohup` wants
/// it to outlive the terminal.
pub(super) fn ending_signals() -> impl Iterator<Item = i32> {
    [SIGINT, SIGTERM].into_iter().chain((!is_ignored(SIGHUP)).then_some(SIGHUP))
}

/// At the first signal that ends the command, does this on a thread of its own, and ends the process.
///
/// # Errors
/// The system gives no handler or no thread: a signal ends the process as it does by itself.
pub(super) fn at_first_signal(then: impl FnOnce() + Send + 'static) -> io::Result<()> {
    let mut signals = Signals::new(ending_signals())?;
    guard::handles_ends();
    start_thread("signals", move || {
        if signals.forever().next().is_some() {
            then();
            guard::exit(Exit::Interrupted as i32);
        }
    })
    .map(drop)
}

/// True if the process was started so that it ignores the signal.
pub(super) fn is_ignored(signal: i32) -> bool {
    let mut action = MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: no new action is given, and the present one is written to where there is room for it.
    let is_known = unsafe { libc::sigaction(signal, ptr::null(), action.as_mut_ptr()) } == 0;
    // SAFETY: the call has written it.
    is_known && unsafe { action.assume_init() }.sa_sigaction == libc::SIG_IGN
}
