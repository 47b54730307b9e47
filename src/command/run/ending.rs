//! What ends a run from outside: signals, and a reader of standard output that goes away.

use std::io;
use std::mem::MaybeUninit;
use std::process;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use saoms_core::schedule::Handle;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::Exit;
use crate::output::{Place, eprint, limit_patience, wait_for_no_reader};

/// The signals that end a run. Those that arrive before it starts wait for it.
pub(super) struct Signalled {
    signals: io::Result<Signals>,
    has_come: Arc<AtomicBool>,
}

impl Signalled {
    pub(super) fn new() -> Signalled {
        // Who starts it with `nohup` wants it to outlive the terminal.
        let hangup = (!is_ignored(SIGHUP)).then_some(SIGHUP);
        let signals = Signals::new([SIGINT, SIGTERM].into_iter().chain(hangup));
        Signalled { signals, has_come: Arc::default() }
    }

    /// The first signal ends every component through its shutdown; Ctrl-C or SIGTERM after it ends the process at once.
    /// `grace` is the time for a reader of standard output that reads nothing. The flag says whether one has come.
    pub(super) fn end(self, fleet: Handle, grace: Duration) -> Arc<AtomicBool> {
        let has_come = Arc::clone(&self.has_come);
        let spawned = self.signals.and_then(|mut signals| {
            thread::Builder::new().name("signals".to_owned()).spawn(move || {
                for signal in signals.forever() {
                    // Of a terminal that is closed, the system and the shell tell one after the other.
                    if self.has_come.swap(true, Ordering::SeqCst) && signal != SIGHUP {
                        process::exit(Exit::Interrupted as i32);
                    }
                    limit_patience(grace);
                    fleet.stop();
                }
            })
        });
        if let Err(error) = spawned {
            eprint(&format!("warning: Ctrl-C will end the process without a report: {error}\n"));
        }
        has_come
    }
}

fn is_ignored(signal: i32) -> bool {
    let mut action = MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: no new action is given, and the present one is written to where there is room for it.
    let is_known = unsafe { libc::sigaction(signal, ptr::null(), action.as_mut_ptr()) } == 0;
    // SAFETY: the call has written it.
    is_known && unsafe { action.assume_init() }.sa_sigaction == libc::SIG_IGN
}

/// Ends the fleet when nobody reads standard output any more, also while there is nothing to write.
pub(super) fn end_without_reader(fleet: Handle) {
    if !Place::is_standard_output_read() {
        return;
    }
    let watch = move || {
        if wait_for_no_reader().is_ok() {
            fleet.stop();
        }
    };
    // Without it, the run goes on to its own end.
    let _ = thread::Builder::new().name("reader".to_owned()).spawn(watch);
}
