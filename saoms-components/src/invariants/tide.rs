use std::time::Duration;

use saoms_api::Time;
use saoms_api::event::fault::{FaultCall, FaultKind};

/// Until when faults act on the fleet: what has to happen in a time has that time from then on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tide {
    until: Time,
    /// True if a fault never ends.
    is_endless: bool,
    /// True if events are lost for good: requests need not be finished then.
    loses_events: bool,
    /// True once nothing can happen any more.
    stands_still: bool,
}

impl Tide {
    /// The same for a site, in which nothing has to happen any more if it has stopped.
    pub(super) fn at_site(self, has_stopped: bool) -> Tide {
        Tide { is_endless: self.is_endless || has_stopped, ..self }
    }

    /// Notes a fault of an instant.
    pub(super) fn rise(&mut self, at: Time) {
        self.until = self.until.max(at);
    }

    /// Notes a fault until a time, or without an end.
    pub(super) fn rise_until(&mut self, until: Option<Time>) {
        match until {
            Some(until) => self.rise(until),
            None => self.is_endless = true,
        }
    }

    pub(super) fn begin(&mut self, at: Time, call: &FaultCall) {
        let lasting = match call.kind {
            FaultKind::Fail => Some(Duration::ZERO),
            FaultKind::Crash { restart } => Some(restart.unwrap_or_default()),
            _ => call.lasting,
        };
        self.loses_events |= matches!(call.kind, FaultKind::Violate(_));
        self.rise_until(lasting.map(|time| at + time));
    }

    /// The time for which something has not happened since `since`, without faults; `None` under faults.
    pub(super) fn calm(&self, since: Time, now: Time) -> Option<Duration> {
        let since = since.max(self.until);
        (!self.is_endless && now > since).then(|| now.since(since))
    }

    /// Notes that nothing can happen any more.
    pub(super) fn note_standstill(&mut self) {
        self.stands_still = true;
    }

    /// True if something that has not happened for a time counts as never happening, where it may take so long.
    pub(super) fn is_too_long(&self, time: Duration, bound: Duration) -> bool {
        self.stands_still || time > bound
    }

    /// True if requests need not be finished.
    pub(super) fn spoils_requests(&self) -> bool {
        self.is_endless || self.loses_events
    }
}
