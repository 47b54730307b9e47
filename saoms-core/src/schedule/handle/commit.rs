//! Waiting for what is committed, from outside of the fleet.

use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::schedule::engine::RunPhase;
use crate::schedule::shared::Shared;

/// Error of something that did not come into the state folder: a crash may undo it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotCommitted {
    /// It takes longer: the disk is full or slow, or the fleet has not started.
    NotYet,
    /// It never will.
    Failed(String),
}

impl fmt::Display for NotCommitted {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotCommitted::NotYet => formatter.write_str(
                "it takes effect, but is not in the state folder yet: the disk is full or slow, or the fleet has not \
                 started; a crash before that would undo it",
            ),
            NotCommitted::Failed(text) => {
                write!(formatter, "it takes effect, but is not in the state folder: {text}")
            }
        }
    }
}

impl std::error::Error for NotCommitted {}

const CUT_SHORT: &str = "the run ended while something that belongs together was not complete";

/// Waits until all that has happened is committed.
pub(super) fn wait(shared: &Shared, patience: Duration) -> Result<(), NotCommitted> {
    let Some(queue) = shared.store.get() else { return Ok(()) };
    let until = Instant::now() + patience;
    let mut engine = shared.lock();
    let cut = engine.want_cut(shared.clock.now());
    // The timer makes it.
    shared.release(engine);
    engine = shared.lock();
    let result = loop {
        if let Some(failure) = queue.failure() {
            break Err(NotCommitted::Failed(failure));
        }
        if engine.memory.is_committed(cut) {
            break Ok(());
        }
        if engine.memory.is_cut_short() {
            break Err(NotCommitted::Failed(CUT_SHORT.to_owned()));
        }
        // After the last cut nothing more happens.
        if engine.phase == RunPhase::Ended && !engine.memory.has_uncommitted() {
            break Ok(());
        }
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            break Err(NotCommitted::NotYet);
        }
        engine = shared.wait_for_return(engine, left);
    };
    shared.release(engine);
    result
}

/// A guard from [`Handle::together`](super::Handle::together).
#[must_use = "what happens after it is dropped does not belong together"]
pub struct Together {
    shared: Arc<Shared>,
    /// True if it keeps cuts away.
    guards: bool,
}

impl Together {
    /// True if the run ends, and the memory with it: what happens now is refused, and whoever counts what was taken
    /// does not count it, so that the next program takes it.
    pub fn is_too_late(&self) -> bool {
        !self.guards
    }
}

pub(super) fn together(shared: &Arc<Shared>) -> Together {
    let mut engine = shared.lock();
    let guards = engine.guard_cut();
    shared.release(engine);
    Together { shared: Arc::clone(shared), guards }
}

impl Drop for Together {
    fn drop(&mut self) {
        if self.guards {
            let mut engine = self.shared.lock();
            engine.unguard_cut();
            self.shared.release(engine);
        }
    }
}

impl fmt::Debug for Together {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Together")
    }
}
