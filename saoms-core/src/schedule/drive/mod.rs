//! The threads that drive the engine: one does the timer's work, in real time a spare one watches it, and workers run
//! components that took too long.

pub(super) mod pulse;
mod real;
pub(super) mod store_writer;
mod supervise;
#[cfg(test)]
mod tests;
mod virtual_time;
mod watchdog;
mod workers;

use std::io;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread;

use saoms_api::Level;

use crate::schedule::engine::Engine;
use crate::schedule::engine::ending::EndCause;
use crate::schedule::os::sys;
use crate::schedule::os::thread::start_thread;
use crate::schedule::settings::{ClockKind, nanos};
use crate::schedule::shared::Shared;

pub(super) use supervise::wait_until;

const TIMER: &str = "saoms-timer";

/// Starts the thread that does the timer's work, and in real time the one that watches it.
pub(super) fn spawn(shared: &Arc<Shared>) -> io::Result<()> {
    start_thread(TIMER, contained(shared, timer(shared, 0)))?;
    if shared.settings.clock == ClockKind::Real {
        start_thread(watchdog::SPARE, contained(shared, watchdog::watch))?;
    }
    Ok(())
}

/// Starts a thread that does the timer's work as long as the role's number is this.
fn spawn_timer(shared: &Arc<Shared>, role: u64) -> io::Result<()> {
    spawn_thread(shared, TIMER, timer(shared, role))
}

fn timer(shared: &Shared, role: u64) -> impl FnOnce(&Arc<Shared>) + Send + 'static + use<> {
    let drive = match shared.settings.clock {
        ClockKind::Real => real::run,
        ClockKind::Virtual => virtual_time::run,
    };
    move |shared| drive(shared, role)
}

/// Starts a thread in the middle of a run, and does not wait for it.
fn spawn_thread(shared: &Arc<Shared>, name: &str, run: impl FnOnce(&Arc<Shared>) + Send + 'static) -> io::Result<()> {
    thread::Builder::new().name(name.to_owned()).spawn(contained(shared, run)).map(drop)
}

fn contained<R: FnOnce(&Arc<Shared>) + Send + 'static>(
    shared: &Arc<Shared>,
    run: R,
) -> impl FnOnce() + Send + 'static + use<R> {
    let shared = Arc::clone(shared);
    move || {
        // Component code is contained elsewhere: this is a fault of the engine itself. The program must not wait for
        // ever.
        if panic::catch_unwind(AssertUnwindSafe(|| run(&shared))).is_err() {
            shared.lock().break_down();
            announce_end(&shared);
        }
    }
}

/// Gives the calling thread the sleep precision and the priority of its role.
fn prepare_thread(shared: &Shared, priority: i32) {
    sys::set_timer_slack(nanos(shared.settings.timer_slack));
    if shared.settings.realtime
        && let Err(error) = sys::set_fifo(sys::thread_id(), priority)
    {
        shared.note(Level::Warning, format!("a thread runs without real-time priority: {error}"));
    }
}

/// Begins the end of the run if it was requested.
#[inline]
fn handle_stop_request(shared: &Shared, engine: &mut Engine, now: u64) {
    if shared.stop.load(Ordering::Relaxed) {
        // Also a run that pauses ends.
        engine.end_pause();
        let is_down = shared.is_down.load(Ordering::Relaxed);
        engine.begin_stop(if is_down { EndCause::Stopped } else { EndCause::Interrupted }, now);
    }
}

/// Wakes all threads at the end of the run.
pub(super) fn announce_end(shared: &Shared) {
    shared.ended.store(true, Ordering::Release);
    shared.end.wake();
    shared.spare.wake();
    shared.timer.wake();
    shared.work.notify_all();
}
