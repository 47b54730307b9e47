//! When a robot that gets nowhere says so. Others wait for that: what every robot refuses is given up in the end.

use saoms_api::{Context, Time};

/// A robot gives a job up that took so many times as long as it takes without others, and without charging.
const TRY: u32 = 50;

/// No job is given up before so many executions.
const LEAST_TRY: u32 = 500;

/// A robot that could work and does not, for so many executions in which there was work, is of no use.
const LONGEST_IDLE: u32 = 1000;

/// For how many executions a robot has been on its job.
#[derive(Debug, Default)]
pub(super) struct Attempt {
    luggage: Option<u32>,
    executions: u32,
}

impl Attempt {
    /// Takes in an execution with this luggage as the job. `longest` is how long it takes without others. The number of executions, once they are
    /// too many.
    pub(super) fn note(&mut self, luggage: Option<u32>, longest: impl FnOnce() -> u32) -> Option<u32> {
        if self.luggage != luggage {
            (self.luggage, self.executions) = (luggage, 0);
        }
        self.luggage?;
        self.executions = self.executions.saturating_add(1);
        // How long it takes costs a search, so it is asked for now and then alone.
        let looks = self.executions.is_multiple_of(LEAST_TRY);
        (looks && self.executions > longest().saturating_mul(TRY)).then_some(self.executions)
    }
}

/// For how many executions a robot did nothing while there was work.
#[derive(Debug, Default)]
pub(super) struct Idle {
    executions: u32,
}

impl Idle {
    /// Takes in an execution.
    pub(super) fn note(&mut self, is_idle: bool) {
        self.executions = if is_idle { self.executions.saturating_add(1) } else { 0 };
    }

    /// Whether work that has been there since then is not going to be done by this robot.
    pub(super) fn is_in_vain(&self, since: Time, context: &Context<'_>) -> bool {
        let longest = context.period().saturating_mul(LONGEST_IDLE);
        self.executions >= LONGEST_IDLE && context.now().since(since) >= longest
    }
}
