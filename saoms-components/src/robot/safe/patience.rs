//! Limits after which a robot without progress gives up. Other robots wait for that: a request that every robot refuses
//! is given up in the end.

use saoms_api::{Context, Field, Time};

/// Maximum duration of a job, as a multiple of its duration without other robots and without charging.
const TRY: u32 = 50;

/// Minimum number of executions before a job is given up.
const LEAST_TRY: u32 = 500;

/// Maximum time for which a robot may be idle while there is work for it, in moves of a block.
const LONGEST_IDLE: u32 = 1000;

/// Number of executions that a robot has been on its job, and has not charged.
#[derive(Debug, Default, Clone, Field)]
pub(super) struct Attempt {
    luggage: Option<u32>,
    executions: u32,
}

impl Attempt {
    /// Counts an execution with this luggage as the job. `longest` is the duration of the job without other robots.
    /// Returns the number of executions once it is too large.
    pub(super) fn note(&mut self, luggage: Option<u32>, longest: impl FnOnce() -> u32) -> Option<u32> {
        if self.luggage != luggage {
            (self.luggage, self.executions) = (luggage, 0);
        }
        self.luggage?;
        self.executions = self.executions.saturating_add(1);
        // `longest` needs a search, so it is called only now and then.
        let looks = self.executions.is_multiple_of(LEAST_TRY);
        (looks && self.executions > longest().saturating_mul(TRY)).then_some(self.executions)
    }
}

/// Number of executions for which a robot was idle while there was work.
#[derive(Debug, Default, Clone, Field)]
pub(super) struct Idle {
    executions: u32,
}

impl Idle {
    /// Counts an execution.
    pub(super) fn note(&mut self, is_idle: bool) {
        self.executions = if is_idle { self.executions.saturating_add(1) } else { 0 };
    }

    /// True if this robot, a move of which takes `moving` executions, is not going to do work that has waited since
    /// `since`.
    pub(super) fn is_in_vain(&self, since: Time, moving: u32, context: &Context<'_>) -> bool {
        let longest = LONGEST_IDLE.saturating_mul(moving);
        self.executions >= longest && context.now().since(since) >= context.period().saturating_mul(longest)
    }
}
