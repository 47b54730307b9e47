use std::sync::{Arc, MutexGuard};

use saoms_api::Level;

use super::spawn_thread;
use crate::schedule::component::body::Job;
use crate::schedule::engine::slot::SlotState;
use crate::schedule::engine::{Engine, RunPhase};
use crate::schedule::os::sys;
use crate::schedule::shared::{Shared, relock};

/// Maximum number of idle worker threads.
const IDLE_WORKERS: usize = 4;
/// Maximum number of worker threads.
const WORKERS: usize = 256;

/// Runs components that took too long before, until there are enough idle workers. The caller is counted among the
/// workers.
pub(super) fn work(shared: &Arc<Shared>) {
    if shared.settings.realtime {
        // A thread inherits the priority of the one that starts it. Giving it up is always allowed.
        let _ = sys::set_normal(sys::thread_id());
    }
    let mut engine = shared.lock();
    while engine.phase == RunPhase::Running {
        let Some(index) = engine.roles.work.pop_front() else {
            if engine.roles.idle_workers >= IDLE_WORKERS {
                break;
            }
            engine.roles.idle_workers += 1;
            engine = relock(&shared.work, engine);
            engine.roles.idle_workers -= 1;
            continue;
        };
        let started = shared.clock.now();
        let has_order = engine.has_order_for(index, started);
        let describe = engine.questions.job();
        let slot = &mut engine.slots[index as usize];
        slot.queued = false;
        if slot.body.is_none() {
            slot.waiting = true;
            continue;
        }
        let order = has_order.then_some(Job::Order);
        let question = match (slot.asked, slot.asked_to_wait) {
            (true, _) => Some(describe),
            (false, true) => Some(Job::Ask),
            (false, false) => None,
        };
        let question = question.filter(|_| slot.state == SlotState::Active);
        if order.is_none() && question.is_none() {
            // One that starts or leaves has nothing to say.
            engine.note_answer(index);
            engine.note_waiting(index);
        }
        let Some(job) = order.or(question).or_else(|| engine.job(index, started)) else { continue };
        let Some(mut body) = engine.begin(index, job, started) else { continue };
        shared.release(engine);
        let result = body.perform(shared, job);
        let ended = shared.clock.now();
        engine = shared.lock();
        engine.finish(index, body, job, result, started, ended);
        // Delivers the notifications, and wakes the timer if it has to wake earlier.
        shared.release(engine);
        engine = shared.lock();
    }
    engine.roles.workers -= 1;
    shared.release(engine);
}

/// Makes sure that a worker takes the queued components.
pub(super) fn hand_over<'a>(shared: &'a Arc<Shared>, mut engine: MutexGuard<'a, Engine>) -> MutexGuard<'a, Engine> {
    let enough = engine.roles.work.len() <= engine.roles.idle_workers;
    if enough || engine.roles.workers >= WORKERS {
        shared.work.notify_one();
        return engine;
    }
    engine.roles.workers += 1;
    let stops = Arc::clone(&engine.stops);
    shared.release(engine);
    stops.watch();
    let spawned = spawn_thread(shared, "saoms-worker", work);
    let mut engine = shared.lock();
    if let Err(error) = spawned {
        engine.roles.workers -= 1;
        if engine.roles.workers == 0 {
            // Without worker threads the components run on the timer again: late is better than never.
            while let Some(index) = engine.roles.work.pop_front() {
                let slot = &mut engine.slots[index as usize];
                slot.queued = false;
                slot.isolation.active = false;
                engine.enqueue(index, 0);
            }
        }
        shared
            .note(Level::Warning, format!("slow components have to wait: the system cannot create a thread: {error}"));
    }
    engine
}
