use std::sync::atomic::Ordering;

use super::slot::{NEVER, PendingRequest, SlotState};
use super::trace::TraceStep;
use super::{Engine, RunPhase};
use crate::observe::Occurrence;
use crate::schedule::component::body::Body;

/// Requests about a periodic component, at any time and from any thread. They take effect after the code that runs at
/// present.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Request {
    /// Schedule it for this number of nanoseconds.
    Schedule { lasting: u64 },
    /// Unschedule it.
    Unschedule,
}

impl Engine {
    /// Notes a request.
    pub(crate) fn request(&mut self, index: u32, request: Request, now: u64) {
        let running = matches!(self.phase, RunPhase::Starting | RunPhase::Running);
        if !running || !self.slots[index as usize].policy.periodic {
            return;
        }
        self.note_differs(index, now);
        match request {
            Request::Schedule { lasting } => self.schedule(index, lasting, now),
            Request::Unschedule => self.unschedule(index, now),
        }
    }

    fn schedule(&mut self, index: u32, lasting: u64, now: u64) {
        let until = now.saturating_add(lasting);
        let slot = &mut self.slots[index as usize];
        match (slot.state, slot.pending) {
            (SlotState::Idle | SlotState::Failed, _) => {
                slot.state = SlotState::Starting;
                slot.until = until;
                self.enqueue(index, now);
            }
            (SlotState::Leaving, _) | (_, PendingRequest::Leave | PendingRequest::Return { .. }) => {
                slot.pending = PendingRequest::Return { lasting }
            }
            (SlotState::Starting, PendingRequest::None) => slot.until = until,
            (SlotState::Active, PendingRequest::None) => {
                // A running component continues; only its end may change.
                slot.until = until;
                if slot.entry != NEVER {
                    let when = slot.next_time().max(now).max(slot.busy_until);
                    self.enqueue(index, when);
                }
            }
            (SlotState::Abandoned | SlotState::Removed, _) => {}
        }
    }

    fn unschedule(&mut self, index: u32, now: u64) {
        let slot = &mut self.slots[index as usize];
        match slot.state {
            SlotState::Idle | SlotState::Failed | SlotState::Abandoned | SlotState::Removed => {}
            SlotState::Leaving => slot.pending = PendingRequest::None,
            SlotState::Starting if slot.body.is_some() => {
                slot.state = SlotState::Idle;
                slot.entry = NEVER;
                let failed = std::mem::take(&mut slot.restarting);
                self.leave_topics(index, now);
                if failed {
                    self.tell_outage(index, false, now);
                }
                self.forget_vote(index, now);
            }
            SlotState::Active if slot.body.is_some() => self.leave(index, now),
            SlotState::Starting | SlotState::Active => {
                slot.pending = PendingRequest::Leave;
                if slot.policy.interrupt {
                    slot.cancelled.store(true, Ordering::Relaxed);
                }
            }
        }
    }

    /// Shuts a component down as soon as possible.
    fn leave(&mut self, index: u32, now: u64) {
        let slot = &mut self.slots[index as usize];
        slot.state = SlotState::Leaving;
        if !slot.queued {
            self.enqueue(index, now);
        }
    }

    /// Schedules the next job of a component that is alive and whose code has just returned.
    pub(crate) fn resume(&mut self, index: u32, now: u64) {
        let slot = &mut self.slots[index as usize];
        if self.phase == RunPhase::Stopping {
            self.ending.push_back(index);
            return;
        }
        let waiting = std::mem::take(&mut slot.waiting);
        match slot.pending {
            PendingRequest::Leave => {
                slot.pending = PendingRequest::None;
                self.leave(index, now);
            }
            PendingRequest::Return { .. } => self.leave(index, now),
            PendingRequest::None if waiting => self.enqueue(index, now),
            PendingRequest::None => {}
        }
    }

    /// Handles the return of a component's initialization.
    pub(crate) fn started(&mut self, index: u32, now: u64) {
        self.release_kept(index, now);
        self.note_differs(index, now);
        let slot = &mut self.slots[index as usize];
        slot.state = SlotState::Active;
        let (number, again) = (slot.restarts, std::mem::take(&mut slot.restarting));
        let continued = slot.body.as_ref().is_some_and(|body| body.part.lasting.has_continued());
        if slot.held {
            return;
        }
        self.step(now, index, TraceStep::Started);
        self.emit(now, index, if again { Occurrence::Restarted { number, continued } } else { Occurrence::Started });
        let slot = &mut self.slots[index as usize];
        slot.due = now.saturating_add(slot.policy.delay);
        slot.in_delay = true;
        if let Some(last) = slot.last_due.filter(|last| slot.due <= *last) {
            // Otherwise a component that schedules itself anew without a delay would keep virtual time from advancing.
            slot.due = last.saturating_add(slot.policy.period);
        }
        if self.phase == RunPhase::Running && slot.pending == PendingRequest::None {
            let when = slot.next_time().max(now);
            self.enqueue(index, when);
            self.react_to_news(index, now);
        } else {
            self.resume(index, now);
        }
    }

    /// Handles the end of a component's shutdown.
    pub(crate) fn left(&mut self, index: u32, now: u64) {
        if self.memory.takes_now(self.phase) {
            self.note_differs(index, now);
        }
        self.leave_topics(index, now);
        self.step(now, index, TraceStep::Left);
        self.stop_its_hardware(index);
        let slot = &mut self.slots[index as usize];
        slot.react_due = NEVER;
        let pending = std::mem::replace(&mut slot.pending, PendingRequest::None);
        slot.state = SlotState::Idle;
        slot.waiting = false;
        if let Some(reason) = slot.overrun_failure.take() {
            slot.state = SlotState::Failed;
            self.reasons.push(reason);
            self.lost(index, now);
            return;
        }
        self.emit(now, index, Occurrence::Left);
        self.forget_vote(index, now);
        if let PendingRequest::Return { lasting } = pending {
            self.request(index, Request::Schedule { lasting }, now);
        }
    }

    /// Removes a failed instance from its topics, but keeps its read positions for the next instance.
    pub(in crate::schedule) fn keep_subscriptions(&mut self, body: &mut Body) {
        for topic in body.part.publishers.drain(..) {
            self.bus.unpublish(topic);
        }
        body.part.kept.append(&mut body.part.subscriptions);
        body.clear_inboxes();
    }

    /// Removes a component from all topics. Whoever schedules it again wants a new one.
    pub(crate) fn leave_topics(&mut self, index: u32, now: u64) {
        if let Some(mut body) = self.slots[index as usize].body.take() {
            body.part.lasting.forget();
            self.keep_subscriptions(&mut body);
            self.release(index, &mut body, now);
            self.note_saved(&body.part, false, now);
            self.slots[index as usize].body = Some(body);
        }
    }

    /// Releases the kept subscriptions that a new instance did not use again.
    fn release_kept(&mut self, index: u32, now: u64) {
        if let Some(mut body) = self.slots[index as usize].body.take() {
            self.release(index, &mut body, now);
            self.slots[index as usize].body = Some(body);
        }
    }

    pub(crate) fn release(&mut self, index: u32, body: &mut Body, now: u64) {
        for kept in body.part.kept.drain(..) {
            let topic = self.bus.topic_of(&kept);
            let lost = self.bus.unsubscribe(kept);
            self.tell_interest(topic);
            if lost > 0 {
                let topic = std::sync::Arc::clone(self.bus.name(topic));
                self.dropped(index, &topic, lost, &[], now);
            }
        }
    }
}
