use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::sys;

/// The time of a run in nanoseconds since its start, from the machine's clock or from a number that jumps.
#[derive(Debug)]
pub(crate) enum Clock {
    /// The machine's monotonic clock: `start` is the start of the run on it, `zero` the local date of its zero. Until
    /// the start the time is zero.
    Real { start: AtomicU64, zero: u64 },
    /// From one due execution to the next.
    Virtual { now: AtomicU64 },
}

impl Clock {
    pub(crate) fn real() -> Clock {
        let zero = sys::local_date().saturating_sub(sys::monotonic());
        Clock::Real { start: AtomicU64::new(u64::MAX), zero }
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
            Clock::Real { start, .. } => sys::monotonic().saturating_sub(start.load(Ordering::Relaxed)),
            Clock::Virtual { now } => now.load(Ordering::Relaxed),
        }
    }

    /// A time of the run on the machine's clock.
    pub(crate) fn on_machine(&self, time: u64) -> u64 {
        match self {
            Clock::Real { start, .. } => start.load(Ordering::Relaxed).saturating_add(time),
            Clock::Virtual { .. } => time,
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
