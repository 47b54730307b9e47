use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::commit::Uncommitted;
use super::memory::SlotMemory;
use super::overrun::{self, Decision};
use crate::journal::Ring;
use crate::report::{Label, Lateness};
use crate::schedule::change::Leaving;
use crate::schedule::component::body::Body;
use crate::schedule::component::stored::Stored;
use crate::schedule::networks::NO_NETWORK;
use crate::schedule::settings::nanos;
use crate::schedule::stop::hears_stops;
use crate::status::{ComponentStatus, Description};
use saoms_api::Time;
use saoms_lang::assembly::{ComponentSpec, Loss, Overrun};

/// A time that never comes.
pub(crate) const NEVER: u64 = u64::MAX;

/// State of one component in the engine. What each execution looks at stands first, in a few lines of the processor's
/// cache: with thousands of components each of these lines comes from memory.
#[repr(C, align(64))]
pub(crate) struct Slot {
    /// Body of the component; absent while its code runs.
    pub(crate) body: Option<Box<Body>>,
    /// The time of its entry in the queue: an entry with another time does not hold any more.
    pub(crate) entry: u64,
    /// Due time of the next execution.
    pub(crate) due: u64,
    /// Due time of the next reaction to messages.
    pub(crate) react_due: u64,
    /// Time at which it is unscheduled automatically.
    pub(crate) until: u64,
    /// Executions of the present instance.
    pub(crate) execution: u64,
    /// Time since which its code runs, by the clock that goes on in a pause.
    pub(crate) out_since: u64,
    /// In virtual time, the end of an execution that a fault makes longer.
    pub(crate) busy_until: u64,
    /// Due time of the last execution.
    pub(crate) last_due: Option<u64>,
    /// Request that came while its code ran.
    pub(crate) pending: PendingRequest,
    pub(crate) isolation: Isolation,
    pub(crate) state: SlotState,
    /// True if its instance is part of a change that is not committed: it is not executed.
    pub(crate) held: bool,
    /// True if it became due while it served a call.
    pub(crate) waiting: bool,
    /// True if it is queued for the worker threads.
    pub(crate) queued: bool,
    /// True if it is in its delay: from its start until its first execution.
    pub(crate) in_delay: bool,
    /// True if messages were lost in its last period.
    pub(crate) dropping: bool,
    /// True if its last execution was skipped, because a component that it called was busy.
    pub(crate) skipping: bool,
    /// True from an emergency stop to its release; `emergency` says it to its code.
    stopped: bool,
    /// True if it hears of an emergency stop by a property, and goes on.
    pub(crate) hears_stops: bool,
    /// True if its hardware is stopped once more when its code returns.
    pub(crate) stops_again: bool,
    /// True if it has lost what it kept, since the disk failed: its messages may depend on that, and are not sent.
    pub(crate) is_cut_off: bool,
    /// The number of the network that it is on.
    pub(crate) network: u8,
    pub(crate) policy: TaskPolicy,
    pub(crate) statistics: Statistics,
    /// Executions that kept something which is not committed.
    pub(crate) uncommitted: VecDeque<Uncommitted>,
    pub(crate) journal: Ring,
    /// What outlives the program.
    pub(crate) memory: SlotMemory,
    /// Specification of the component, the same as in its body.
    pub(crate) spec: Arc<ComponentSpec>,
    /// What it knows of its leaving.
    pub(crate) leaving: Leaving,
    /// True if it has ever joined the fleet.
    pub(crate) joined: bool,
    /// Due time of the last reaction.
    pub(crate) last_react: Option<u64>,
    /// Time of the first message that the next reaction is for, and of that of the present one.
    pub(crate) triggered: u64,
    pub(crate) reacts_since: u64,
    /// Time since which code ran that did not return in time, so that its hardware was stopped.
    pub(crate) hangs_since: u64,
    /// True if it sees work left; `None` if it did not vote.
    pub(crate) sees_work: Option<bool>,
    /// True if it said that work was given up.
    pub(crate) gave_up: bool,
    /// What it waits for, as it said last when it was asked.
    pub(crate) waits_for: Option<String>,
    /// True if it was asked for its status and has not answered.
    pub(crate) asked: bool,
    /// True if it was asked on a worker thread what it waits for, and has not answered.
    pub(crate) asked_to_wait: bool,
    /// Its last answer.
    pub(crate) described: Option<Arc<Description>>,
    /// How it is, for the sample that components are asked for: made one by one, so that none waits for all of them.
    pub(crate) sampled: Option<Box<ComponentStatus>>,
    /// True once it was told that it had no answer for a sample.
    pub(crate) is_unsampled: bool,
    /// True if samples need what it says of itself; `None` while it has said nothing.
    pub(crate) is_wanted: Option<bool>,
    /// The time of what that was judged by.
    pub(crate) judged_by: Option<Time>,
    /// Reason of a stop by its own `overrun`.
    pub(crate) overrun_failure: Option<String>,
    pub(crate) name: Arc<str>,
    /// Its names in reports and snapshots.
    pub(crate) label: Label,
    pub(crate) cancelled: Arc<AtomicBool>,
    emergency: Arc<AtomicBool>,
    /// Number of instances so far.
    pub(crate) instances: u64,
    pub(crate) restarts: u32,
    /// True if the next instance replaces a failed one.
    pub(crate) restarting: bool,
}

/// States of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SlotState {
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
pub(crate) enum PendingRequest {
    /// Nothing.
    None,
    /// Unschedule it.
    Leave,
    /// Unschedule it, and schedule it again for this number of nanoseconds.
    Return { lasting: u64 },
}

/// State of a component that runs on a worker thread, because it held up the others.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Isolation {
    pub(crate) active: bool,
    /// True if its class, or that of a component that it calls, never runs on the timer.
    pub(crate) always: bool,
    /// Executions within the budget since it runs on a worker thread.
    pub(crate) within_budget: u32,
    /// Number of such executions that bring it back to the timer; doubles each time.
    pub(crate) required: u32,
}

/// Initial number of executions within the budget that bring a component back to the timer.
const EXECUTIONS_TO_RETURN: u32 = 100;
const MAX_EXECUTIONS_TO_RETURN: u32 = 1 << 20;

impl Isolation {
    /// Moves it to a worker thread, because it held up the others.
    pub(crate) fn isolate(&mut self) {
        let required = if self.required == 0 { EXECUTIONS_TO_RETURN } else { self.required.saturating_mul(2) };
        *self = Isolation {
            active: true,
            within_budget: 0,
            always: self.always,
            required: required.min(MAX_EXECUTIONS_TO_RETURN),
        };
    }

    /// Counts an execution on a worker thread, within the budget or not.
    pub(crate) fn count_execution(&mut self, slow: bool) {
        self.within_budget = if slow { 0 } else { self.within_budget + 1 };
        self.active = self.always || self.within_budget < self.required;
    }
}

/// Task settings of the composite in the engine's units.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct TaskPolicy {
    pub(crate) period: u64,
    pub(crate) periodic: bool,
    pub(crate) on_startup: bool,
    pub(crate) interrupt: bool,
    pub(crate) delay: u64,
    /// Least time from one reaction to the next.
    pub(crate) minimum: u64,
    pub(crate) deadline: u64,
    pub(crate) overrun: Overrun,
    pub(crate) restarts: u32,
    pub(crate) backoff: Duration,
    pub(crate) loss: Loss,
}

impl TaskPolicy {
    pub(crate) fn of(spec: &ComponentSpec) -> TaskPolicy {
        match &spec.task {
            Some(task) => TaskPolicy {
                periodic: true,
                on_startup: task.run_on_startup,
                interrupt: task.may_interrupt_if_running,
                period: nanos(task.period).max(1),
                delay: nanos(task.delay),
                minimum: nanos(task.minimum).max(1),
                deadline: task.deadline.map_or(NEVER, nanos),
                overrun: task.overrun,
                restarts: task.restarts(),
                backoff: task.restart_backoff,
                loss: task.loss,
            },
            None => TaskPolicy {
                periodic: false,
                on_startup: true,
                interrupt: true,
                period: 0,
                delay: 0,
                minimum: 1,
                deadline: NEVER,
                overrun: Overrun::Skip,
                restarts: 0,
                backoff: Duration::ZERO,
                loss: Loss::Fail,
            },
        }
    }
}

/// Statistics of a component for the report.
#[derive(Debug, Default)]
#[repr(C)]
pub(crate) struct Statistics {
    pub(crate) executions: u64,
    pub(crate) missed: u64,
    pub(crate) received: u64,
    pub(crate) sent: u64,
    pub(crate) reactions: u64,
    pub(crate) deadline_misses: u64,
    pub(crate) slow: u64,
    pub(crate) busy: u64,
    pub(crate) failures: u64,
    pub(crate) replaced: u32,
    pub(crate) dropped: u64,
    /// Messages of the component that a state topic could not keep.
    pub(crate) unkept: u64,
    pub(crate) late: Lateness,
}

impl Slot {
    pub(crate) fn new(index: u32, spec: Arc<ComponentSpec>, stored: Stored) -> Slot {
        let name: Arc<str> = Arc::from(spec.path.as_str());
        let policy = TaskPolicy::of(&spec);
        let mut slot = Slot {
            body: None,
            stopped: false,
            emergency: Arc::default(),
            hears_stops: hears_stops(&spec),
            label: Label::of(&spec),
            stops_again: false,
            spec,
            held: true,
            joined: false,
            leaving: Leaving::Not,
            state: SlotState::Idle,
            entry: NEVER,
            due: NEVER,
            react_due: NEVER,
            last_react: None,
            triggered: NEVER,
            reacts_since: NEVER,
            last_due: None,
            until: NEVER,
            execution: 0,
            pending: PendingRequest::None,
            waiting: false,
            queued: false,
            in_delay: false,
            dropping: false,
            skipping: false,
            out_since: NEVER,
            hangs_since: NEVER,
            busy_until: 0,
            isolation: Isolation::default(),
            policy,
            sees_work: None,
            gave_up: false,
            waits_for: None,
            asked: false,
            asked_to_wait: false,
            described: None,
            sampled: None,
            is_unsampled: false,
            is_wanted: None,
            judged_by: None,
            statistics: Statistics::default(),
            uncommitted: VecDeque::new(),
            is_cut_off: false,
            network: NO_NETWORK,
            journal: Ring::default(),
            memory: SlotMemory::default(),
            overrun_failure: None,
            name,
            cancelled: Arc::default(),
            instances: 0,
            restarts: 0,
            restarting: false,
        };
        slot.body = Some(slot.empty_body(index, stored));
        slot
    }

    /// A body without an instance.
    pub(crate) fn empty_body(&self, index: u32, stored: Stored) -> Box<Body> {
        let (spec, name, cancelled) = (Arc::clone(&self.spec), Arc::clone(&self.name), Arc::clone(&self.cancelled));
        let mut body = Body::new(index, spec, name, self.policy.period, cancelled);
        body.part.emergency = Arc::clone(&self.emergency);
        body.part.stored = stored;
        Box::new(body)
    }

    /// The end of its delay, while it is in that. An execution that is not over counts as not begun.
    pub(crate) fn delayed_until(&self) -> Option<u64> {
        match self.execution {
            _ if !self.in_delay || self.state != SlotState::Active => None,
            0 => Some(self.due),
            _ => self.last_due.filter(|_| self.body.is_none()),
        }
    }

    /// Time of its next job, while it is active.
    #[inline]
    pub(crate) fn next_time(&self) -> u64 {
        self.due.min(self.until).min(self.react_due)
    }

    /// The decision about its execution that is due.
    #[inline]
    pub(crate) fn decide(&self, now: u64, limit: u64) -> Decision {
        overrun::decide(self.policy.overrun, self.due, now, self.policy.period, limit)
    }

    /// True from an emergency stop to its release.
    #[inline]
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// Begins or ends an emergency stop.
    pub(crate) fn set_stopped(&mut self, is_stopped: bool) {
        self.stopped = is_stopped;
        self.emergency.store(is_stopped, Ordering::Relaxed);
    }

    /// True if its executions are left out, since it is stopped and does not hear of it.
    #[inline]
    pub(crate) fn is_suspended(&self) -> bool {
        !self.hears_stops && self.is_stopped()
    }

    /// True if it is part of the fleet, or is about to be.
    pub(crate) fn is_member(&self) -> bool {
        self.state != SlotState::Removed
    }

    /// True if it is scheduled, or about to be.
    pub(crate) fn is_scheduled(&self) -> bool {
        match self.state {
            SlotState::Starting | SlotState::Active => self.pending != PendingRequest::Leave,
            SlotState::Leaving => matches!(self.pending, PendingRequest::Return { .. }),
            SlotState::Idle | SlotState::Failed | SlotState::Abandoned | SlotState::Removed => false,
        }
    }

    /// True if it is to shut down, for somebody wants that, and has not.
    pub(crate) fn has_to_leave(&self) -> bool {
        match self.state {
            SlotState::Starting | SlotState::Active | SlotState::Abandoned => self.pending == PendingRequest::Leave,
            SlotState::Leaving => self.overrun_failure.is_none() && !self.is_scheduled(),
            SlotState::Idle | SlotState::Failed | SlotState::Removed => false,
        }
    }

    /// True if its instance is initialized and not shut down.
    pub(crate) fn is_alive(&self) -> bool {
        matches!(self.state, SlotState::Active | SlotState::Leaving)
    }

    /// True if it carries out orders, and serves calls of other programs.
    pub(crate) fn carries_out(&self) -> bool {
        self.state == SlotState::Active
    }
}
