use std::sync::Arc;
use std::sync::atomic::{Ordering, fence};

use saoms_api::Level;

use super::{announce_end, handle_stop_request, prepare_thread, workers};
use crate::schedule::engine::slot::NEVER;
use crate::schedule::engine::{Engine, Next, RunPhase};
use crate::schedule::os::realtime::TIMER_PRIORITY;
use crate::schedule::os::sys;
use crate::schedule::settings::nanos;
use crate::schedule::shared::Shared;

/// Maximum time that the timer may be busy without a pause; beyond it the fleet overloads the machine.
const BUSY: u64 = 500_000_000;

/// Does the timer's work in real time, as long as the role's number is this: sleeps until something is due, and runs it
/// on this thread. The moment at which one execution ends is the moment at which the next one starts, so that a batch
/// reads the clock once for each.
pub(super) fn run(shared: &Arc<Shared>, role: u64) {
    prepare_thread(shared, TIMER_PRIORITY);
    let mut engine = shared.lock();
    if engine.roles.timer != role {
        return;
    }
    engine.roles.thread = sys::thread_id();
    let mut now = shared.clock.now();
    // A fleet may have started before this thread runs, so that it does not sleep first.
    shared.pulse.awake_at(shared.clock.on_machine(now));
    let mut load = Load { awake_since: now, overloaded: false, warned: false };
    let mut woke = true;
    loop {
        handle_stop_request(shared, &mut engine, now);
        match engine.next(now) {
            Next::Run(index, job) => {
                let Some(mut body) = engine.begin(index, job, now) else { continue };
                engine.roles.running = Some((index, job));
                shared.pulse.begin(shared.clock.on_machine(now));
                shared.release(engine);
                if std::mem::take(&mut woke) {
                    be_watched(shared, now);
                }
                let result = body.perform(shared, job);
                let ended = shared.clock.now();
                engine = shared.lock();
                let deposed = engine.roles.timer != role;
                if !deposed {
                    engine.roles.running = None;
                    shared.pulse.end();
                }
                engine.finish(index, body, job, result, now, ended);
                if deposed {
                    // Another thread has the timer's work since this one was too slow.
                    shared.release(engine);
                    return workers::work(shared);
                }
                now = ended;
                load.is_busy(shared, now);
            }
            Next::HandOver => engine = workers::hand_over(shared, engine),
            Next::Cut => engine.cut(&mut shared.sections(), now),
            Next::Sample => engine.sample(&shared.observers, &shared.sections()),
            Next::Wait(until) => {
                sleep(shared, engine, until);
                engine = shared.lock();
                engine.roles.asleep_until = 0;
                now = shared.clock.now();
                shared.pulse.awake_at(shared.clock.on_machine(now));
                woke = true;
                load.has_slept(shared, now);
            }
            Next::Ended => break,
        }
    }
    shared.release(engine);
    announce_end(shared);
}

fn sleep(shared: &Shared, mut engine: std::sync::MutexGuard<'_, Engine>, until: u64) {
    // Other threads change the engine under the lock, and then change the ticket.
    let ticket = shared.timer.ticket();
    if shared.stop.load(Ordering::SeqCst) && engine.phase == RunPhase::Running {
        // The stop request came after the last check, and before the ticket.
        return shared.release(engine);
    }
    if engine.phase == RunPhase::Stopping {
        // The waiting thread has to supervise the end from now on; the limit of the run did not wake it.
        shared.end.wake();
    }
    engine.roles.asleep_until = until;
    let until = if until == NEVER { NEVER } else { shared.clock.on_machine(until) };
    shared.pulse.awake_at(until);
    shared.release(engine);
    shared.timer.wait(ticket, (until != NEVER).then_some(until));
}

/// Wakes the spare thread if it would sleep through a blocked execution that begins now: the timer was woken before its
/// time. The fence pairs with the one of the spare thread, so that either it sees this execution, or this thread sees
/// until when it sleeps.
fn be_watched(shared: &Shared, now: u64) {
    fence(Ordering::SeqCst);
    if shared.pulse.unwatched(shared.clock.on_machine(now), nanos(shared.settings.budget)) {
        shared.spare.wake();
    }
}

/// Detector of an overload: a fleet that leaves the machine no time for others.
struct Load {
    awake_since: u64,
    overloaded: bool,
    warned: bool,
}

impl Load {
    /// A real-time thread that never sleeps would starve the machine, until the kernel throttles it. It continues as a
    /// normal thread.
    fn is_busy(&mut self, shared: &Shared, now: u64) {
        if self.overloaded || now.saturating_sub(self.awake_since) < BUSY {
            return;
        }
        self.overloaded = true;
        if shared.settings.realtime {
            // Lowering the own priority is always allowed.
            let _ = sys::set_normal(sys::thread_id());
        }
        if !std::mem::replace(&mut self.warned, true) {
            let text = "the executions of this fleet need more processor time than is available: they start late, and some will be missed";
            shared.note(Level::Warning, text.to_owned());
        }
    }

    fn has_slept(&mut self, shared: &Shared, now: u64) {
        self.awake_since = now;
        if std::mem::take(&mut self.overloaded) && shared.settings.realtime {
            prepare_thread(shared, TIMER_PRIORITY);
        }
    }
}
