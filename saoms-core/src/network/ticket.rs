//! The outcome of a call of another program, on its way to who waits for it.

use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

use super::exchange::call::Outcome;

/// Where the outcome of a call goes.
#[derive(Debug, Default)]
pub(crate) struct Ticket {
    outcome: Mutex<Option<Outcome>>,
    filled: Condvar,
}

impl Ticket {
    /// Gives the outcome.
    pub(super) fn fill(&self, outcome: Outcome) {
        *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
        self.filled.notify_all();
    }

    /// The outcome, if it is there.
    pub(crate) fn take(&self) -> Option<Outcome> {
        self.outcome.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// The outcome, once it is there, within this time.
    pub(crate) fn wait(&self, time: Duration) -> Option<Outcome> {
        let outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.filled.wait_timeout_while(outcome, time, |outcome| outcome.is_none());
        waited.unwrap_or_else(PoisonError::into_inner).0.take()
    }
}
