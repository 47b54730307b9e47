use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::sys;

/// The time of a run in nanoseconds since its start, from the machine's clock or from a number that jumps.
#[derive(Debug)]
pub(crate) enum Clock {
    /// The machine's monotonic clock: `start` is the zero of the run on it, `zero` the local date of its zero. Until
    /// the start the time is `origin`: zero, or the time from which an earlier program's run goes on. While the run is
    /// paused, `held` is its time; otherwise it is `u64::MAX`.
    Real { start: AtomicU64, held: AtomicU64, origin: AtomicU64, zero: u64 },
    /// From one due execution to the next.
    Virtual { now: AtomicU64 },
}

impl Clock {
    pub(crate) fn real() -> Clock {
        let zero = sys::local_date().saturating_sub(sys::monotonic());
        let never = || AtomicU64::new(u64::MAX);
        Clock::Real { start: never(), held: never(), origin: AtomicU64::new(0), zero }
    }

    pub(crate) fn simulated() -> Clock {
        Clock::Virtual { now: AtomicU64::new(0) }
    }

    pub(crate) fn is_virtual(&self) -> bool {
        matches!(self, Clock::Virtual { .. })
    }

    /// Has the run start at this time, before it starts.
    pub(crate) fn begin_at(&self, time: u64) {
        if let Clock::Real { origin, .. } = self {
            origin.store(time, Ordering::Relaxed);
        }
    }

    /// The time at which the run starts.
    pub(crate) fn origin(&self) -> u64 {
        match self {
            Clock::Real { origin, .. } => origin.load(Ordering::Relaxed),
            Clock::Virtual { .. } => 0,
        }
    }

    /// Starts the run: now is its origin.
    pub(crate) fn start(&self) {
        if let Clock::Real { start, .. } = self {
            start.store(sys::monotonic().wrapping_sub(self.origin()), Ordering::Relaxed);
        }
    }

    #[inline]
    pub(crate) fn now(&self) -> u64 {
        match self {
            Clock::Real { held, .. } => match held.load(Ordering::Acquire) {
                u64::MAX => self.now_without_pause(),
                held => held,
            },
            Clock::Virtual { now } => now.load(Ordering::Relaxed),
        }
    }

    /// The time of the run as if it had not paused: for what goes on meanwhile.
    pub(crate) fn now_without_pause(&self) -> u64 {
        match self {
            Clock::Real { start, .. } => match start.load(Ordering::Relaxed) {
                u64::MAX => self.origin(),
                start => sys::monotonic().wrapping_sub(start),
            },
            Clock::Virtual { now } => now.load(Ordering::Relaxed),
        }
    }

    /// A time of the run on the machine's clock.
    pub(crate) fn on_machine(&self, time: u64) -> u64 {
        match self {
            Clock::Real { start, held, .. } => match held.load(Ordering::Relaxed) {
                u64::MAX => match start.load(Ordering::Relaxed) {
                    u64::MAX => u64::MAX,
                    // The zero of a run that an earlier start of the machine began is before the zero of the clock.
                    start => (start.cast_signed().saturating_add_unsigned(time)).max(0).cast_unsigned(),
                },
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
                start.store(sys::monotonic().wrapping_sub(time), Ordering::Relaxed);
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
