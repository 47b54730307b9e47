use std::sync::atomic::{AtomicU64, Ordering};

/// Heartbeat of the thread with the timer's work: its present state, written without locks and system calls, for the
/// watching thread.
#[derive(Debug)]
pub(crate) struct Pulse {
    /// Counts the pieces of component code begun; a watcher that sees the same number twice sees the same piece.
    begun: AtomicU64,
    /// Start of the present piece, on the machine's clock; 0 is none.
    since: AtomicU64,
    /// Time at which the timer woke or has to wake, on the machine's clock.
    next: AtomicU64,
    /// Time until which the watcher sleeps, on the machine's clock.
    watch: AtomicU64,
}

/// State of the timer at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Present {
    /// The number of the piece of component code that runs, or was the last to run.
    pub(crate) piece: u64,
    /// Start of the piece, if it runs.
    pub(crate) since: Option<u64>,
    /// Time at which the timer woke or has to wake.
    pub(crate) next: u64,
}

impl Default for Pulse {
    fn default() -> Pulse {
        Pulse {
            begun: AtomicU64::new(0),
            since: AtomicU64::new(0),
            next: AtomicU64::new(u64::MAX),
            watch: AtomicU64::new(u64::MAX),
        }
    }
}

impl Pulse {
    /// Component code begins.
    #[inline]
    pub(crate) fn begin(&self, now: u64) {
        // Only the thread with the timer's work writes, so that no read-modify-write is needed.
        self.begun.store(self.begun.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        self.since.store(now.max(1), Ordering::Release);
    }

    /// Component code has ended.
    #[inline]
    pub(crate) fn end(&self) {
        self.since.store(0, Ordering::Release);
    }

    /// The timer is about to sleep, or has just woken and is awake from now on.
    pub(crate) fn awake_at(&self, time: u64) {
        self.next.store(time, Ordering::Release);
    }

    /// The present state of the timer.
    pub(crate) fn present(&self) -> Present {
        let since = self.since.load(Ordering::Acquire);
        Present {
            piece: self.begun.load(Ordering::Acquire),
            since: (since != 0).then_some(since),
            next: self.next.load(Ordering::Acquire),
        }
    }

    pub(crate) fn begun(&self) -> u64 {
        self.begun.load(Ordering::Acquire)
    }

    /// The watcher is about to sleep.
    pub(crate) fn watch_from(&self, until: u64) {
        self.watch.store(until, Ordering::SeqCst);
    }

    /// True if the watcher would wake too late for a piece that begins now, so that it has to be woken.
    #[inline]
    pub(crate) fn unwatched(&self, now: u64, budget: u64) -> bool {
        now.saturating_add(budget) < self.watch.load(Ordering::Relaxed)
    }
}
