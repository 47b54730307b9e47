//! What ends a run from outside: signals, and a reader of standard output that goes away.

use std::mem::ManuallyDrop;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use saoms_api::Level;
use saoms_api::host::contain::contained;
use saoms_core::schedule::{Handle, Order, start_thread, stop_hardware};
use saoms_lang::model::Hangup;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::command::signals::{ending_signals, is_ignored};
use crate::output::{Place, eprint, limit_patience, lose_terminal, wait_for_no_reader};
use crate::{Exit, guard};
use guard::keep_signals;

/// The signals that end a run, handled from its first moment on.
pub(super) struct Signalled(Arc<State>);

/// Who stops machines when the terminal is lost, in the journal and the log.
const LOST_TERMINAL: &str = "lost-terminal";
/// The system and the shell tell of a lost terminal one after the other, and its reader goes away at about that time.
const TOGETHER: Duration = Duration::from_secs(1);
/// Time between two looks at whether it is lost.
const LOOK: Duration = Duration::from_millis(10);

struct State {
    grace: Duration,
    /// True once a signal has come that ends the run.
    has_come: AtomicBool,
    /// True while the fleet starts.
    starts: AtomicBool,
    /// What a lost terminal leads to, once the composite is read.
    hangup: OnceLock<Hangup>,
    /// When a terminal was lost that does not end the run.
    lost: Mutex<Option<Instant>>,
    /// The fleet, as soon as it can be reached.
    reached: OnceLock<Handle>,
    /// The fleet, once it runs.
    fleet: OnceLock<Handle>,
}

impl Signalled {
    /// The first signal ends every component through its shutdown; Ctrl-C or SIGTERM after it ends the process at once.
    /// So does the first one before the fleet starts, and while it starts after `grace`, which is also the time for a
    /// reader of standard output that reads nothing.
    pub(super) fn new(grace: Duration) -> Signalled {
        guard::watch_ends();
        let signals = Signals::new(ending_signals());
        let state = Arc::new(State {
            grace,
            has_come: AtomicBool::new(false),
            starts: AtomicBool::new(false),
            hangup: OnceLock::new(),
            lost: Mutex::default(),
            reached: OnceLock::new(),
            fleet: OnceLock::new(),
        });
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
            start_thread("signals", handle)
        });
        if let Err(error) = spawned {
            eprint(&format!("warning: Ctrl-C will end the process without a report: {error}\n"));
        }
        Signalled(state)
    }

    /// Says that the fleet starts, and what a lost terminal leads to from now on.
    pub(super) fn starts(&self, hangup: Hangup) {
        // It is set once, by the one run.
        let _ = self.0.hangup.set(hangup);
        self.0.starts.store(true, Ordering::SeqCst);
    }

    /// Says that the fleet can be reached, although it may still start.
    pub(super) fn reaches(&self, fleet: &Handle) {
        let lost = self.0.lost.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = self.0.reached.set(fleet.clone());
        if lost.is_some() {
            self.0.follow_hangup(fleet);
        }
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

/// The end of a run by an operator, or for want of what it needs.
#[derive(Clone)]
pub(super) struct OperatorEnd(Arc<State>);

impl OperatorEnd {
    /// Ends every component through its shutdown. A start that does not end within the grace is given up.
    pub(super) fn down(&self, fleet: &Handle) {
        limit_patience(self.0.grace);
        fleet.down();
        State::give_up(&self.0, Exit::Failed);
    }

    /// True if a signal has come that ends the run.
    pub(super) fn has_come(&self) -> bool {
        self.0.has_come.load(Ordering::SeqCst)
    }

    /// Ends every component through its shutdown, as a signal does.
    pub(super) fn interrupt(&self, fleet: &Handle) {
        self.0.has_come.store(true, Ordering::SeqCst);
        limit_patience(self.0.grace);
        fleet.stop();
    }
}

impl State {
    fn hangup(&self) -> Hangup {
        self.hangup.get().copied().unwrap_or_default()
    }

    fn handle(self: &Arc<State>, signal: i32) {
        if signal == SIGHUP && self.hangup() != Hangup::End {
            return self.lose_terminal();
        }
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

    /// Goes on without the terminal.
    fn lose_terminal(&self) {
        let mut lost = self.lost.lock().unwrap_or_else(PoisonError::into_inner);
        let is_told = lost.is_some_and(|before| before.elapsed() < TOGETHER);
        *lost = Some(Instant::now());
        lose_terminal();
        limit_patience(self.grace);
        if let Some(fleet) = self.reached.get().filter(|_| !is_told) {
            self.follow_hangup(fleet);
        }
    }

    /// Does what the composite chose for a lost terminal that does not end the run.
    fn follow_hangup(&self, fleet: &Handle) {
        let warn = |text: String| fleet.note(Level::Warning, text);
        if self.hangup() == Hangup::GoOn {
            return warn("the terminal is lost: the fleet goes on".to_owned());
        }
        warn("the terminal is lost: all that moves is stopped until `saoms release`".to_owned());
        let stop = Order::EmergencyStop { components: Vec::new(), by: Some(LOST_TERMINAL.to_owned()) };
        if let Err(error) = fleet.order(stop, None) {
            warn(format!("nothing is stopped: {error}"));
        }
    }

    /// True if a reader that goes away does so because the terminal is lost.
    fn has_lost_terminal(&self) -> bool {
        if self.hangup() == Hangup::End {
            return false;
        }
        let is_lost = || self.lost.lock().unwrap_or_else(PoisonError::into_inner).is_some();
        let until = Instant::now() + TOGETHER;
        // The reader may hear of it first.
        while !is_lost() && Instant::now() < until {
            thread::sleep(LOOK);
        }
        is_lost()
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
        "warning: Ctrl-C ends the process without a report: code of library `{libraries}` closed the descriptor with \
         which the program waits for signals\n"
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

/// Ends the fleet when nobody reads standard output any more, also while there is nothing to write; not if that comes
/// of a lost terminal without which the fleet goes on.
pub(super) fn end_without_reader(fleet: Handle, signals: &Signalled) {
    if !Place::is_standard_output_read() {
        return;
    }
    let state = Arc::clone(&signals.0);
    let watch = move || {
        if wait_for_no_reader().is_ok() && !state.has_lost_terminal() {
            fleet.stop();
        }
    };
    // Without it, the run goes on to its own end.
    let _ = thread::Builder::new().name("reader".to_owned()).spawn(watch);
}
