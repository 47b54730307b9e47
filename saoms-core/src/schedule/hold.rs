//! Pause of a run, and the speed of virtual time.
//!
//! Neither is a part of the run: executions and messages of virtual time are the same with and without it. While a run
//! pauses, orders take effect and components are asked for their status, but none executes.

use std::fmt;
use std::time::Duration;

use saoms_api::{Level, Time};

use super::engine::slot::NEVER;
use super::engine::{Engine, RunPhase};
use super::os::sys;
use super::settings::nanos;
use super::shared::Shared;
use crate::observe::Occurrence;

/// The speed of virtual time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// So many seconds of virtual time in a second: more than 0, at most 1,000,000.
    Factor(f64),
    /// As fast as the machine allows.
    Unlimited,
}

/// The greatest factor.
const FASTEST: f64 = 1e6;

impl std::str::FromStr for Speed {
    type Err = String;

    /// A factor such as `10` or `0.5`, or `max`.
    fn from_str(text: &str) -> Result<Speed, String> {
        if text == "max" {
            return Ok(Speed::Unlimited);
        }
        match text.trim_end_matches('x').parse() {
            Ok(factor) if factor > 0.0 && factor <= FASTEST => Ok(Speed::Factor(factor)),
            _ => Err(format!("found `{text}`, expected a factor such as `10` or `0.5`, at most {FASTEST}, or `max`")),
        }
    }
}

/// Error of a change of time that is not possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldError {
    /// Only virtual time has steps and a speed.
    RealTime,
    /// The run ends.
    Ending,
}

impl fmt::Display for HoldError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            HoldError::RealTime => "the fleet runs in real time: only virtual time (`--virtual`) has steps and a speed",
            HoldError::Ending => "the run ends",
        })
    }
}

impl std::error::Error for HoldError {}

/// The speed of virtual time, and since when it counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    pub(super) factor: f64,
    /// A time on the machine's clock and the virtual time that belongs to it, once time has passed.
    since: Option<(u64, u64)>,
}

impl Pace {
    /// The machine's time that belongs to a virtual time; `now` is that of the machine and of the run.
    pub(super) fn on_machine(&mut self, time: u64, now: (u64, u64)) -> u64 {
        let (machine, run) = *self.since.get_or_insert(now);
        machine.saturating_add((time.saturating_sub(run) as f64 / self.factor) as u64)
    }

    /// The virtual time that belongs to a time of the machine.
    pub(super) fn at(&self, machine: u64) -> u64 {
        self.since
            .map_or(0, |(since, run)| run.saturating_add((machine.saturating_sub(since) as f64 * self.factor) as u64))
    }
}

impl Engine {
    fn is_ending(&self) -> bool {
        matches!(self.phase, RunPhase::Stopping | RunPhase::Ended)
    }

    /// True if no time of the run passes: somebody pauses it, or does not let virtual time advance. At a slow speed it
    /// passes.
    pub(super) fn stands_still(&self, now: u64) -> bool {
        now >= self.hold || !self.real && now >= self.pause
    }

    /// Lets the pace count from the next moment on.
    pub(super) fn restart_pace(&mut self) {
        if let Some(pace) = &mut self.pace {
            pace.since = None;
        }
    }

    /// Lets the time of the run go on, if it pauses.
    pub(super) fn end_pause(&mut self) {
        if self.hold == NEVER {
            return;
        }
        let now = self.clock.now();
        self.clock.go_on();
        self.hold = NEVER;
        // The clock that went on in the pause goes back: code that began meanwhile would be of the future.
        for slot in self.slots.iter_mut().filter(|slot| slot.out_since != NEVER && slot.out_since > now) {
            if slot.hangs_since == slot.out_since {
                slot.hangs_since = now;
            }
            slot.out_since = now;
        }
    }

    /// The time at which code of a component begins, by the clock that goes on in a pause: hardware moves then, too.
    #[inline]
    pub(super) fn begin_of_code(&self, now: u64) -> u64 {
        if self.real && self.hold != NEVER { self.clock.now_without_pause() } else { now }
    }

    /// Lets the time of the run stand before the executions that are due next; gives the present time.
    fn begin_pause(&mut self) -> u64 {
        self.clock.hold();
        let now = self.clock.now();
        // Executions of a time belong together.
        self.hold = if self.clock.is_virtual() { self.next_instant(now) } else { now };
        self.note_pause(true, now);
        now
    }

    fn note_hold(&mut self, now: u64, text: String) {
        self.note(now, Occurrence::Note { level: Level::Info, text });
    }
}

/// Pauses a run before the executions that are due next. Gives the time at which it stands.
pub(super) fn pause(shared: &Shared) -> Result<Time, HoldError> {
    let mut engine = shared.lock();
    if engine.is_ending() {
        return Err(HoldError::Ending);
    }
    if engine.hold == NEVER {
        let now = engine.begin_pause();
        engine.note_hold(now, "paused".to_owned());
    }
    let at = engine.hold;
    engine.wake = true;
    shared.release(engine);
    Ok(Time::from_nanos(at))
}

/// Pauses a run that was paused when an earlier program left it, before it starts.
pub(super) fn still_pause(shared: &Shared) {
    let mut engine = shared.lock();
    engine.begin_pause();
    shared.release(engine);
}

/// Lets a paused run go on.
pub(super) fn resume(shared: &Shared) -> Result<(), HoldError> {
    let mut engine = shared.lock();
    if engine.is_ending() {
        return Err(HoldError::Ending);
    }
    if engine.hold != NEVER {
        let now = shared.clock.now();
        engine.end_pause();
        engine.note_pause(false, now);
        engine.restart_pace();
        engine.note_hold(now, "resumed".to_owned());
        engine.wake = true;
    }
    shared.release(engine);
    Ok(())
}

/// Lets virtual time advance by a time, or to the end of the next instant at which something is due, and pauses there.
/// Gives the time at which it will stand.
pub(super) fn step(shared: &Shared, time: Option<Duration>) -> Result<Time, HoldError> {
    if !shared.clock.is_virtual() {
        return Err(HoldError::RealTime);
    }
    let mut engine = shared.lock();
    if engine.is_ending() {
        return Err(HoldError::Ending);
    }
    let now = shared.clock.now();
    engine.hold = match time {
        Some(time) => now.saturating_add(nanos(time).max(1)),
        None => engine.earliest().unwrap_or(now).max(now).saturating_add(1),
    };
    let at = engine.hold;
    engine.restart_pace();
    engine.wake = true;
    shared.release(engine);
    Ok(Time::from_nanos(at))
}

/// Sets the speed of virtual time.
pub(super) fn set_speed(shared: &Shared, speed: Speed) -> Result<(), HoldError> {
    if !shared.clock.is_virtual() {
        return Err(HoldError::RealTime);
    }
    let mut engine = shared.lock();
    if engine.is_ending() {
        return Err(HoldError::Ending);
    }
    engine.pace = match speed {
        Speed::Factor(factor) => Some(Pace { factor: factor.clamp(f64::MIN_POSITIVE, FASTEST), since: None }),
        Speed::Unlimited => None,
    };
    engine.wake = true;
    shared.release(engine);
    Ok(())
}

/// Waits until a virtual time has come at the speed of the run, or another thread wants something; gives the time until
/// then.
#[cold]
pub(super) fn keep_pace<'a>(
    shared: &'a Shared,
    mut engine: std::sync::MutexGuard<'a, Engine>,
    (now, until): (u64, u64),
) -> (std::sync::MutexGuard<'a, Engine>, u64) {
    let Some(pace) = &mut engine.pace else { return (engine, until) };
    let deadline = pace.on_machine(until, (sys::monotonic(), now));
    if sys::monotonic() >= deadline {
        return (engine, until);
    }
    let ticket = shared.timer.ticket();
    engine.roles.asleep_until = until;
    shared.release(engine);
    shared.end.wake();
    shared.timer.wait(ticket, Some(deadline));
    let mut engine = shared.lock();
    engine.roles.asleep_until = 0;
    // Time passes also where nothing is due.
    let passed = engine.pace.as_ref().map_or(now, |pace| pace.at(sys::monotonic()));
    // What came from outside meanwhile is due earlier, and virtual time is never late.
    let due = engine.earliest().unwrap_or(until).min(engine.hold).min(until).max(now);
    (engine, passed.clamp(now, due))
}
