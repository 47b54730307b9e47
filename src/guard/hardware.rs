//! Hardware is stopped before code of a library ends the process: by a thread that waits for it, since whoever ends the
//! process may be a signal handler, and its memory and locks in any state.

use std::cell::UnsafeCell;
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use saoms_api::host::present::present_library;
use saoms_core::schedule::{start_thread, stop_hardware};

use crate::output::eprint;

/// Time for hardware to come to rest before the process ends at once.
pub(crate) const STOP_PATIENCE: Duration = Duration::from_millis(500);

/// A semaphore of the system: one may be posted in a signal handler.
struct Semaphore(UnsafeCell<MaybeUninit<libc::sem_t>>);

// SAFETY: the system's functions for semaphores may be called on any thread at once.
unsafe impl Sync for Semaphore {}

static ASKED: Semaphore = Semaphore(UnsafeCell::new(MaybeUninit::uninit()));

/// True once the thread waits, and once it has stopped all hardware or given up.
static WAITS: AtomicBool = AtomicBool::new(false);
static STOPPED: AtomicBool = AtomicBool::new(false);

/// Starts the thread. Asked once.
pub(super) fn prepare() {
    // SAFETY: nobody uses the semaphore before, and it is never destroyed.
    if unsafe { libc::sem_init(ASKED.0.get().cast(), 0, 0) } != 0 {
        return;
    }
    let wait = || {
        // SAFETY: it was initialized.
        while unsafe { libc::sem_wait(ASKED.0.get().cast()) } != 0 {}
        for name in stop_hardware(STOP_PATIENCE) {
            eprint(&still_moves(&name));
        }
        STOPPED.store(true, Ordering::SeqCst);
    };
    match start_thread("saoms-last-stop", wait) {
        Ok(_) => WAITS.store(true, Ordering::SeqCst),
        Err(error) => eprint(&format!("warning: a crash in a library will not stop hardware: {error}\n")),
    }
}

/// Says that hardware may still move when the process ends.
pub(crate) fn still_moves(name: &str) -> String {
    let library = present_library(name).map(|library| format!(" (library `{library}`)")).unwrap_or_default();
    format!("error: the hardware of component `{name}` may still move: its stop function has not returned{library}\n")
}

/// Time for what was logged before the end of the process to be shown: it gathers for 10 ms at most.
const SHOWING: i32 = 20;

/// Lets other threads show what was logged before. A signal handler may ask.
pub(super) fn let_show() {
    // SAFETY: no descriptors are given; `poll` is safe in a signal handler.
    unsafe { libc::poll(ptr::null_mut(), 0, SHOWING) };
}

/// Stops all hardware and waits for that, but not much longer than the patience. A signal handler may ask.
pub(super) fn stop() {
    if !WAITS.load(Ordering::SeqCst) {
        return;
    }
    // SAFETY: the semaphore was initialized before the thread waited; `sem_post` and `poll` are safe in a signal
    // handler.
    unsafe { libc::sem_post(ASKED.0.get().cast()) };
    let most = STOP_PATIENCE.as_millis() + 100;
    for _ in 0..most {
        if STOPPED.load(Ordering::SeqCst) {
            return;
        }
        // SAFETY: no descriptors are given.
        unsafe { libc::poll(ptr::null_mut(), 0, 1) };
    }
}
