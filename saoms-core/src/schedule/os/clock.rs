use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::sys;

/// The time of a run in nanoseconds since its start, from the machine's clock or from a number that jumps.
#[derive(Debug)]
pub(crate) enum Clock {
    /// The machine's monotonic clock: `start` is the start of the run on it, `zero` the local date of its zero. Until
    /// the start the time is zero. While the run is paused, `held` is its time; otherwise it is `u64::MAX`.
    Real { start: AtomicU64, held: AtomicU64, zero: u64 },
    /// From one due execution to the next.
    Virtual { now: AtomicU64 },
}

impl Clock {
    pub(crate) fn real() -> Clock {
        let zero = sys::local_date().saturating_sub(sys::monotonic());
        Clock::Real { start: AtomicU64::new(u64::MAX), held: AtomicU64::new(u64::MAX), zero }
    }

    pub(crate) fn simulated() -> Clock {
        Clock::Virtual { now: AtomicU64::new(0) }
    }

    pub(crate) fn is_virtual(&self) -> bool {
        matches!(self, Clock::Virtual { .. })
    }

    /// Starts the run: now is zero.
    pub(crate) fn start(&self) {
        if let Clock::Real { start, .. } = self {
            start.store(sys::monotonic(), Ordering::Relaxed);
        }
    }

    #[inline]
    pub(crate) fn now(&self) -> u64 {
        match self {
            Clock::Real { start, held, .. } => match held.load(Ordering::Acquire) {
                u64::MAX => sys::monotonic().saturating_sub(start.load(Ordering::Relaxed)),
                held => held,
            },
            Clock::Virtual { now } => now.load(Ordering::Relaxed),
        }
    }

    /// The time of the run as if it had not paused: for what goes on meanwhile.
    pub(crate) fn now_without_pause(&self) -> u64 {
        match self {
            Clock::Real { start, .. } => sys::monotonic().saturating_sub(start.load(Ordering::Relaxed)),
            Clock::Virtual { .. } => self.now(),
        }
    }

    /// A time of the run on the machine's clock.
    pub(crate) fn on_machine(&self, time: u64) -> u64 {
        match self {
            Clock::Real { start, held, .. } => match held.load(Ordering::Relaxed) {
                u64::MAX => start.load(Ordering::Relaxed).saturating_add(time),
                held => sys::monotonic().saturating_add(time).saturating_sub(held),
            },
            Clock::Virtual { .. } => time,
        }
    }

    /// Lets the time of the run stand still, in real time. Only the holder of the engine's lock may call it.
    pub(crate) fn hold(&self) {
        if let Clock::Real { held, .. } = self {
            held.store(self.now(), Ordering::Relaxed);
        }
    }

    /// Lets the time of the run go on from where it stands. Only the holder of the engine's lock may call it.
    pub(crate) fn go_on(&self) {
        let Clock::Real { start, held, .. } = self else { return };
        let time = held.load(Ordering::Relaxed);
        if time != u64::MAX {
            // Before the start there is nothing to move.
            if start.load(Ordering::Relaxed) != u64::MAX {
                start.store(sys::monotonic().saturating_sub(time), Ordering::Relaxed);
            }
            // Whoever sees that it goes on has to see from where.
            held.store(u64::MAX, Ordering::Release);
        }
    }

    /// The local date and time of day since 1970-01-01 00:00. It does not follow changes of the machine's date during
    /// the run, so that it never jumps.
    pub(crate) fn date(&self) -> Option<Duration> {
        match self {
            Clock::Real { zero, .. } => Some(Duration::from_nanos(zero.saturating_add(sys::monotonic()))),
            Clock::Virtual { .. } => None,
        }
    }

    /// Lets virtual time jump.
    pub(crate) fn jump(&self, time: u64) {
        if let Clock::Virtual { now } = self {
            now.store(time, Ordering::Relaxed);
        }
    }
}
