use std::sync::Arc;

use saoms_api::Level;
use saoms_api::host::format_duration;

use super::{announce_end, handle_stop_request, spawn_timer};
use crate::schedule::engine::ending::EndCause;
use crate::schedule::engine::{Engine, RunPhase};
use crate::schedule::os::sys;
use crate::schedule::settings::nanos;
use crate::schedule::shared::Shared;

/// Waits until `reached` holds or the run has ended. Meanwhile abandons components that do not end in time, and in
/// virtual time those that do not return at all.
pub(crate) fn wait_until(shared: &Arc<Shared>, reached: impl Fn(&Engine) -> bool) {
    let mut stall = StallDetector { piece: 0, since: sys::monotonic() };
    loop {
        let ticket = shared.end.ticket();
        let mut engine = shared.lock();
        if engine.phase == RunPhase::Ended || reached(&engine) {
            return shared.release(engine);
        }
        handle_stop_request(shared, &mut engine, shared.clock.now());
        let mut look_again = None;
        let mut replaced = None;
        if shared.clock.is_virtual() && engine.phase == RunPhase::Running {
            let (until, culprit) = stall.look(shared, &engine);
            look_again = Some(until);
            if let Some(index) = culprit {
                let limit = format_duration(shared.settings.virtual_watchdog);
                engine.abandon(Some(index), &format!("did not return within {limit}"), shared.clock.now());
                engine.begin_stop(EndCause::Lost, shared.clock.now());
                replaced = engine.replace_timer();
            }
        }
        if engine.phase == RunPhase::Stopping {
            let grace = nanos(shared.settings.grace);
            let now = sys::monotonic();
            if now >= engine.ended.1.saturating_add(grace) {
                let why = format!("did not end within {}", format_duration(shared.settings.grace));
                engine.abandon(None, &why, shared.clock.now());
                engine.ended.1 = now;
                replaced = engine.replace_timer();
            }
            look_again = Some(engine.ended.1.saturating_add(grace));
        }
        shared.release(engine);
        if let Some(role) = replaced
            && let Err(error) = spawn_timer(shared, role)
        {
            // Without a thread no component can shut down.
            shared.note(
                Level::Error,
                format!("components could not shut down: the system cannot create a thread: {error}"),
            );
            shared.lock().phase = RunPhase::Ended;
            return announce_end(shared);
        }
        shared.end.wait(ticket, look_again);
    }
}

/// State of the watchdog for code that runs in virtual time.
struct StallDetector {
    piece: u64,
    since: u64,
}

impl StallDetector {
    /// Time of the next check, and the component that has run too long. A check is late by a quarter of the budget at
    /// most.
    fn look(&mut self, shared: &Shared, engine: &Engine) -> (u64, Option<u32>) {
        let now = sys::monotonic();
        let allowed = nanos(shared.settings.virtual_watchdog);
        let piece = shared.pulse.begun();
        // A component that waits for a blocked observer is not stuck by itself.
        if piece != self.piece || engine.roles.running.is_none() || shared.events.has_waiting_writers() {
            *self = StallDetector { piece, since: now };
        }
        let culprit = engine.roles.running.filter(|_| now - self.since >= allowed).map(|(index, _)| index);
        (now.saturating_add((allowed / 4).max(1_000_000)), culprit)
    }
}

impl Engine {
    /// Takes the timer's work from a thread whose code was given up; the number of the role for the next one.
    fn replace_timer(&mut self) -> Option<u64> {
        let (index, _) = self.roles.running?;
        if !self.is_abandoned(index) {
            return None;
        }
        self.roles.running = None;
        self.roles.timer += 1;
        Some(self.roles.timer)
    }
}
