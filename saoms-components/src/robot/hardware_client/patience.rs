//! Reports of a robot whose hardware does not answer: once when that lasts, and once when it ends.

use std::time::Duration;

use saoms_api::{Context, Time};

/// Time without an answer after which a robot reports that.
const LONG: Duration = Duration::from_secs(60);

/// The wait of a robot for the end of an action, or for hardware that is busy.
#[derive(Debug, Default)]
pub(super) struct Patience {
    since: Option<Time>,
    is_told: bool,
    /// The longest wait so far that ended: actions of slow hardware take long, which is no fault.
    longest: Duration,
}

impl Patience {
    /// True if the last call is not over.
    pub(super) fn waits(&self) -> bool {
        self.since.is_some()
    }

    /// Looks at a call: whether nothing is left to wait for, and the name of the component where that was busy.
    pub(super) fn note(&mut self, is_over: bool, busy: Option<&str>, context: &mut Context<'_>) {
        let now = context.now();
        if is_over {
            let Some(since) = self.since.take() else { return };
            let waited = now.since(since);
            self.longest = self.longest.max(waited);
            if std::mem::take(&mut self.is_told) {
                let waited = Time::from_nanos(now.as_nanos() - since.as_nanos());
                context.info(format_args!("continues after waiting {waited}"));
            }
            return;
        }
        let since = *self.since.get_or_insert(now);
        if self.is_told || now.since(since) < LONG.max(self.longest.saturating_mul(2)) {
            return;
        }
        self.is_told = true;
        match busy {
            Some(name) => context.warn(format_args!("has been waiting for `{name}`, which is busy, since {since}")),
            None => context.warn(format_args!(
                "has been waiting since {since} for its world, which has not reported the end of the action"
            )),
        }
    }
}
