//! What ends a run from outside: signals, and a reader of standard output that goes away.

use std::mem::{ManuallyDrop, MaybeUninit};
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::Duration;

use saoms_api::host::contain::contained;
use saoms_core::schedule::{Handle, stop_hardware};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::output::{Place, eprint, limit_patience, wait_for_no_reader};
use crate::{Exit, guard};
use guard::keep_signals;

/// The signals that end a run, handled from its first moment on.
pub(super) struct Signalled(Arc<State>);

struct State {
    grace: Duration,
    has_come: AtomicBool,
    /// True while the fleet starts.
    starts: AtomicBool,
    /// The fleet, once it runs.
    fleet: OnceLock<Handle>,
}

impl Signalled {
    /// The first signal ends every component through its shutdown; Ctrl-C or SIGTERM after it ends the process at once.
    /// So does the first one before the fleet starts, and while it starts after `grace`, which is also the time for a
    /// reader of standard output that reads nothing.
    pub(super) fn new(grace: Duration) -> Signalled {
        // Who starts it with `nohup` wants it to outlive the terminal.
        let hangup = (!is_ignored(SIGHUP)).then_some(SIGHUP);
        guard::watch_ends();
        let signals = Signals::new([SIGINT, SIGTERM].into_iter().chain(hangup));
        let (has_come, starts) = (AtomicBool::new(false), AtomicBool::new(false));
        let state = Arc::new(State { grace, has_come, starts, fleet: OnceLock::new() });
        let handled = Arc::clone(&state);
        keep_signals(&[(SIGINT, "SIGINT"), (SIGTERM, "SIGTERM"), (SIGHUP, "SIGHUP")]);
        let spawned = signals.and_then(|signals| {
            // Never dropped: what it closed then might be closed already, or be something else by now.
            let mut signals = ManuallyDrop::new(signals);
            guard::handles_ends();
            let handle = move || {
                let handled = contained(|| signals.forever().for_each(|signal| handled.handle(signal)));
                if handled.is_err() {
                    cannot_wait();
                }
            };
            thread::Builder::new().name("signals".to_owned()).spawn(handle)
        });
        if let Err(error) = spawned {
            eprint(&format!("warning: Ctrl-C will end the process without a report: {error}\n"));
        }
        Signalled(state)
    }

    /// Says that the fleet starts.
    pub(super) fn starts(&self) {
        self.0.starts.store(true, Ordering::SeqCst);
    }

    /// Ends this fleet from now on, and at once if a signal has come.
    pub(super) fn end(&self, fleet: Handle) {
        let fleet = self.0.fleet.get_or_init(|| fleet);
        if self.has_come() {
            fleet.stop();
        }
    }

    /// What an operator ends the run with.
    pub(super) fn ending(&self) -> OperatorEnd {
        OperatorEnd(Arc::clone(&self.0))
    }

    /// True if one has come.
    pub(super) fn has_come(&self) -> bool {
        self.0.has_come.load(Ordering::SeqCst)
    }
}

/// The end of a run by an operator.
pub(super) struct OperatorEnd(Arc<State>);

impl OperatorEnd {
    /// Ends every component through its shutdown. A start that does not end within the grace is given up.
    pub(super) fn down(&self, fleet: &Handle) {
        limit_patience(self.0.grace);
        fleet.down();
        State::give_up(&self.0, Exit::Failed);
    }
}

impl State {
    fn handle(self: &Arc<State>, signal: i32) {
        // Of a terminal that is closed, the system and the shell tell one after the other.
        let is_second = self.has_come.swap(true, Ordering::SeqCst) && signal != SIGHUP;
        if is_second || !self.starts.load(Ordering::SeqCst) {
            end_now(Exit::Interrupted);
        }
        limit_patience(self.grace);
        match self.fleet.get() {
            Some(fleet) => fleet.stop(),
            None => self.give_up(Exit::Interrupted),
        }
    }

    /// Ends the process after the grace if the fleet still starts.
    fn give_up(self: &Arc<State>, exit: Exit) {
        if self.fleet.get().is_some() {
            return;
        }
        let state = Arc::clone(self);
        let give_up = move || {
            thread::sleep(state.grace);
            if state.fleet.get().is_none() {
                end_now(exit);
            }
        };
        // Without it, a second signal ends the process.
        let _ = thread::Builder::new().name("saoms-grace".to_owned()).spawn(give_up);
    }
}

/// Lets the signals end the process as they do by themselves: what was waited with is closed, by code of a library.
fn cannot_wait() {
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        if !is_ignored(signal) {
            // SAFETY: nothing is called for a signal that does what it does by itself.
            unsafe { libc::signal(signal, libc::SIG_DFL) };
        }
    }
    guard::forget_signals();
    let libraries = guard::libraries();
    eprint(&format!(
        "warning: Ctrl-C ends the process without a report: code of library `{libraries}` closed what the program waits \
         with\n"
    ));
}

/// Ends the process although something runs, and says what it is. Hardware is stopped before.
fn end_now(exit: Exit) -> ! {
    if let Some(waits) = guard::waited_for() {
        eprint(&format!("error: interrupted while {waits}\n"));
    }
    for name in stop_hardware(guard::STOP_PATIENCE) {
        eprint(&guard::still_moves(&name));
    }
    guard::exit(exit as i32)
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
