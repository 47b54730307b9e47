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

/// One component as the engine keeps it.
pub(super) struct Slot {
    /// What runs; absent while its code runs.
    pub(super) body: Option<Box<Body>>,
    pub(super) state: SlotState,
    /// What the component is made of, as its body has it.
    pub(super) spec: Arc<ComponentSpec>,
    /// Its instance is part of a change that is not committed: it is not executed.
    pub(super) held: bool,
    /// It has been part of the fleet.
    pub(super) joined: bool,
    /// The time of its entry in the queue: an entry with another time does not hold any more.
    pub(super) entry: u64,
    /// When the next execution is due.
    pub(super) due: u64,
    /// When the last execution was due.
    pub(super) last_due: Option<u64>,
    /// When it is unscheduled by itself.
    pub(super) until: u64,
    /// Executions of the present instance.
    pub(super) execution: u64,
    /// What became of requests while its code runs.
    pub(super) wish: Wish,
    /// Its time came while it served a call.
    pub(super) waiting: bool,
    /// It stands in the line for the worker threads.
    pub(super) queued: bool,
    /// Messages were lost in its last period, too.
    pub(super) dropping: bool,
    pub(super) apart: Apart,
    pub(super) policy: TaskPolicy,
    pub(super) vote: Option<Work>,
    pub(super) statistics: Statistics,
    pub(super) journal: Ring,
    /// Why it has to stop, when its own `overrun` says so.
    pub(super) condemned: Option<String>,
    pub(super) name: Arc<str>,
    pub(super) cancelled: Arc<AtomicBool>,
    /// How many instances there have been.
    pub(super) instances: u64,
    pub(super) restarts: u32,
    /// The next instance takes the place of a failed one.
    pub(super) restarting: bool,
}

/// Where a component is in its life.
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
    /// Its code did not return, and nobody waits for it any more.
    Abandoned,
    /// It is not part of the fleet any more, or not yet.
    Removed,
}

/// What was asked for while the component's code was running.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wish {
    /// Nothing.
    None,
    /// To be unscheduled.
    Leave,
    /// To be unscheduled, and scheduled again for so long.
    Return { lasting: u64 },
}

/// Whether a component runs on a worker thread, because it held up the others.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Apart {
    pub(super) now: bool,
    /// Executions within the budget since it runs apart.
    pub(super) well: u32,
    /// How many of them bring it back; doubles each time.
    pub(super) needed: u32,
}

/// The first number of well-behaved executions that bring a component back.
const WELL_BEHAVED: u32 = 100;
const WELL_BEHAVED_AT_MOST: u32 = 1 << 20;

impl Apart {
    /// It held up the others.
    pub(super) fn send_away(&mut self) {
        let needed = if self.needed == 0 { WELL_BEHAVED } else { self.needed.saturating_mul(2) };
        *self = Apart { now: true, well: 0, needed: needed.min(WELL_BEHAVED_AT_MOST) };
    }

    /// It ran apart, within the budget or not.
    pub(super) fn ran(&mut self, slow: bool) {
        self.well = if slow { 0 } else { self.well + 1 };
        self.now = self.well < self.needed;
    }
}

/// What the composite says about running a component, in the engine's terms.
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

/// What the report says about a component.
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
