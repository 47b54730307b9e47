//! Messages from outside the fleet.

mod error;
mod outliving;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::sync::Arc;

use saoms_api::event::fault::FaultCall;
use saoms_api::host::SharedMessage;
use saoms_api::{Cause, Header, Level, Time};
use saoms_lang::assembly::{ComponentSpec, fault_subjects};
use saoms_lang::schema::Schema;
use serde_json::{Map, Value};

pub use self::error::InjectError;
use super::engine::{Engine, RunPhase};
use super::order::PendingOrder;
use super::shared::Shared;
use super::topics::takers::{EventMessage, RaiseError};
use crate::bus::{Bus, TopicId};
use crate::fault::TimedFault;
use crate::journal::{FROM_OUTSIDE, JournalEntry};
use crate::network;
use crate::observe::{Notification, Occurrence, SentMessage};

/// The number of the sender of messages from outside.
pub(in crate::schedule) const OUTSIDE: u32 = u32::MAX;
/// The name of that sender, which no component can have.
pub(super) const OUTSIDE_NAME: &str = network::FROM_OUTSIDE;

/// True for a record of what came from outside the fleet and can happen again, by the name of its component and its id,
/// which journals of earlier versions lack.
pub fn is_from_outside(component: &str, record: Option<&str>) -> bool {
    component == OUTSIDE_NAME && record.is_none_or(|id| id == FROM_OUTSIDE)
}

/// Number of the fleet's longest periods after an injection before the run may end for want of work: a message needs
/// one period to be read, and the messages of its reader need another one.
const SETTLING: u64 = 3;

/// Number of the fleet's longest periods for which messages from outside wait for room in the queues of their readers.
const PATIENCE: u64 = 16;

/// A message for a topic of a running fleet, from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Injection {
    /// The topic, by the name that it has after renaming.
    pub topic: String,
    /// The message.
    pub content: InjectedContent,
    /// Time at which it takes effect, in the time of the run; `None` or a past time is the next instant.
    pub at: Option<Time>,
    /// Description for the journal.
    pub text: String,
}

/// The content of a message from outside, which is checked against the schema of the topic.
#[derive(Clone, Debug, PartialEq)]
pub enum InjectedContent {
    /// Its fields, as JSON.
    Fields(Value),
    /// Its CDR form (see [`saoms_api::host::cdr`]).
    Bytes(Vec<u8>),
}

/// Messages and orders that wait for their time, in the order in which they take effect: those from outside, and
/// messages that a fault holds up.
#[derive(Default)]
pub(super) struct Injections {
    waiting: BTreeMap<(u64, u64), Due>,
    count: u64,
    /// Number of those that are faults: the run does not wait for them.
    faults: usize,
    /// Number of those that are commits: [`Engine::commits_are_over`] knows whether the run waits for them.
    commits: usize,
    /// Number of holds that keep the run from ending for want of work.
    pub(super) holds: usize,
    /// Time since which messages wait for room in the queues of their readers, and until when.
    held_since: Option<u64>,
    held_until: u64,
}

enum Due {
    Message {
        topic: TopicId,
        bytes: Vec<u8>,
        key: Option<u64>,
        place: Option<(i32, i32)>,
        text: String,
    },
    /// The messages of an event.
    Event {
        messages: Vec<EventMessage>,
        text: String,
    },
    Order(Box<PendingOrder>),
    /// A fault, and its line for the journal.
    Fault(Box<TimedFault>, String),
    /// What a component kept up to a batch is committed.
    Commit {
        component: u32,
        number: u64,
    },
    /// A message that a fault holds up.
    Late {
        topic: TopicId,
        message: SharedMessage,
    },
    /// The effects of earlier injections have reached all components.
    Settled,
}

impl Injections {
    /// The faults of a run that begins.
    pub(super) fn of(faults: &[TimedFault]) -> Injections {
        let mut all = Injections::default();
        for fault in faults {
            all.add(fault.at.as_nanos(), Due::Fault(Box::new(fault.clone()), fault.call.to_string()));
        }
        all
    }

    #[inline]
    pub(super) fn earliest(&self) -> Option<u64> {
        self.waiting.first_key_value().map(|((when, _), _)| *when)
    }

    /// True if the run may end because no work is left.
    pub(super) fn are_over(&self) -> bool {
        self.holds == 0 && self.waiting.len() == self.faults + self.commits
    }

    /// True if faults are still to begin.
    pub(super) fn have_faults(&self) -> bool {
        self.faults > 0
    }

    /// Takes the commits out: components and the numbers of batches.
    pub(super) fn take_commits(&mut self) -> Vec<(u32, u64)> {
        let commits = self.waiting.extract_if(.., |_, due| matches!(due, Due::Commit { .. }));
        let commits = commits.filter_map(|(_, due)| match due {
            Due::Commit { component, number } => Some((component, number)),
            _ => None,
        });
        let commits: Vec<(u32, u64)> = commits.collect();
        self.commits -= commits.len();
        commits
    }

    pub(super) fn clear(&mut self) {
        self.waiting.clear();
        (self.faults, self.commits) = (0, 0);
    }

    pub(super) fn commit_at(&mut self, when: u64, component: u32, number: u64) {
        self.add(when, Due::Commit { component, number });
    }

    pub(super) fn hold_up(&mut self, when: u64, topic: TopicId, message: SharedMessage) {
        self.add(when, Due::Late { topic, message });
    }

    /// Whether what is due next fits into the queues of its readers; `None` if nothing is due that takes room.
    fn has_room(&self, bus: &Bus, now: u64) -> Option<bool> {
        match self.waiting.first_key_value().filter(|((when, _), _)| *when <= now)?.1 {
            Due::Message { topic, .. } => Some(bus.has_room(*topic)),
            Due::Event { messages, .. } => {
                let mut topics = messages.iter().filter_map(|message| bus.find(&message.topic));
                Some(topics.all(|topic| bus.has_room(topic)))
            }
            Due::Commit { .. } => None,
            _ => Some(true),
        }
    }

    /// Lets what is due wait until then, in its order, with the messages and events that are due meanwhile. Commits
    /// have an order of their own, in which what waits for them leaves the program, and take no room.
    fn postpone(&mut self, now: u64, until: u64) {
        let later = self.waiting.split_off(&(until.saturating_add(1), 0));
        for ((when, number), due) in std::mem::replace(&mut self.waiting, later) {
            let is_held = match due {
                Due::Commit { .. } => false,
                Due::Message { .. } | Due::Event { .. } => true,
                // What was held before stays in its order.
                _ => when <= now || when == self.held_until || when == until,
            };
            if is_held {
                self.count += 1;
                self.waiting.insert((until, self.count), due);
            } else {
                self.waiting.insert((when, number), due);
            }
        }
        self.held_until = until;
    }

    fn add(&mut self, when: u64, due: Due) {
        // It comes after those that came before it.
        let is_held = self.held_since.is_some() && matches!(due, Due::Message { .. } | Due::Event { .. });
        let when = if is_held { when.max(self.held_until) } else { when };
        self.count += 1;
        self.faults += usize::from(matches!(due, Due::Fault(..)));
        self.commits += usize::from(matches!(due, Due::Commit { .. }));
        self.waiting.insert((when, self.count), due);
    }
}

/// Checks a message from outside and queues it.
pub(super) fn inject(shared: &Shared, injection: Injection) -> Result<(), InjectError> {
    let Injection { topic, content, at, text } = injection;
    let (id, schema) = {
        let engine = shared.lock();
        if engine.is_closed() {
            return Err(InjectError::Ending);
        }
        let id = engine.topic(&topic)?;
        (id, engine.bus.schema(id).to_owned())
    };
    let refused = |message: &str, error: String| InjectError::Content {
        topic: topic.clone(),
        message: message.to_owned(),
        error,
    };
    let schema = Schema::parse(&schema).map_err(|error| refused("", error.to_string()))?;
    let bytes = match content {
        InjectedContent::Fields(fields) => {
            schema.encode(&fields).map_err(|error| refused(schema.name(), error.to_string()))?
        }
        InjectedContent::Bytes(bytes) => {
            schema.check(&bytes).map_err(|error| refused(schema.name(), error.to_string()))?;
            bytes
        }
    };
    let speakers = shared.speakers();
    if speakers.are_named_on(&topic) {
        let message = schema.decode(&bytes).map_err(|error| refused(schema.name(), error.to_string()))?;
        if let Some(speaker) = speakers.find(&topic, &message) {
            return Err(InjectError::Speaker { topic, speaker: Box::new(speaker) });
        }
    }
    let (key, place) = (schema.key(&bytes), schema.place(&bytes));
    let is_taken = add(shared, at, Due::Message { topic: id, bytes, key, place, text });
    if is_taken { Ok(()) } else { Err(InjectError::Ending) }
}

/// Queues the messages of an event, which were checked. False if the run ends.
pub(super) fn raise(shared: &Shared, messages: Vec<EventMessage>, at: Option<Time>, text: String) -> bool {
    add(shared, at, Due::Event { messages, text })
}

/// Checks a fault and queues it. `text` is its line for the journal.
pub(super) fn add_fault(
    shared: &Shared,
    (site, call): (&str, &FaultCall),
    at: Option<Time>,
    text: String,
) -> Result<(), RaiseError> {
    let members: Vec<Arc<ComponentSpec>> = {
        let engine = shared.lock();
        if engine.is_closed() {
            return Err(RaiseError::Ending);
        }
        engine.members_everywhere().map(|(_, spec)| spec).collect()
    };
    let of_site = members.iter().map(AsRef::as_ref).filter(|spec| site.is_empty() || spec.site == site);
    fault_subjects(of_site).check(call).map_err(RaiseError::Wrong)?;
    let fault = TimedFault { at: at.unwrap_or_default(), site: site.to_owned(), call: call.clone() };
    let is_taken = add(shared, at, Due::Fault(Box::new(fault), text));
    if is_taken { Ok(()) } else { Err(RaiseError::Ending) }
}

/// Batches of components, with their numbers, are committed.
pub(super) fn add_commits(shared: &Shared, batches: &[(u32, u64)]) {
    let mut engine = shared.lock();
    if matches!(engine.phase, RunPhase::Stopping | RunPhase::Ended) {
        // What waited for it leaves the program: nothing takes effect here any more.
        let now = shared.clock.now();
        batches.iter().for_each(|(component, number)| engine.commit(*component, *number, now));
        return shared.release(engine);
    }
    // All of them while the run goes on: at its end, those that wait are committed at once. With a number of 0 it is
    // nothing that somebody waits for.
    let now = shared.clock.now();
    for (component, number) in batches.iter().filter(|(_, number)| *number > 0) {
        engine.add_due(now, None, Due::Commit { component: *component, number: *number });
    }
    shared.release(engine);
}

/// Queues what was checked. False if the run has begun to end since: nobody would hear of it.
fn add(shared: &Shared, at: Option<Time>, due: Due) -> bool {
    let mut engine = shared.lock();
    let is_taken = !engine.is_closed();
    if is_taken {
        engine.add_due(shared.clock.now(), at, due);
    }
    shared.release(engine);
    is_taken
}

impl Engine {
    /// True if the run ends, so that nothing that comes from outside takes effect, nor is kept for the next program.
    pub(super) fn is_closed(&self) -> bool {
        matches!(self.phase, RunPhase::Stopping | RunPhase::Ended) && !self.memory.is_open()
    }

    /// Queues an order, which was checked.
    pub(super) fn add_order(&mut self, now: u64, at: Option<Time>, order: PendingOrder) {
        self.add_due(now, at, Due::Order(Box::new(order)));
    }

    fn add_due(&mut self, now: u64, at: Option<Time>, due: Due) {
        let when = at.map_or(0, Time::as_nanos).max(self.next_instant(now));
        if !matches!(due, Due::Commit { .. }) {
            self.note_difference(now);
        }
        self.injections.add(when, due);
        self.look_at = self.look_at.min(when);
        self.wake |= when < self.roles.asleep_until;
    }

    /// Publishes the messages that are due.
    #[cold]
    pub(super) fn deliver_injections(&mut self, now: u64) {
        let (mut delivered, mut are_held) = (false, None);
        self.standstill.note_effect(now);
        loop {
            if let Some(has_room) = self.injections.has_room(&self.bus, now) {
                are_held = Some(!has_room && self.hold_injections(now));
                if are_held == Some(true) {
                    // Commits are due still.
                    continue;
                }
                if has_room {
                    self.injections.held_since = None;
                }
            }
            let Some(entry) = self.injections.waiting.first_entry().filter(|entry| entry.key().0 <= now) else { break };
            let when = entry.key().0;
            match entry.remove() {
                Due::Message { topic, bytes, key, place, text } => {
                    // In real time the timer may be late; the message has the time at which it was due.
                    let cause = self.record_outside(when, OUTSIDE_NAME, text);
                    let outside = Arc::from(OUTSIDE_NAME);
                    self.deliver_injection((when, &outside), cause, topic, (bytes, key, place), None);
                    delivered = true;
                }
                Due::Event { messages, text } => {
                    self.deliver_event(when, messages, text);
                    delivered = true;
                }
                Due::Order(pending) => {
                    self.carry_out(when, *pending);
                    delivered = true;
                    if self.has_orders() {
                        // A component carries it out before what comes after it.
                        break;
                    }
                }
                Due::Fault(fault, text) => {
                    self.injections.faults -= 1;
                    let cause = self.record_outside(when, OUTSIDE_NAME, text);
                    self.begin_fault((&fault.call, cause), &fault.site, when);
                }
                Due::Late { topic, message } => {
                    self.arrive(topic, message, now);
                    // It has to be read before the run ends.
                    delivered |= self.injections.are_over();
                }
                Due::Commit { component, number } => {
                    self.injections.commits -= 1;
                    self.commit(component, number, now);
                    self.end_if_done(now);
                }
                Due::Settled => self.end_if_done(now),
            }
        }
        if are_held == Some(false) {
            self.injections.held_since = None;
        }
        if delivered {
            self.settle(now);
        }
    }

    /// Lets messages from outside that find no room in the queues of their readers wait for the next execution. False
    /// if they have waited for long: their readers do not read.
    #[cold]
    fn hold_injections(&mut self, now: u64) -> bool {
        let since = *self.injections.held_since.get_or_insert(now);
        let next = self.queue.earliest().filter(|_| now - since <= self.longest_period().saturating_mul(PATIENCE));
        let Some(next) = next else { return false };
        let until = next.max(now).saturating_add(1);
        self.injections.postpone(now, until);
        self.look_at = self.look_at.min(until);
        true
    }

    fn longest_period(&self) -> u64 {
        let members = self.slots.iter().filter(|slot| slot.is_member());
        members.map(|slot| slot.policy.period).max().unwrap_or(0)
    }

    /// The next instant at which something from outside can take effect. At the same time as executions that are over,
    /// it would come before them when it is played again.
    pub(super) fn next_instant(&self, now: u64) -> u64 {
        if self.begun == now && !self.real { now.saturating_add(1) } else { now }
    }

    /// Keeps the run from ending for want of work until the effects of an event have reached all components.
    #[cold]
    pub(in crate::schedule) fn settle(&mut self, now: u64) {
        let settled = now.saturating_add(self.longest_period().saturating_mul(SETTLING));
        self.injections.add(settled, Due::Settled);
        self.look_at = self.look_at.min(settled);
    }

    fn deliver_event(&mut self, time: u64, messages: Vec<EventMessage>, text: String) {
        let cause = self.record_outside(time, OUTSIDE_NAME, text.clone());
        let outside = Arc::from(OUTSIDE_NAME);
        let mut is_heard = false;
        for EventMessage { topic, to, bytes, marks } in messages {
            // A component that is not scheduled reads no topic.
            let Some(topic) = self.bus.find(&topic) else { continue };
            is_heard = true;
            self.deliver_injection((time, &outside), cause, topic, (bytes, marks.0, marks.1), to);
        }
        if !is_heard {
            let text = format!("the event `{text}` has no receiver: no component that takes it is scheduled");
            self.note(time, Occurrence::Note { level: Level::Warning, text });
        }
    }

    /// Sends a message that no component of the fleet sends. Other programs receive it as one of `by`.
    pub(super) fn deliver_injection(
        &mut self,
        (time, by): (u64, &Arc<str>),
        cause: Cause,
        topic: TopicId,
        (bytes, key, place): (Vec<u8>, Option<u64>, Option<(i32, i32)>),
        to: Option<u32>,
    ) {
        let name = Arc::clone(self.bus.name(topic));
        let header = Header { sender: OUTSIDE, sent: Time::from_nanos(time), cause };
        let message = SharedMessage::from_bytes(header, None, bytes).of(key, place).only_to(to);
        if let Some(trace) = &mut self.trace {
            trace.message(time, OUTSIDE, self.bus.name_hash(topic), &message);
        }
        if let Some(observers) = self.bus.observers(topic) {
            let component = Arc::from(OUTSIDE_NAME);
            let sent = SentMessage { topic: name, component, message: message.clone(), is_of_other: false };
            self.notifications.push(Notification::Sent(sent, Arc::clone(observers)));
        }
        self.put_on_networks(by, topic, &message, time);
        self.send(topic, message, time);
    }

    /// Writes an event to the journal, as the root of what follows from it.
    pub(super) fn record_outside(&mut self, time: u64, by: &str, text: String) -> Cause {
        self.record_notice(time, by, (FROM_OUTSIDE, text, Map::new()), Cause::default())
    }

    /// Writes a symptom that no component wrote to the journal: with its id, its text and its values, and what it
    /// follows from.
    pub(super) fn record_notice(
        &mut self,
        time: u64,
        by: &str,
        what: (&'static str, String, Map<String, Value>),
        cause: Cause,
    ) -> Cause {
        // Components draw the numbers of their records from the same counter.
        let id = Cause(self.record_ids.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1);
        let entry = JournalEntry::from_outside(id, Time::from_nanos(time), by, what, cause);
        if let Some(records) = &self.records {
            records.put_outside(entry.clone());
        }
        self.outside.push(entry, self.journal_capacity);
        id
    }
}
