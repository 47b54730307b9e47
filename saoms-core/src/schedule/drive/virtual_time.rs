use std::sync::Arc;

use saoms_api::Level;
use saoms_api::extension::RunSummary;

use super::{announce_end, handle_stop_request};
use crate::schedule::engine::ending::EndCause;
use crate::schedule::engine::slot::NEVER;
use crate::schedule::engine::{Engine, Next, RunPhase};
use crate::schedule::hold::keep_pace;
use crate::schedule::os::sys;
use crate::schedule::shared::Shared;

/// Time of the run, in nanoseconds, after which a run without an end is reported: one hour.
const ENDLESS: u64 = 3_600_000_000_000;

/// Drives the engine in virtual time, as long as the role's number is this: components that are due run in order, then
/// time jumps to the next due time.
pub(super) fn run(shared: &Arc<Shared>, role: u64) {
    let mut engine = shared.lock();
    engine.roles.thread = sys::thread_id();
    let mut now = shared.clock.now();
    let mut endless = if engine.limit == NEVER { ENDLESS } else { NEVER };
    loop {
        if engine.roles.timer != role {
            return shared.release(engine);
        }
        if engine.is_announcing {
            engine = sleep(shared, engine);
            continue;
        }
        handle_stop_request(shared, &mut engine, now);
        if engine.is_changing && engine.phase == RunPhase::Running {
            engine = sleep(shared, engine);
            continue;
        }
        if engine.records.as_ref().is_some_and(|records| records.is_full()) {
            engine = wait_for_journal(shared, engine);
            continue;
        }
        let next = if engine.phase == RunPhase::Running && now >= engine.pause {
            match engine.next_while_paused(now) {
                Some(next) => next,
                None if engine.phase != RunPhase::Running => continue,
                None => {
                    engine = sleep(shared, engine);
                    continue;
                }
            }
        } else {
            engine.next(now)
        };
        match next {
            Next::Run(index, job) => {
                let Some(mut body) = engine.begin(index, job, now) else { continue };
                engine.roles.running = Some((index, job));
                shared.pulse.begin(now);
                shared.release(engine);
                let result = body.perform(shared, job);
                engine = shared.lock();
                if engine.roles.timer == role {
                    engine.roles.running = None;
                }
                engine.finish(index, body, job, result, now, now);
            }
            // No component runs on a worker thread in virtual time, and nothing outlives the program.
            Next::HandOver | Next::Cut => {}
            Next::Sample => engine.sample(&shared.observers, &shared.sections()),
            Next::Wait(_) if engine.phase == RunPhase::Running && now >= engine.hold => engine = sleep(shared, engine),
            Next::Wait(until) if engine.phase == RunPhase::Running && engine.advance_to(until) < NEVER => {
                let before = std::mem::replace(&mut now, engine.advance_to(until));
                if engine.pace.is_some() {
                    (engine, now) = keep_pace(shared, engine, (before, now));
                }
                shared.clock.jump(now);
                if now >= endless && engine.pause == NEVER {
                    endless = NEVER;
                    if engine.votes.voters == 0 && engine.standstill.told.is_none() {
                        shared.note(Level::Warning, endless_warning());
                    }
                }
            }
            Next::Wait(_) => {
                // No component will ever be due: time cannot advance.
                if engine.phase == RunPhase::Running {
                    engine.begin_stop(EndCause::Idle, now);
                } else {
                    engine = sleep(shared, engine);
                }
            }
            Next::Ended => break,
        }
    }
    shared.release(engine);
    announce_end(shared);
}

impl Engine {
    /// The time to which virtual time may advance, where nothing is due before `until`.
    #[inline]
    fn advance_to(&self, until: u64) -> u64 {
        until.min(self.pause).min(self.hold)
    }
}

/// Waits until the observers of the journal have taken some records.
fn wait_for_journal<'a>(
    shared: &'a Shared,
    engine: std::sync::MutexGuard<'a, Engine>,
) -> std::sync::MutexGuard<'a, Engine> {
    let records = engine.records.clone();
    shared.release(engine);
    if let Some(records) = records {
        records.wait_for_room();
    }
    shared.lock()
}

/// Waits until another thread changes the engine.
fn sleep<'a>(shared: &'a Shared, mut engine: std::sync::MutexGuard<'a, Engine>) -> std::sync::MutexGuard<'a, Engine> {
    let ticket = shared.timer.ticket();
    engine.roles.asleep_until = NEVER;
    shared.release(engine);
    shared.end.wake();
    shared.timer.wait(ticket, None);
    let mut engine = shared.lock();
    engine.roles.asleep_until = 0;
    engine
}

/// The warning about a run without an end.
fn endless_warning() -> String {
    let voters: String = RunSummary::linked().iter().map(|summary| format!(", or {}", summary.voters)).collect();
    format!(
        "no component says when its work is done, so virtual time continues until Ctrl-C: \
         give the run an end with `--for`{voters}"
    )
}
