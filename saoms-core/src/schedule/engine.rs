use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use saoms_api::host::SharedMessage;
use saoms_api::{Chance, Failure, Time, Work};

use super::body::{Body, Job, Part};
use super::ending::EndCause;
use super::inject::Injections;
use super::overrun::Decision;
use super::queue::Queue;
use super::settings::{ClockKind, Settings, nanos};
use super::slot::{NEVER, Slot, SlotState, Wish};
use super::trace::{Trace, TraceStep};
use crate::bus::{Bus, TopicId};
use crate::fault::{Faults, MessageFaultKind};
use crate::hash::fold;
use crate::journal::{OutsideRing, RecordQueue};
use crate::observe::{News, Occurrence, RunEvent, SentMessage};
use saoms_lang::assembly::Loss;

/// The state of a run: due times, states of components, topics. It runs no component code itself; a driving thread
/// takes a component's body with [`begin`](Engine::begin), performs the job without holding the lock, and gives the
/// body back with [`finish`](Engine::finish).
pub(super) struct Engine {
    pub(super) slots: Vec<Slot>,
    pub(super) queue: Queue,
    pub(super) bus: Bus,
    pub(super) phase: RunPhase,
    pub(super) roles: Roles,
    /// Events for the observers, delivered when the lock is free.
    pub(super) news: Vec<News>,
    /// True if the sleeping timer has to be woken.
    pub(super) wake: bool,
    pub(super) trace: Option<Trace>,
    /// Records for the observers of the journal; `None` without such observers.
    pub(super) records: Option<Arc<RecordQueue>>,
    /// Number of records that are kept for each component.
    pub(super) journal_capacity: usize,
    /// Records that did not reach those observers.
    pub(super) lost_records: u64,
    /// Executions of all components.
    pub(super) executions: Arc<AtomicU64>,
    /// Number of bodies whose code runs.
    pub(super) out: usize,
    /// Number of threads that wait for a body to return, and whether one has returned.
    pub(super) awaited: usize,
    pub(super) has_returned: bool,
    /// Components that still have to shut down, once the run ends.
    pub(super) ending: VecDeque<u32>,
    /// Messages from outside, and those that faults hold up.
    pub(super) injections: Injections,
    /// The newest records of messages from outside.
    pub(super) outside: OutsideRing,
    /// Counter of the journal's records.
    pub(super) record_ids: Arc<AtomicU64>,
    pub(super) faults: Faults,
    /// The number of each component, by its path.
    pub(super) numbers: HashMap<Arc<str>, u32>,
    /// The component of a change that failed in a call, before the change was committed.
    pub(super) held_failure: Option<(u32, Failure)>,
    pub(super) cause: Option<EndCause>,
    pub(super) reasons: Vec<String>,
    /// Beginning of the end, in the time of the run and on the machine's clock.
    pub(super) ended: (u64, u64),
    pub(super) votes: VoteTally,
    /// Latest end of the run.
    pub(super) limit: u64,
    /// Time up to which virtual time may advance for now.
    pub(super) pause: u64,
    pub(super) real: bool,
    pub(super) budget: u64,
    pub(super) seed: u64,
}

/// Phases of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RunPhase {
    /// Components initialize; their messages are held back.
    Starting,
    /// Time advances and components execute.
    Running,
    /// Components shut down.
    Stopping,
    /// The run is over.
    Ended,
}

/// Roles of the threads.
#[derive(Debug, Default)]
pub(super) struct Roles {
    /// The number of the thread that does the timer's work: it changes when another takes over.
    pub(super) timer: u64,
    /// The kernel's number of that thread.
    pub(super) thread: i32,
    /// Component whose code that thread runs.
    pub(super) running: Option<u32>,
    /// Time until which it sleeps; 0 while it is awake.
    pub(super) asleep_until: u64,
    /// Components for the worker threads.
    pub(super) work: VecDeque<u32>,
    pub(super) workers: usize,
    pub(super) idle_workers: usize,
}

/// Counts of the votes about the work that is left.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct VoteTally {
    pub(super) voters: usize,
    pub(super) done: usize,
}

/// Next action of the timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// Run this job of this component.
    Run(u32, Job),
    /// Hand work over to a worker thread.
    HandOver,
    /// Sleep until this time.
    Wait(u64),
    /// The run is over.
    Ended,
}

impl Engine {
    pub(super) fn new(settings: &Settings) -> Engine {
        Engine {
            slots: Vec::new(),
            queue: Queue::default(),
            bus: Bus::default(),
            phase: RunPhase::Starting,
            roles: Roles::default(),
            news: Vec::new(),
            wake: false,
            trace: (settings.clock == ClockKind::Virtual).then(Trace::default),
            records: None,
            journal_capacity: settings.journal,
            lost_records: 0,
            executions: Arc::default(),
            out: 0,
            awaited: 0,
            has_returned: false,
            ending: VecDeque::new(),
            injections: Injections::default(),
            outside: OutsideRing::default(),
            record_ids: Arc::default(),
            faults: settings.faults.clone(),
            numbers: HashMap::new(),
            held_failure: None,
            cause: None,
            reasons: Vec::new(),
            ended: (0, 0),
            votes: VoteTally::default(),
            limit: settings.limit.map_or(NEVER, nanos),
            pause: 0,
            real: settings.clock == ClockKind::Real,
            budget: nanos(settings.budget),
            seed: settings.seed,
        }
    }

    /// The action at this time.
    pub(super) fn next(&mut self, now: u64) -> Next {
        loop {
            match self.phase {
                RunPhase::Running => {
                    // Executions due before the limit still run, however late.
                    if now >= self.limit && self.earliest().is_none_or(|when| when >= self.limit) {
                        self.begin_stop(EndCause::Elapsed, self.limit);
                        continue;
                    }
                    if self.injections.earliest().is_some_and(|when| when <= now && when < self.limit) {
                        self.deliver_injections(now);
                        continue;
                    }
                    let Some((when, index)) = self.queue.pop_due(now) else {
                        return Next::Wait(self.earliest().unwrap_or(NEVER).min(self.limit));
                    };
                    let slot = &mut self.slots[index as usize];
                    if slot.entry != when {
                        continue;
                    }
                    slot.entry = NEVER;
                    if slot.body.is_none() || slot.held {
                        slot.waiting = true;
                    } else if slot.apart.now {
                        slot.queued = true;
                        self.roles.work.push_back(index);
                        return Next::HandOver;
                    } else if let Some(job) = self.job(index, now) {
                        return Next::Run(index, job);
                    }
                }
                RunPhase::Stopping => match self.next_to_end() {
                    Some(index) => return Next::Run(index, Job::Shutdown),
                    None if self.out == 0 => self.phase = RunPhase::Ended,
                    None => return Next::Wait(NEVER),
                },
                RunPhase::Starting => return Next::Wait(NEVER),
                RunPhase::Ended => return Next::Ended,
            }
        }
    }

    /// The earliest due time.
    fn earliest(&self) -> Option<u64> {
        self.queue.earliest().into_iter().chain(self.injections.earliest()).min()
    }

    /// The job of a component that is due.
    pub(super) fn job(&mut self, index: u32, now: u64) -> Option<Job> {
        let slot = &mut self.slots[index as usize];
        match slot.state {
            SlotState::Starting => Some(Job::Start),
            SlotState::Leaving => Some(Job::Shutdown),
            SlotState::Active if now >= slot.until => {
                slot.state = SlotState::Leaving;
                Some(Job::Shutdown)
            }
            SlotState::Active if now < slot.due => {
                let when = slot.due.min(slot.until);
                self.enqueue(index, when);
                None
            }
            SlotState::Active => match slot.decide(now, self.limit) {
                Decision::Stop { missed } => {
                    self.condemn(index, missed, now);
                    Some(Job::Shutdown)
                }
                Decision::Execute { .. } => Some(Job::Execute),
            },
            SlotState::Idle | SlotState::Failed | SlotState::Abandoned | SlotState::Removed => None,
        }
    }

    /// Stops a component whose executions could not start in time, as its `overrun` demands.
    fn condemn(&mut self, index: u32, missed: u64, now: u64) {
        let slot = &mut self.slots[index as usize];
        slot.statistics.missed += missed;
        slot.state = SlotState::Leaving;
        slot.wish = Wish::None;
        let what = Occurrence::Overrun { missed };
        slot.condemned = Some(format!("component `{}` {what}", slot.name));
        self.tell(now, index, what);
    }

    /// Takes a component's body for a job.
    pub(super) fn begin(&mut self, index: u32, job: Job, now: u64) -> Option<Box<Body>> {
        let slot = &mut self.slots[index as usize];
        let mut body = slot.body.take()?;
        self.out += 1;
        body.part.now = now;
        match job {
            Job::Execute => self.begin_execution(index, &mut body, now),
            Job::Shutdown => body.part.due = now,
            Job::Start => {
                let seed = if slot.instances == 0 { self.seed } else { fold(self.seed, slot.instances) };
                slot.instances += 1;
                slot.execution = 0;
                slot.cancelled.store(false, Ordering::Relaxed);
                body.part.chance = Chance::for_component(seed, &slot.name);
                body.part.due = now;
                body.part.execution = 0;
            }
        }
        Some(body)
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
        if !self.faults.is_empty() {
            part.fault = self.faults.take_of_execution(&slot.name, Time::from_nanos(now));
        }
        part.execution = slot.execution;
        slot.execution += 1;
        slot.statistics.executions += 1;
        // Only the holder of the lock writes.
        self.executions.store(self.executions.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        let mut lost = None;
        for (subscription, inbox) in part.subscriptions.iter_mut().zip(&mut body.inboxes) {
            let missing = self.bus.collect(subscription, inbox);
            slot.statistics.received += inbox.len() as u64;
            if missing > 0 {
                let (topic, before) = lost.unwrap_or((self.bus.topic_of(subscription), 0));
                lost = Some((topic, before + missing));
            }
        }
        match lost {
            None => slot.dropping = false,
            Some((topic, count)) => {
                let topic = Arc::clone(self.bus.name(topic));
                self.dropped(index, &topic, count, now);
            }
        }
    }

    /// Counts messages that did not fit into a queue.
    pub(super) fn dropped(&mut self, index: u32, topic: &Arc<str>, count: u64, now: u64) {
        let slot = &mut self.slots[index as usize];
        if slot.statistics.dropped == 0 && slot.policy.loss == Loss::Fail {
            self.reasons.push(format!(
                "component `{}` lost messages of topic `{topic}`, whose queue was full: read faster, give it a longer `queue`, \
                 or accept loss",
                slot.name
            ));
        }
        slot.statistics.dropped += count;
        if !std::mem::replace(&mut slot.dropping, true) {
            self.tell(now, index, Occurrence::Dropped { topic: Arc::clone(topic), count });
        }
    }

    /// Gives a component's body back after a job.
    pub(super) fn finish(
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
        self.came_back();
        let slot = &mut self.slots[index as usize];
        if job == Job::Execute && self.real {
            let slow = ended.saturating_sub(started) > self.budget;
            slot.statistics.slow += u64::from(slow);
            if slot.apart.now {
                slot.apart.ran(slow);
            }
            if ended > body.part.due.saturating_add(slot.policy.deadline) {
                slot.statistics.deadline_misses += 1;
            }
        }
        match result {
            Err(failure) => {
                self.fail(index, &mut body, job, failure, ended);
                self.slots[index as usize].body = Some(body);
            }
            Ok(()) => {
                let held = body.part.held;
                if !held {
                    self.deliver(&mut body.part, ended);
                }
                let vote = body.part.vote.take_if(|_| !held);
                if job == Job::Start {
                    body.inboxes.resize_with(body.part.subscriptions.len(), Vec::new);
                }
                self.slots[index as usize].body = Some(body);
                if let Some(vote) = vote {
                    self.vote(index, vote, ended);
                }
                match job {
                    Job::Execute => self.executed(index, ended),
                    Job::Start => self.started(index, ended),
                    Job::Shutdown => self.left(index, ended),
                }
            }
        }
    }

    /// Notes that a body has returned. At the end of a run the timer may wait for it.
    pub(super) fn came_back(&mut self) {
        self.out -= 1;
        self.has_returned |= self.awaited > 0;
        self.wake |= self.phase == RunPhase::Stopping && self.roles.asleep_until != 0;
    }

    pub(super) fn is_abandoned(&self, index: u32) -> bool {
        self.slots[index as usize].state == SlotState::Abandoned
    }

    /// Takes over the journal records of a component.
    #[inline]
    pub(super) fn record(&mut self, part: &mut Part) {
        let recorder = &mut part.recorder;
        if recorder.is_empty() {
            return;
        }
        if let Some(trace) = &mut self.trace {
            for head in recorder.batch.heads() {
                trace.record(head);
            }
        }
        if let Some(records) = &self.records {
            records.put(part.index, recorder);
        }
        self.slots[part.index as usize].journal.take(recorder, self.journal_capacity);
    }

    /// Publishes the messages of an outbox, and takes over its records. At the end of a run messages have no reader any
    /// more, so that no queue can overflow.
    #[inline]
    pub(super) fn deliver(&mut self, part: &mut Part, now: u64) {
        self.record(part);
        self.slots[part.index as usize].statistics.sent += part.outbox.len() as u64;
        for (topic, message) in part.outbox.drain(..) {
            if let Some(trace) = &mut self.trace {
                trace.message(now, part.index, self.bus.name_hash(topic), &message);
            }
            if let Some(observers) = self.bus.observers(topic) {
                let (topic, component) = (Arc::clone(self.bus.name(topic)), Arc::clone(&part.name));
                let sent = SentMessage { topic, component, message: message.clone() };
                self.news.push(News::Sent(sent, Arc::clone(observers)));
            }
            if self.phase == RunPhase::Running {
                if self.faults.is_empty() {
                    self.bus.publish(topic, message);
                } else {
                    self.publish_with_faults(topic, message, now);
                }
            }
        }
    }

    /// Publishes a message, or applies its injected fault.
    #[cold]
    fn publish_with_faults(&mut self, topic: TopicId, message: SharedMessage, now: u64) {
        match self.faults.of_message(self.bus.name(topic), Time::from_nanos(now)) {
            Some(MessageFaultKind::Lost) => {}
            Some(MessageFaultKind::Late(time)) => {
                let when = now.saturating_add(nanos(time));
                self.injections.hold_up(when, topic, message);
                self.wake |= when < self.roles.asleep_until;
            }
            Some(MessageFaultKind::Duplicated) => {
                self.bus.publish(topic, message.clone());
                self.bus.publish(topic, message);
            }
            None => self.bus.publish(topic, message),
        }
    }

    fn executed(&mut self, index: u32, now: u64) {
        let slot = &mut self.slots[index as usize];
        slot.waiting = false;
        if self.phase == RunPhase::Running && slot.wish == Wish::None {
            let when = slot.due.min(slot.until).max(now);
            self.enqueue(index, when);
        } else {
            self.resume(index, now);
        }
    }

    /// Puts a component into the queue.
    pub(super) fn enqueue(&mut self, index: u32, when: u64) {
        self.slots[index as usize].entry = when;
        self.queue.push(when, index);
        self.wake |= when < self.roles.asleep_until;
        if self.queue.len() > 2 * self.slots.len() + 64 {
            let slots = &self.slots;
            self.queue.retain(|when, index| slots[index as usize].entry == when);
        }
    }

    /// Records a component's vote about the work that is left, and ends the run if none is left.
    pub(super) fn vote(&mut self, index: u32, vote: Work, now: u64) {
        self.note_vote(index, vote, now);
        self.end_if_done(now);
    }

    /// Records a component's vote about the work that is left.
    pub(super) fn note_vote(&mut self, index: u32, vote: Work, now: u64) {
        let before = self.slots[index as usize].vote.replace(vote);
        if before == Some(vote) {
            return;
        }
        self.votes.voters += usize::from(before.is_none());
        match vote {
            Work::Done => self.votes.done += 1,
            Work::Open => self.votes.done -= usize::from(before.is_some()),
        }
        self.step(now, index, TraceStep::Voted);
    }

    /// Ends the run if all voters see no work left, and none can come from outside.
    pub(super) fn end_if_done(&mut self, now: u64) {
        if self.votes.voters > 0 && self.votes.done == self.votes.voters && self.injections.are_over() {
            self.begin_stop(EndCause::Done, now);
        }
    }

    /// Queues an event about a component for the observers.
    pub(super) fn tell(&mut self, now: u64, index: u32, what: Occurrence) {
        let component = Some(Arc::clone(&self.slots[index as usize].name));
        self.news.push(RunEvent { time: Time::from_nanos(now), component, what }.into());
    }

    pub(super) fn step(&mut self, now: u64, index: u32, step: TraceStep) {
        if let Some(trace) = &mut self.trace {
            trace.step(now, index, step);
        }
    }
}
