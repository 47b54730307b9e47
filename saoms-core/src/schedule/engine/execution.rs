use std::sync::Arc;
use std::sync::atomic::Ordering;

use saoms_api::host::prefetch;
use saoms_api::{Chance, Failure};

use super::overrun::Decision;
use super::slot::{PendingRequest, SlotState};
use super::{Engine, RunPhase};
use crate::fault::TaskFault;
use crate::hash::fold;
use crate::observe::Occurrence;
use crate::schedule::component::body::{Body, Job};
use crate::schedule::os::sys;
use crate::schedule::settings::nanos;

/// Number of components from which on the memory of the next one is loaded ahead.
const LARGE: usize = 400;

impl Engine {
    /// The job of a component that is due.
    pub(crate) fn job(&mut self, index: u32, now: u64) -> Option<Job> {
        let slot = &mut self.slots[index as usize];
        match slot.state {
            SlotState::Starting => Some(Job::Start),
            SlotState::Leaving => Some(Job::Shutdown),
            SlotState::Active if now >= slot.until => {
                slot.state = SlotState::Leaving;
                Some(Job::Shutdown)
            }
            SlotState::Active if slot.is_suspended() => {
                self.leave_out(index, now);
                None
            }
            SlotState::Active if now >= slot.react_due => self.reaction(index),
            SlotState::Active if now < slot.due => {
                let when = slot.next_time();
                self.enqueue(index, when);
                None
            }
            SlotState::Active => match slot.decide(now, self.limit) {
                Decision::Stop { missed } => {
                    self.stop_for_overrun(index, missed, now);
                    Some(Job::Shutdown)
                }
                Decision::Execute { .. } => Some(Job::Execute),
            },
            SlotState::Idle | SlotState::Failed | SlotState::Abandoned | SlotState::Removed => None,
        }
    }

    /// Stops a component whose executions could not start in time, as its `overrun` demands.
    fn stop_for_overrun(&mut self, index: u32, missed: u64, now: u64) {
        let slot = &mut self.slots[index as usize];
        slot.statistics.missed += missed;
        slot.state = SlotState::Leaving;
        slot.pending = PendingRequest::None;
        let what = Occurrence::Overrun { missed };
        slot.overrun_failure = Some(format!("component `{}` {what}", slot.name));
        self.emit(now, index, what);
    }

    /// Takes a component's body for a job.
    pub(crate) fn begin(&mut self, index: u32, job: Job, now: u64) -> Option<Box<Body>> {
        let slot = &mut self.slots[index as usize];
        let mut body = slot.body.take()?;
        self.out += 1;
        self.slots[index as usize].out_since = self.begin_of_code(now);
        body.part.now = now;
        self.note_code(index, &mut body);
        let slot = &mut self.slots[index as usize];
        if matches!(job, Job::Start | Job::Shutdown | Job::Order) {
            body.part.collection.reset();
        }
        if !self.real
            && self.phase == RunPhase::Running
            && !matches!(job, Job::Ask | Job::Describe | Job::Sample | Job::Order | Job::Save)
        {
            self.begun = now;
        }
        match job {
            Job::Execute => {
                self.begin_execution(index, &mut body, now);
                self.prefetch_next();
            }
            Job::React => self.begin_reaction(index, &mut body),
            Job::Shutdown => {
                body.part.due = now;
                // At the end of a run no code runs any more that could become free, unless that of another component.
                body.part.is_ending = self.phase == RunPhase::Stopping;
                body.part.retries_shutdown = self.phase != RunPhase::Stopping || self.out > 1;
            }
            Job::Ask | Job::Describe | Job::Sample | Job::Save => {}
            Job::Order => self.begin_order(index, &mut body, now),
            Job::Start => {
                let seed = if slot.instances == 0 { self.seed } else { fold(self.seed, slot.instances) };
                slot.instances += 1;
                // It may say something else than the instance before.
                slot.is_wanted = None;
                slot.execution = 0;
                slot.cancelled.store(false, Ordering::Relaxed);
                body.part.chance = Chance::for_component(seed, &slot.name);
                body.part.due = now;
                body.part.execution = 0;
                let declared = slot.spec.class.declaration();
                body.part.lasting.saves = slot.policy.restarts > 0 && declared.saves;
                body.part.lasting.outlives = declared.saves && self.memory.is_on();
                body.part.lasting.saves_at_once = declared.saves && declared.apart && self.memory.is_on();
                body.part.heartbeats = self.heartbeats_of(index);
                body.part.heartbeats_elsewhere = self.heartbeats_elsewhere(index);
                if body.part.heartbeats_elsewhere.is_some() {
                    // It may hang while hardware of another program moves.
                    self.stops.watch();
                }
                let has_hardware = !body.part.heartbeats.is_empty() || body.part.heartbeats_elsewhere.is_some();
                if has_hardware && !self.with_hardware.contains(&index) {
                    self.with_hardware.push(index);
                }
            }
        }
        Some(body)
    }

    /// Loads what the next execution needs while this one runs. In a fleet of thousands nothing of a component is left
    /// in the processor's cache since its last execution.
    #[inline]
    fn prefetch_next(&self) {
        if self.slots.len() < LARGE {
            return;
        }
        let [next, second] = self.queue.first_two().map(|index| {
            let slot = self.slots.get(index? as usize)?;
            slot.body.as_deref()
        });
        if let Some(body) = second {
            prefetch(body);
        }
        // It was the second one before: its body has come.
        if let Some(body) = next {
            prefetch(body.part.collection.watched.as_slice());
            if let Some(instance) = &body.instance {
                prefetch(&**instance);
            }
        }
    }

    fn begin_execution(&mut self, index: u32, body: &mut Body, now: u64) {
        let slot = &mut self.slots[index as usize];
        let (due, part) = (slot.due, &mut body.part);
        if self.real {
            slot.statistics.late.record(now.saturating_sub(due));
        }
        if let Decision::Execute { next, missed } = slot.decide(now, self.limit) {
            slot.due = next;
            slot.statistics.missed += missed;
        }
        slot.last_due = Some(due);
        part.due = due;
        if !self.faults.is_quiet() {
            part.fault = self.faults.take_of_execution(index);
            let period = slot.policy.period;
            // A clock that goes wrong comes to its next period earlier, or later.
            slot.due = slot.due.saturating_sub(period).saturating_add(self.faults.on_run(index, period, now));
            if let (Some(TaskFault::Stall(time)), false) = (part.fault, self.real) {
                part.fault = None;
                slot.busy_until = now.saturating_add(nanos(time));
            }
        }
        part.execution = slot.execution;
        slot.execution += 1;
        slot.statistics.executions += 1;
        // Only the holder of the lock writes.
        self.executions.store(self.executions.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        self.collect(index, body, false, now);
        self.note_reading(index, &body.part, &body.inboxes);
    }

    /// Collects the messages of an execution, or of a reaction: those of the topics that trigger it.
    #[inline]
    pub(super) fn collect(&mut self, index: u32, body: &mut Body, reacts: bool, now: u64) {
        let slot = &mut self.slots[index as usize];
        let inboxes = if reacts { &mut body.reactions } else { &mut body.inboxes };
        let mut lost = None;
        let collection = &mut body.part.collection;
        let since = if reacts { None } else { collection.since(&self.bus) };
        let mut published = self.bus.published();
        for (place, (subscription, inbox)) in body.part.subscriptions.iter_mut().zip(&mut *inboxes).enumerate() {
            if since.is_some_and(|since| collection.is_quiet(place, &self.bus, since))
                || self.bus.is_trigger(subscription) != reacts
            {
                continue;
            }
            if !inbox.is_empty() {
                // Events of an execution that was skipped: what came since waits in the queue.
                published = 0;
                continue;
            }
            let missing = if self.bus.has_region(subscription) {
                let departed = &mut body.part.departed;
                if departed.len() <= place {
                    departed.resize_with(place + 1, Vec::new);
                }
                let missing = self.bus.collect_in_region(subscription, inbox, &mut departed[place]);
                body.part.has_departed |= !departed[place].is_empty();
                missing
            } else {
                self.bus.collect(subscription, inbox)
            };
            if self.bus.is_addressed(subscription) {
                inbox.retain(|message| message.to().is_none_or(|to| to == index));
            }
            if !inbox.is_empty() {
                slot.statistics.received += inbox.len() as u64;
                if !reacts {
                    collection.filled.note(place);
                }
            }
            if missing > 0 {
                let (topic, _, before) = lost.unwrap_or((self.bus.topic_of(subscription), place, 0));
                lost = Some((topic, place, before + missing));
            }
        }
        if !reacts {
            if since.is_none() {
                collection.watch(&body.part.subscriptions, &self.bus);
            }
            collection.published = published;
        }
        match lost {
            None => slot.dropping = false,
            Some((topic, place, count)) => {
                let topic = Arc::clone(self.bus.name(topic));
                self.dropped(index, &topic, count, &inboxes[place], now);
            }
        }
    }

    /// Gives a component's body back after a job.
    pub(crate) fn finish(
        &mut self,
        index: u32,
        mut body: Box<Body>,
        job: Job,
        result: Result<(), Failure>,
        started: u64,
        ended: u64,
    ) {
        if self.is_abandoned(index) {
            // It was abandoned, and its destructor may block as its code did: it is leaked.
            std::mem::forget(body);
            return;
        }
        self.note_return();
        self.slots[index as usize].memory.note_end_of_code();
        if self.phase == RunPhase::Stopping {
            // Each component has the time of `grace`. Calls that it makes give it no more.
            self.ended.1 = sys::monotonic();
        }
        if matches!(job, Job::Describe | Job::Sample) {
            self.note_answer(index);
        }
        if self.slots[index as usize].stops_again {
            self.stop_again(index);
        }
        if job == Job::Order {
            self.finish_order(index, &mut body, result.as_ref().err(), ended);
        }
        let slot = &mut self.slots[index as usize];
        if matches!(job, Job::Execute | Job::React) && self.real {
            let slow = ended.saturating_sub(started) > self.budget && !slot.isolation.always;
            slot.statistics.slow += u64::from(slow);
            if slot.isolation.active {
                slot.isolation.count_execution(slow);
            }
            let since = if job == Job::React { slot.reacts_since } else { body.part.due };
            if ended > since.saturating_add(slot.policy.deadline) {
                slot.statistics.deadline_misses += 1;
            }
        }
        match result {
            Err(failure) if body.part.told.is_none() && self.tries_again(index, job, &failure, &body.part) => {
                self.skip(index, body, job, &failure, ended);
            }
            Err(failure) => {
                self.fail(index, &mut body, job, &failure, ended);
                self.slots[index as usize].body = Some(body);
            }
            Ok(()) => {
                let held = body.part.held;
                self.note_saved(&body.part, job == Job::Save, ended);
                if !held {
                    self.deliver(&mut body.part, ended);
                }
                let vote = body.part.vote.take_if(|_| !held);
                let slot = &mut self.slots[index as usize];
                match job {
                    Job::Execute | Job::React | Job::Order | Job::Save | Job::Shutdown => {}
                    Job::Describe | Job::Sample => match body.part.undescribed.take() {
                        Some(failure) => self.note_unsampled(index, &failure, ended),
                        None => {
                            slot.described = body.part.described.take();
                            self.note_sampled(index, ended);
                        }
                    },
                    Job::Ask => {
                        slot.waits_for = body.part.waits_for.take();
                        self.note_waiting(index);
                    }
                    Job::Start => {
                        body.fit_inboxes();
                        self.recall_unread(&mut body);
                        body.give_unread(&self.bus);
                        self.note_inbox(index);
                    }
                }
                self.slots[index as usize].body = Some(body);
                if let Some(vote) = vote {
                    self.vote(index, vote, ended);
                }
                match job {
                    Job::Execute | Job::React => self.executed(index, ended),
                    Job::Ask | Job::Describe | Job::Sample | Job::Order | Job::Save => self.answered(index, ended),
                    Job::Start => self.started(index, ended),
                    Job::Shutdown => self.left(index, ended),
                }
            }
        }
    }

    /// Notes that a body has returned. At the end of a run the timer may wait for it.
    pub(crate) fn note_return(&mut self) {
        self.out -= 1;
        if !self.ending_later.is_empty() {
            self.ending.extend(self.ending_later.drain(..));
        }
        self.has_returned |= self.awaited > 0;
        self.retry_cut();
        if self.has_orders() {
            self.look_at = 0;
            self.wake |= self.roles.asleep_until != 0;
        }
        self.wake |= self.phase == RunPhase::Stopping && self.roles.asleep_until != 0;
    }

    #[inline]
    pub(super) fn executed(&mut self, index: u32, now: u64) {
        self.note_executed(index, now);
        let slot = &mut self.slots[index as usize];
        slot.waiting = false;
        slot.skipping = false;
        if self.phase == RunPhase::Running && slot.pending == PendingRequest::None {
            let when = slot.next_time().max(now).max(slot.busy_until);
            self.enqueue(index, when);
        } else {
            self.resume(index, now);
        }
    }
}
