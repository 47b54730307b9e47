use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use saoms_api::Work;

use super::body::Body;
use super::overrun::{self, Decision};
use super::settings::nanos;
use crate::journal::Ring;
use crate::report::Lateness;
use saoms_lang::assembly::{ComponentSpec, Loss, Overrun, Restart};

/// A time that never comes.
pub(super) const NEVER: u64 = u64::MAX;

/// State of one component in the engine.
pub(super) struct Slot {
    /// Body of the component; absent while its code runs.
    pub(super) body: Option<Box<Body>>,
    pub(super) state: SlotState,
    /// Specification of the component, the same as in its body.
    pub(super) spec: Arc<ComponentSpec>,
    /// True if its instance is part of a change that is not committed: it is not executed.
    pub(super) held: bool,
    /// True if it has ever joined the fleet.
    pub(super) joined: bool,
    /// The time of its entry in the queue: an entry with another time does not hold any more.
    pub(super) entry: u64,
    /// Due time of the next execution.
    pub(super) due: u64,
    /// Due time of the last execution.
    pub(super) last_due: Option<u64>,
    /// Time at which it is unscheduled automatically.
    pub(super) until: u64,
    /// Executions of the present instance.
    pub(super) execution: u64,
    /// Request that came while its code ran.
    pub(super) wish: Wish,
    /// True if it became due while it served a call.
    pub(super) waiting: bool,
    /// True if it is queued for the worker threads.
    pub(super) queued: bool,
    /// True if messages were lost in its last period.
    pub(super) dropping: bool,
    pub(super) apart: Apart,
    pub(super) policy: TaskPolicy,
    pub(super) vote: Option<Work>,
    pub(super) statistics: Statistics,
    pub(super) journal: Ring,
    /// Reason of a stop by its own `overrun`.
    pub(super) condemned: Option<String>,
    pub(super) name: Arc<str>,
    pub(super) cancelled: Arc<AtomicBool>,
    /// Number of instances so far.
    pub(super) instances: u64,
    pub(super) restarts: u32,
    /// True if the next instance replaces a failed one.
    pub(super) restarting: bool,
}

/// States of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SlotState {
    /// It does not take part: not scheduled yet, or unscheduled.
    Idle,
    /// It will be constructed and initialized when its entry in the queue is due.
    Starting,
    /// It takes part.
    Active,
    /// It will be shut down.
    Leaving,
    /// It has failed for good.
    Failed,
    /// Its code did not return in time, and it was given up.
    Abandoned,
    /// It is not part of the fleet any more, or not yet.
    Removed,
}

/// Request that came while the component's code was running.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wish {
    /// Nothing.
    None,
    /// Unschedule it.
    Leave,
    /// Unschedule it, and schedule it again for this number of nanoseconds.
    Return { lasting: u64 },
}

/// State of a component that runs on a worker thread, because it held up the others.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Apart {
    pub(super) now: bool,
    /// Executions within the budget since it runs on a worker thread.
    pub(super) well: u32,
    /// Number of such executions that bring it back to the timer; doubles each time.
    pub(super) needed: u32,
}

/// Initial number of executions within the budget that bring a component back to the timer.
const WELL_BEHAVED: u32 = 100;
const WELL_BEHAVED_AT_MOST: u32 = 1 << 20;

impl Apart {
    /// Moves it to a worker thread, because it held up the others.
    pub(super) fn send_away(&mut self) {
        let needed = if self.needed == 0 { WELL_BEHAVED } else { self.needed.saturating_mul(2) };
        *self = Apart { now: true, well: 0, needed: needed.min(WELL_BEHAVED_AT_MOST) };
    }

    /// Counts an execution on a worker thread, within the budget or not.
    pub(super) fn ran(&mut self, slow: bool) {
        self.well = if slow { 0 } else { self.well + 1 };
        self.now = self.well < self.needed;
    }
}

/// Task settings of the composite in the engine's units.
#[derive(Clone, Copy, Debug)]
pub(super) struct TaskPolicy {
    pub(super) periodic: bool,
    pub(super) on_startup: bool,
    pub(super) interrupt: bool,
    pub(super) period: u64,
    pub(super) delay: u64,
    pub(super) deadline: u64,
    pub(super) overrun: Overrun,
    pub(super) restart: Restart,
    pub(super) loss: Loss,
}

impl TaskPolicy {
    pub(super) fn of(spec: &ComponentSpec) -> TaskPolicy {
        match &spec.task {
            Some(task) => TaskPolicy {
                periodic: true,
                on_startup: task.run_on_startup,
                interrupt: task.may_interrupt_if_running,
                period: nanos(task.period).max(1),
                delay: nanos(task.delay),
                deadline: task.deadline.map_or(NEVER, nanos),
                overrun: task.overrun,
                restart: task.restart,
                loss: task.loss,
            },
            None => TaskPolicy {
                periodic: false,
                on_startup: true,
                interrupt: true,
                period: 0,
                delay: 0,
                deadline: NEVER,
                overrun: Overrun::Skip,
                restart: Restart::Never,
                loss: Loss::Fail,
            },
        }
    }
}

/// Statistics of a component for the report.
#[derive(Debug, Default)]
pub(super) struct Statistics {
    pub(super) executions: u64,
    pub(super) missed: u64,
    pub(super) deadline_misses: u64,
    pub(super) slow: u64,
    pub(super) failures: u64,
    pub(super) replaced: u32,
    pub(super) dropped: u64,
    pub(super) sent: u64,
    pub(super) received: u64,
    pub(super) late: Lateness,
}

impl Slot {
    pub(super) fn new(index: u32, spec: Arc<ComponentSpec>) -> Slot {
        let name: Arc<str> = Arc::from(spec.path.as_str());
        let policy = TaskPolicy::of(&spec);
        let cancelled = Arc::new(AtomicBool::new(false));
        let body =
            Body::new(index, Arc::clone(&spec), Arc::clone(&name), policy.period, Arc::clone(&cancelled));
        Slot {
            body: Some(Box::new(body)),
            spec,
            held: true,
            joined: false,
            state: SlotState::Idle,
            entry: NEVER,
            due: NEVER,
            last_due: None,
            until: NEVER,
            execution: 0,
            wish: Wish::None,
            waiting: false,
            queued: false,
            dropping: false,
            apart: Apart::default(),
            policy,
            vote: None,
            statistics: Statistics::default(),
            journal: Ring::default(),
            condemned: None,
            name,
            cancelled,
            instances: 0,
            restarts: 0,
            restarting: false,
        }
    }

    /// The decision about its execution that is due.
    #[inline]
    pub(super) fn decide(&self, now: u64, limit: u64) -> Decision {
        overrun::decide(self.policy.overrun, self.due, now, self.policy.period, limit)
    }

    /// True if it is part of the fleet, or is about to be.
    pub(super) fn is_member(&self) -> bool {
        self.state != SlotState::Removed
    }

    /// True if it is scheduled, or about to be.
    pub(super) fn is_scheduled(&self) -> bool {
        match self.state {
            SlotState::Starting | SlotState::Active => self.wish != Wish::Leave,
            SlotState::Leaving => matches!(self.wish, Wish::Return { .. }),
            SlotState::Idle | SlotState::Failed | SlotState::Abandoned | SlotState::Removed => false,
        }
    }

    /// True if its instance is initialized and not shut down.
    pub(super) fn is_alive(&self) -> bool {
        matches!(self.state, SlotState::Active | SlotState::Leaving)
    }
}
