use std::io;
use std::sync::Arc;
use std::sync::atomic::{Ordering, fence};

use saoms_api::Level;

use super::{prepare_thread, real, spawn_thread};
use crate::observe::Occurrence;
use crate::schedule::engine::Engine;
use crate::schedule::engine::slot::NEVER;
use crate::schedule::os::realtime::{SPARE_PRIORITY, TIMER_PRIORITY};
use crate::schedule::os::sys;
use crate::schedule::settings::nanos;
use crate::schedule::shared::Shared;

pub(super) const SPARE: &str = "saoms-spare";

/// Starts the spare thread that watches the thread with the timer's work.
pub(super) fn spawn(shared: &Arc<Shared>) -> io::Result<()> {
    spawn_thread(shared, SPARE, watch)
}

/// Sleeps until the code that runs has used up its budget, or the one that is due next could have. When it has, this
/// thread takes over the timer's work. The timer only writes down what it does; it makes no system call for its
/// watcher.
pub(super) fn watch(shared: &Arc<Shared>) {
    prepare_thread(shared, SPARE_PRIORITY);
    let budget = nanos(shared.settings.budget);
    let mut least = 0;
    // The timer was woken before its time, as by a message, and may be soon again. This thread then wakes once in a
    // budget for as long as that goes on: to be woken for each of these executions would delay them.
    let mut is_expecting = false;
    let mut last = shared.pulse.begun();
    while !shared.ended.load(Ordering::Acquire) {
        let ticket = shared.spare.ticket();
        let present = shared.pulse.present();
        let from = present.since.unwrap_or(present.next);
        let mut until = if from == NEVER { NEVER } else { from.saturating_add(budget).max(least) };
        let now = sys::monotonic();
        if is_expecting && present.since.is_none() {
            until = until.min(now.saturating_add(budget));
        }
        shared.pulse.watch_from(until);
        fence(Ordering::SeqCst);
        if shared.pulse.present() != present {
            continue;
        }
        if now < until {
            shared.spare.wait(ticket, (until != NEVER).then_some(until));
            let is_woken = shared.spare.ticket() != ticket;
            let begun = shared.pulse.begun();
            is_expecting = is_woken || is_expecting && begun != last;
            last = begun;
            continue;
        }
        if present.since.is_some() {
            let engine = shared.lock();
            if shared.pulse.present() == present && engine.roles.running.is_some() {
                return take_over(shared, engine);
            }
        }
        // The timer itself is late; nothing can be done about that from here.
        least = now.saturating_add(budget);
    }
}

/// Makes the calling thread the timer. The former one ends its execution, and is a worker then.
fn take_over(shared: &Arc<Shared>, mut engine: std::sync::MutexGuard<'_, Engine>) {
    engine.roles.timer += 1;
    let role = engine.roles.timer;
    let slow = engine.roles.thread;
    engine.roles.thread = sys::thread_id();
    engine.roles.workers += 1;
    shared.pulse.end();
    if let Some((index, job)) = engine.roles.running.take() {
        engine.slots[index as usize].isolation.isolate();
        let now = shared.clock.now();
        engine.emit(now, index, Occurrence::Slow { what: job.name(), budget: shared.settings.budget });
    }
    let stops = Arc::clone(&engine.stops);
    shared.release(engine);
    stops.watch();
    if shared.settings.realtime {
        // Both only lower a priority, which is always allowed.
        let _ = sys::set_normal(slow);
        let _ = sys::set_fifo(sys::thread_id(), TIMER_PRIORITY);
    }
    if let Err(error) = spawn(shared) {
        shared.note(
            Level::Warning,
            format!("slow executions are not detected any more: the system cannot create a thread: {error}"),
        );
    }
    real::run(shared, role);
}
