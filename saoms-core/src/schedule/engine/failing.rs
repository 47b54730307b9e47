//! Failures of components: told before the instance is dropped, whose destructor may hang, and handled afterwards by
//! the policy of the component.

use std::time::Duration;

use saoms_api::Failure;

use super::ending::EndCause;
use super::lifecycle::Request;
use super::slot::{NEVER, PendingRequest, SlotState};
use super::trace::TraceStep;
use super::{Engine, RunPhase};
use crate::observe::Occurrence;
use crate::schedule::component::body::{Body, Job};
use crate::schedule::component::library::with_library;
use crate::schedule::component::part::Part;
use crate::schedule::settings::nanos;

/// What was told of a failure.
#[derive(Debug)]
pub(crate) struct Told {
    /// For the reasons of the run.
    reason: String,
    /// The time until the restart, if there is one.
    restart: Option<Duration>,
}

impl Engine {
    /// Tells the failure of a component whose code has just returned, unless the job is tried again or belongs to a
    /// change. The component has still to [fail](Engine::fail).
    pub(crate) fn tell_early(&mut self, part: &mut Part, job: Job, failure: &Failure, now: u64) {
        let is_member = !self.is_abandoned(part.index) && !self.is_left_behind(part);
        if !part.held && is_member && !self.tries_again(part.index, job, failure, part) {
            part.told = Some(self.tell(part, job, failure, now));
        }
    }

    fn tell(&mut self, part: &mut Part, job: Job, failure: &Failure, now: u64) -> Told {
        let index = part.index;
        let message = self.failed(part, job, failure, now);
        self.stop_its_hardware(index);
        let slot = &mut self.slots[index as usize];
        let longer = 1_u32.checked_shl(slot.restarts).unwrap_or(u32::MAX);
        let restart = (slot.restarts < slot.policy.restarts).then(|| slot.policy.backoff.saturating_mul(longer));
        // One that was made to crash starts again as that says, and is no failure of the run.
        let crash = part.crash.take();
        let restart = crash.unwrap_or(restart).filter(|_| self.stays(index, job));
        let slot = &mut self.slots[index as usize];
        let reason = format!("component `{}` failed: {message}", slot.name);
        if restart.is_none() && crash.is_none() {
            self.reasons.extend(slot.overrun_failure.take());
            self.reasons.push(reason.clone());
        }
        self.emit(now, index, Occurrence::Failed { message, restart });
        Told { reason, restart }
    }

    /// Counts a failure, and gives its message.
    fn failed(&mut self, part: &mut Part, job: Job, failure: &Failure, now: u64) -> String {
        // The journal keeps its records of the time before the failure.
        self.record(part, now);
        let unsent = part.outbox.len();
        part.outbox.clear();
        part.to_keep.clear();
        part.effects.forget_new();
        let uncommitted = self.take_back_uncommitted(part);
        part.sent_bytes = 0;
        part.vote = None;
        let doing = match job {
            Job::Start => "could not start: ",
            Job::Execute | Job::React | Job::Ask | Job::Describe | Job::Sample | Job::Order | Job::Save => "",
            Job::Shutdown => "could not shut down: ",
        };
        let spec = part.blamed.take().map_or(&part.spec, |other| &self.slots[other as usize].spec);
        let mut message = format!("{doing}{}", with_library(spec, failure));
        if unsent > 0 {
            message.push_str(&format!(" (messages of this execution that are not sent: {unsent})"));
        }
        if uncommitted > 0 {
            message.push_str(&format!(" (messages that waited for what it kept, and are not sent: {uncommitted})"));
        }
        self.step(now, part.index, TraceStep::Failed);
        self.slots[part.index as usize].statistics.failures += 1;
        message
    }

    /// True if a component that fails in this job stays in the fleet, so that it may be restarted.
    fn stays(&self, index: u32, job: Job) -> bool {
        let pending = self.slots[index as usize].pending;
        self.phase == RunPhase::Running && job != Job::Shutdown && pending == PendingRequest::None
    }

    /// Handles the failure of a component in any job, by its policy.
    pub(crate) fn fail(&mut self, index: u32, body: &mut Body, job: Job, failure: &Failure, now: u64) {
        let slot = &mut self.slots[index as usize];
        slot.react_due = NEVER;
        slot.waiting = false;
        if body.part.held {
            // The change it belongs to is undone.
            let message = self.failed(&mut body.part, job, failure, now);
            let slot = &mut self.slots[index as usize];
            slot.state = SlotState::Failed;
            let reason = format!("component `{}` failed: {message}", slot.name);
            self.held_failure = Some((index, Failure::new(reason)));
            self.emit(now, index, Occurrence::Failed { message, restart: None });
            return;
        }
        let told = body.part.told.take();
        let Told { reason, restart } = told.unwrap_or_else(|| self.tell(&mut body.part, job, failure, now));
        // Meanwhile, the end of the run may have begun.
        let pause = restart.filter(|_| self.stays(index, job));
        let goes_on = pause.is_some() && body.part.lasting.will_go_on();
        if pause.is_some() {
            body.keep_unread(&mut self.bus);
        } else {
            body.part.lasting.forget();
        }
        self.keep_subscriptions(body);
        self.note_saved(&body.part, false, now);
        self.note_inbox(index);
        self.note_differs(index, now);
        let slot = &mut self.slots[index as usize];
        let pending = std::mem::replace(&mut slot.pending, PendingRequest::None);
        match pause {
            Some(pause) => {
                slot.restarts += 1;
                slot.restarting = true;
                slot.state = SlotState::Starting;
                slot.leaving.begins_again();
                self.enqueue(index, now.saturating_add(nanos(pause)));
                if !goes_on {
                    self.tell_outage(index, true, now);
                }
            }
            None => {
                slot.state = SlotState::Failed;
                slot.restarting = false;
                if restart.is_some() {
                    self.reasons.extend(slot.overrun_failure.take());
                    self.reasons.push(reason);
                }
                self.release(index, body, now);
                self.tell_outage(index, false, now);
                self.lost(index, now);
                if let PendingRequest::Return { lasting } = pending {
                    self.request(index, Request::Schedule { lasting }, now);
                }
            }
        }
    }

    /// Ends the run if a component that was lost for good leaves it without purpose.
    pub(super) fn lost(&mut self, index: u32, now: u64) {
        if self.phase != RunPhase::Running {
            return;
        }
        let voted = self.slots[index as usize].sees_work.is_some();
        self.forget_vote(index, now);
        if voted && self.votes.voters == 0 {
            let name = &self.slots[index as usize].name;
            self.reasons.push(format!("component `{name}` ended before it reported that its work is done"));
            self.begin_stop(EndCause::Lost, now);
        } else if !self.slots.iter().any(|slot| slot.policy.periodic && slot.is_scheduled()) {
            self.begin_stop(EndCause::Lost, now);
        }
    }
}
