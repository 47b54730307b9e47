//! The state of a run and every change to it. The engine runs no component code and starts no thread.

mod busy;
pub(super) mod commit;
mod delivery;
pub(super) mod ending;
mod execution;
pub(super) mod failing;
pub(super) mod faults;
pub(super) mod lifecycle;
pub(super) mod memory;
mod notices;
mod overrun;
pub(super) mod queue;
mod reaction;
mod report;
pub(super) mod sampling;
pub(super) mod slot;
pub(super) mod standstill;
mod status;
pub(super) mod trace;
pub(super) mod votes;

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use saoms_api::{Failure, Time};

use self::commit::{Commits, LastCommits};
use self::ending::EndCause;
use self::memory::Memory;
use self::queue::Queue;
use self::sampling::Sampling;
use self::slot::{NEVER, Slot, SlotState};
use self::standstill::StandstillDetector;
use self::status::Questions;
use self::trace::{Trace, TraceStep};
use self::votes::VoteTally;
use super::change::ApartBodies;
use super::component::body::Job;
use super::hold::Pace;
use super::inject::Injections;
use super::networks::Networks;
use super::order::PendingOrders;
use super::os::clock::Clock;
use super::settings::{ClockKind, Settings, nanos};
use super::stop::Stops;
use super::topics::publishers::DeclaredPublishers;
use super::topics::speakers::Speakers;
use super::topics::takers::Takers;
use crate::bus::Bus;
use crate::fault::FaultPlay;
use crate::journal::{OutsideRing, RecordQueue};
use crate::observe::{Notification, Occurrence, RunEvent};
use crate::store::Contents;

/// The state of a run: due times, states of components, topics. It runs no component code itself; a driving thread
/// takes a component's body with [`begin`](Engine::begin), performs the job without holding the lock, and gives the
/// body back with [`finish`](Engine::finish).
pub(crate) struct Engine {
    pub(crate) slots: Vec<Slot>,
    pub(crate) queue: Queue,
    pub(crate) bus: Bus,
    pub(crate) phase: RunPhase,
    /// True while the start of a run in virtual time is told: nothing happens until it has been.
    pub(crate) is_announcing: bool,
    /// True while components are out for a change of the fleet: virtual time stands still.
    pub(crate) is_changing: bool,
    pub(crate) roles: Roles,
    /// Events for the observers, delivered when the lock is free.
    pub(crate) notifications: Vec<Notification>,
    /// True if the sleeping timer has to be woken.
    pub(crate) wake: bool,
    pub(crate) trace: Option<Trace>,
    /// Records for the observers of the journal; `None` without such observers.
    pub(crate) records: Option<Arc<RecordQueue>>,
    /// Number of records that are kept for each component.
    pub(crate) journal_capacity: usize,
    /// Records that did not reach those observers.
    pub(crate) lost_records: u64,
    /// Executions of all components.
    pub(crate) executions: Arc<AtomicU64>,
    /// Number of bodies whose code runs.
    pub(crate) out: usize,
    /// Number of threads that wait for a body to return, and whether one has returned.
    pub(crate) awaited: usize,
    pub(crate) has_returned: bool,
    /// Components that still have to shut down, once the run ends.
    pub(crate) ending: VecDeque<u32>,
    /// Those that found another component busy: they follow when some code returns.
    pub(crate) ending_later: Vec<u32>,
    /// Messages from outside, and those that faults hold up.
    pub(crate) injections: Injections,
    /// Orders that wait for a component whose code runs.
    pub(crate) orders: PendingOrders,
    /// In virtual time, the time of the newest execution.
    pub(crate) begun: u64,
    /// The newest records of messages from outside.
    pub(crate) outside: OutsideRing,
    /// Functions that stop hardware, and the components that have some or use some.
    pub(crate) stops: Arc<Stops>,
    pub(crate) with_hardware: Vec<u32>,
    /// Bodies whose code a change may leave behind.
    pub(crate) apart: ApartBodies,
    /// Counter of the journal's records.
    pub(crate) record_ids: Arc<AtomicU64>,
    pub(crate) faults: FaultPlay,
    pub(crate) networks: Networks,
    /// When what components keep is committed, and what was kept by an earlier program.
    pub(crate) commits: Commits,
    /// Executions that kept something; those of them that are not committed; and how far the end of the run waits for
    /// them.
    pub(crate) batches: u64,
    pub(crate) uncommitted: usize,
    pub(crate) last_commits: LastCommits,
    pub(crate) found: Contents,
    /// What outlives the program beside that.
    pub(crate) memory: Memory,
    /// Messages that are never sent, because what they depend on cannot be committed.
    pub(crate) unsent: u64,
    /// The takers of events since the last change of the fleet, once somebody asked for them; the number of changes.
    pub(crate) takers: (Option<Arc<Takers>>, u64),
    /// The components that say who they are in messages, once somebody asked for them since that change.
    pub(crate) speakers: Option<Arc<Speakers>>,
    /// The components that declare to publish on each topic, once somebody asked for them since that change.
    pub(crate) publishers: Option<Arc<DeclaredPublishers>>,
    /// The number of each component, by its path.
    pub(crate) numbers: HashMap<Arc<str>, u32>,
    /// The component of a change that failed in a call, before the change was committed.
    pub(crate) held_failure: Option<(u32, Failure)>,
    pub(crate) cause: Option<EndCause>,
    pub(crate) reasons: Vec<String>,
    /// Beginning of the end in the time of the run, and the time of the machine at which code returned last since then.
    pub(crate) ended: (u64, u64),
    pub(crate) votes: VoteTally,
    pub(crate) standstill: StandstillDetector,
    pub(crate) questions: Questions,
    pub(crate) sampling: Sampling,
    /// Time before which no message from outside is due and no standstill can be found; later effects only delay one.
    pub(crate) look_at: u64,
    /// Latest end of the run.
    pub(crate) limit: u64,
    /// Time up to which virtual time may advance for now, since a program acts then.
    pub(crate) pause: u64,
    /// Time at which the run pauses, since an operator wants that; `NEVER` while it does not.
    pub(crate) hold: u64,
    /// In virtual time, how fast time passes; `None` is as fast as the machine allows.
    pub(crate) pace: Option<Pace>,
    pub(crate) real: bool,
    pub(crate) clock: Arc<Clock>,
    pub(crate) budget: u64,
    pub(crate) seed: u64,
}

/// Phases of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RunPhase {
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
pub(crate) struct Roles {
    /// The number of the thread that does the timer's work: it changes when another takes over.
    pub(crate) timer: u64,
    /// The kernel's number of that thread.
    pub(crate) thread: i32,
    /// Component whose code that thread runs.
    pub(crate) running: Option<(u32, Job)>,
    /// Time until which it sleeps; 0 while it is awake.
    pub(crate) asleep_until: u64,
    /// Components for the worker threads.
    pub(crate) work: VecDeque<u32>,
    pub(crate) workers: usize,
    pub(crate) idle_workers: usize,
}

/// Next action of the timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Next {
    /// Run this job of this component.
    Run(u32, Job),
    /// Hand work over to a worker thread.
    HandOver,
    /// Make a cut of the present moment for the memory.
    Cut,
    /// Take a sample of the present moment for the observers.
    Sample,
    /// Sleep until this time.
    Wait(u64),
    /// The run is over.
    Ended,
}

impl Engine {
    pub(crate) fn new(settings: &Settings, clock: &Arc<Clock>) -> Engine {
        Engine {
            slots: Vec::new(),
            queue: Queue::default(),
            bus: Bus::default(),
            phase: RunPhase::Starting,
            is_announcing: false,
            is_changing: false,
            roles: Roles::default(),
            notifications: Vec::new(),
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
            ending_later: Vec::new(),
            injections: Injections::of(&settings.faults),
            orders: PendingOrders::default(),
            begun: NEVER,
            outside: OutsideRing::default(),
            stops: Arc::default(),
            with_hardware: Vec::new(),
            apart: ApartBodies::default(),
            record_ids: Arc::default(),
            faults: FaultPlay::new(settings.seed),
            networks: Networks::default(),
            commits: match (settings.clock, nanos(settings.commit_delay)) {
                (ClockKind::Real, _) | (ClockKind::Virtual, 0) => Commits::AtOnce,
                (ClockKind::Virtual, delay) => Commits::After(delay),
            },
            batches: 0,
            uncommitted: 0,
            last_commits: LastCommits::None,
            found: Contents::default(),
            memory: Memory::new(nanos(settings.together)),
            unsent: 0,
            takers: (None, 0),
            speakers: None,
            publishers: None,
            numbers: HashMap::new(),
            held_failure: None,
            cause: None,
            reasons: Vec::new(),
            ended: (0, 0),
            votes: VoteTally::default(),
            standstill: StandstillDetector::new(settings),
            questions: Questions::default(),
            sampling: Sampling::default(),
            look_at: 0,
            limit: settings.limit.map_or(NEVER, nanos),
            pause: 0,
            hold: NEVER,
            pace: None,
            real: settings.clock == ClockKind::Real,
            clock: Arc::clone(clock),
            budget: nanos(settings.budget),
            seed: settings.seed,
        }
    }

    /// The action at this time.
    pub(crate) fn next(&mut self, now: u64) -> Next {
        loop {
            match self.phase {
                RunPhase::Running => {
                    if now >= self.hold {
                        match self.next_while_paused(now) {
                            Some(next) => return next,
                            None if self.phase == RunPhase::Running => {
                                return self.next_for_cut_while_paused(now).unwrap_or_else(|| self.wait_for_cut());
                            }
                            None => continue,
                        }
                    }
                    // Executions due before the limit still run, however late.
                    if now >= self.limit && self.earliest().is_none_or(|when| when >= self.limit) {
                        self.begin_stop(EndCause::Elapsed, self.limit);
                        continue;
                    }
                    if now >= self.memory.due_at_last
                        && let Some(cut) = self.next_for_cut(now)
                    {
                        return cut;
                    }
                    // One comparison in most executions.
                    if now >= self.look_at {
                        if let Some(index) = self.next_order(now) {
                            let slot = &mut self.slots[index as usize];
                            if !slot.isolation.always {
                                return Next::Run(index, Job::Order);
                            }
                            slot.queued = true;
                            self.roles.work.push_back(index);
                            return Next::HandOver;
                        }
                        if self.deliver_due(now) {
                            continue;
                        }
                        if self.standstill.is_quiet(now) {
                            if let Some(question) = self.next_to_ask(now) {
                                return question;
                            }
                            if self.phase != RunPhase::Running {
                                continue;
                            }
                        }
                        let quiet = self.standstill.next_look(now);
                        self.look_at = self.injections.earliest().map_or(quiet, |when| when.min(quiet));
                    }
                    let Some((when, index)) = self.queue.pop_due(now) else {
                        if let Some(cut) = self.next_for_cut(now) {
                            return cut;
                        }
                        if let Some(question) = self.next_question() {
                            return question;
                        }
                        // Real time passes also where nobody executes: a standstill is told then, too.
                        let look_at = if self.real { self.look_at } else { NEVER };
                        let other = look_at.min(self.limit).min(self.next_cut());
                        match self.sample_or_wait(now, self.earliest().unwrap_or(NEVER).min(other)) {
                            Some(next) => return next,
                            None => continue,
                        }
                    };
                    let slot = &mut self.slots[index as usize];
                    if slot.entry != when {
                        continue;
                    }
                    slot.entry = NEVER;
                    if slot.body.is_none() || slot.held {
                        slot.waiting = true;
                    } else if slot.isolation.active {
                        if self.holds_back(index) {
                            continue;
                        }
                        self.slots[index as usize].queued = true;
                        self.roles.work.push_back(index);
                        return Next::HandOver;
                    } else if let Some(job) = self.job(index, now) {
                        return Next::Run(index, job);
                    }
                }
                RunPhase::Stopping if self.sampling.is_last_due() => return self.next_for_last_sample(),
                RunPhase::Stopping if self.is_last_cut_due() => match self.next_for_last_cut(now) {
                    Some(next) => return next,
                    None => continue,
                },
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

    /// The next action at a time at which the fleet pauses: what comes from outside, and questions.
    pub(crate) fn next_while_paused(&mut self, now: u64) -> Option<Next> {
        while self.phase == RunPhase::Running {
            if let Some(index) = self.next_order(now) {
                return Some(Next::Run(index, Job::Order));
            }
            if !self.deliver_due(now) {
                return self.next_question();
            }
        }
        None
    }

    /// Delivers what comes from outside and is due; false if there is nothing.
    fn deliver_due(&mut self, now: u64) -> bool {
        let is_due = self.injections.earliest().is_some_and(|when| when <= now && when < self.limit);
        if is_due {
            self.deliver_injections(now);
        }
        is_due
    }

    /// The earliest due time.
    pub(crate) fn earliest(&self) -> Option<u64> {
        self.queue.earliest().into_iter().chain(self.injections.earliest()).min()
    }

    pub(crate) fn is_abandoned(&self, index: u32) -> bool {
        self.slots[index as usize].state == SlotState::Abandoned
    }

    /// Puts a component into the queue.
    pub(crate) fn enqueue(&mut self, index: u32, when: u64) {
        self.slots[index as usize].entry = when;
        self.queue.push(when, index);
        self.wake |= when < self.roles.asleep_until;
        if self.queue.len() > 2 * self.slots.len() + 64 {
            let slots = &self.slots;
            self.queue.retain(|when, index| slots[index as usize].entry == when);
        }
    }

    /// Queues an event about a component for the observers.
    pub(crate) fn emit(&mut self, now: u64, index: u32, what: Occurrence) {
        let component = Some(Arc::clone(&self.slots[index as usize].name));
        self.notifications.push(RunEvent { time: Time::from_nanos(now), component, what }.into());
    }

    /// Queues an event about the whole fleet for the observers.
    pub(crate) fn note(&mut self, now: u64, what: Occurrence) {
        self.notifications.push(RunEvent { time: Time::from_nanos(now), component: None, what }.into());
    }

    pub(crate) fn step(&mut self, now: u64, index: u32, step: TraceStep) {
        self.standstill.note_effect(now);
        if let Some(trace) = &mut self.trace {
            trace.step(now, index, step);
        }
    }
}
