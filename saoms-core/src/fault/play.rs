//! The faults that have begun, and what they do to messages.

use std::time::Duration;

use saoms_api::event::fault::{FAULTS, FaultCall, FaultKind, Rate};
use saoms_api::{Cause, Chance};

use super::flight::Flights;
use super::named::Named;
use super::tasks::{TaskFault, TaskFaults};
use crate::bus::TopicId;
use crate::hash::fold;

/// The least time after which a message that was lost is sent again, in nanoseconds; otherwise it is the round trip of
/// its link.
const ROUND_TRIP: u64 = 1_000_000;
/// The greatest number of times that a message is sent.
const MOST_TRIES: u32 = 10_000;

/// The state of the faults of a run.
#[derive(Debug, Default)]
pub(crate) struct FaultPlay {
    seed: u64,
    /// Number of faults that have begun.
    begun: u64,
    messages: Vec<MessageFault>,
    tasks: TaskFaults,
    flights: Flights,
    /// How often each kind was applied.
    counts: [u64; FAULTS.len()],
}

/// A fault of messages that has begun.
#[derive(Debug)]
struct MessageFault {
    kind: FaultKind,
    until: u64,
    chance: Chance,
    site: String,
    topic: Named,
    from: Named,
    to: Named,
    /// True if it acts between nodes alone.
    is_between_nodes: bool,
}

/// A component at an end of a link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End<'e> {
    pub(crate) number: u32,
    pub(crate) path: &'e str,
    pub(crate) site: &'e str,
    /// Empty in a fleet without nodes.
    pub(crate) node: &'e str,
}

/// A message on a link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnLink<'e> {
    /// The topic and its name, and the copy that the reader reads.
    pub(crate) topic: (TopicId, &'e str),
    pub(crate) link: TopicId,
    pub(crate) is_event: bool,
    pub(crate) from: End<'e>,
    pub(crate) to: End<'e>,
}

/// The arrival of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Arrival {
    pub(crate) at: u64,
    /// True if it arrives later, and [says so](FaultPlay::arrive).
    pub(crate) is_on_its_way: bool,
}

impl MessageFault {
    fn is_on(&mut self, (topic, name): (TopicId, &str)) -> bool {
        self.topic.has_topic(topic, name)
    }

    /// True if it concerns a reader of a topic.
    fn concerns_reader(&mut self, topic: (TopicId, &str), reader: End<'_>) -> bool {
        self.is_on(topic)
            && (self.site.is_empty() || self.site == reader.site)
            && (self.to.has_end(reader) || self.kind == FaultKind::Part && self.from.has_end(reader))
    }

    fn concerns(&mut self, message: &OnLink<'_>) -> bool {
        let OnLink { topic, from, to, .. } = *message;
        if !self.concerns_reader(topic, to) || !(self.site.is_empty() || self.site == from.site) {
            return false;
        }
        if self.is_between_nodes && from.node == to.node {
            return false;
        }
        let is_this_way = self.from.has_end(from) && self.to.has_end(to);
        is_this_way || self.kind == FaultKind::Part && self.to.has_end(from) && self.from.has_end(to)
    }

    fn draws(&mut self, rate: Rate) -> bool {
        self.chance.below(u64::from(Rate::ALL.per_million())) < u64::from(rate.per_million())
    }

    /// The time that it adds to the way of a message.
    fn latency(&mut self) -> u64 {
        match self.kind {
            FaultKind::Delay(least, most) => self.chance.range(nanos(least)..=nanos(most)),
            FaultKind::Jitter(most) => self.chance.range(0..=nanos(most)),
            _ => 0,
        }
    }

    /// True if a message is lost that is sent at this time, until it is sent again.
    fn loses(&mut self, at: u64) -> bool {
        match self.kind {
            _ if at >= self.until => false,
            FaultKind::Lose(rate) => self.draws(rate),
            FaultKind::Cut | FaultKind::Part => true,
            _ => false,
        }
    }

    /// True if nothing gets through before it ends.
    fn is_total(&self) -> bool {
        matches!(self.kind, FaultKind::Cut | FaultKind::Part | FaultKind::Lose(Rate::ALL))
    }
}

impl FaultPlay {
    pub(crate) fn new(seed: u64) -> FaultPlay {
        FaultPlay { seed, ..FaultPlay::default() }
    }

    /// True until the first fault begins.
    #[inline]
    pub(crate) fn is_quiet(&self) -> bool {
        self.begun == 0
    }

    /// Begins a fault of messages.
    pub(crate) fn begin_messages(&mut self, call: &FaultCall, site: &str, now: u64) {
        let chance = self.next_chance(call, now);
        self.messages.retain(|fault| fault.until > now);
        self.messages.push(MessageFault {
            kind: call.kind,
            until: end(call, now),
            chance,
            site: site.to_owned(),
            topic: Named::by(&call.topic),
            from: Named::by(&call.from),
            to: Named::by(&call.to),
            is_between_nodes: call.names_nodes(),
        });
    }

    /// Begins a fault of components, which the journal has as the record `cause`.
    pub(crate) fn begin_tasks(
        &mut self,
        (call, cause): (&FaultCall, Cause),
        components: impl Iterator<Item = u32>,
        now: u64,
    ) {
        self.begun += 1;
        for component in components {
            let fault = match call.kind {
                FaultKind::Stall => TaskFault::Stall(call.lasting.unwrap_or_default()),
                FaultKind::Fail => TaskFault::Fail,
                FaultKind::Crash { restart } => TaskFault::Crash { restart },
                FaultKind::Drift(by) => {
                    self.tasks.drift(component, by, end(call, now));
                    self.count(call.kind);
                    continue;
                }
                _ => continue,
            };
            self.tasks.add(component, fault, cause);
        }
    }

    /// The record of the fault of a component's last execution; none without a fault.
    pub(crate) fn cause(&self, component: u32) -> Cause {
        self.tasks.cause(component)
    }

    /// Chance that depends on the seed, the fault and its time, so that it is the same without the other faults.
    fn next_chance(&mut self, call: &FaultCall, now: u64) -> Chance {
        self.begun += 1;
        let text = call.to_string();
        Chance::new(text.bytes().fold(fold(self.seed, now), |hash, byte| fold(hash, u64::from(byte))))
    }

    fn count(&mut self, kind: FaultKind) {
        self.counts[kind.place()] += 1;
    }

    /// How often each kind was applied that was, by its word.
    pub(crate) fn counts(&self) -> impl Iterator<Item = (&'static str, u64)> {
        FAULTS.into_iter().zip(self.counts).filter(|(_, count)| *count > 0)
    }

    /// True if a reader of a topic needs a link.
    pub(crate) fn concerns_reader(&mut self, topic: (TopicId, &str), reader: End<'_>) -> bool {
        self.messages.iter_mut().any(|fault| fault.concerns_reader(topic, reader))
    }

    /// The fault of an execution of a component that begins.
    pub(crate) fn take_of_execution(&mut self, component: u32) -> Option<TaskFault> {
        let fault = self.tasks.take(component)?;
        self.count(match fault {
            TaskFault::Stall(_) => FaultKind::Stall,
            TaskFault::Fail => FaultKind::Fail,
            TaskFault::Crash { restart } => FaultKind::Crash { restart },
        });
        Some(fault)
    }

    /// A time of a component's own clock, on that of the run.
    pub(crate) fn on_run(&mut self, component: u32, time: u64, now: u64) -> u64 {
        self.tasks.on_run(component, time, now)
    }

    /// How often and when a message arrives that is sent now: not at all, once or twice.
    pub(crate) fn arrivals(&mut self, message: &OnLink<'_>, now: u64) -> Vec<Arrival> {
        let concerned = self.messages.iter_mut().enumerate().filter(|(_, fault)| now < fault.until);
        let all: Vec<usize> = concerned.filter_map(|(place, fault)| fault.concerns(message).then_some(place)).collect();
        let Some((latency, sent)) = self.sent(&all, message.is_event, now) else { return Vec::new() };
        let mut arrivals = Vec::with_capacity(1);
        let arrival = sent.saturating_add(latency);
        let overtaken = self.applied(&all, |fault| match fault.kind {
            FaultKind::Reorder(rate, by) => fault.draws(rate).then(|| fault.chance.range(1..=nanos(by).max(1))),
            _ => None,
        });
        arrivals.push(match overtaken {
            Some(by) => arrival.saturating_add(by),
            None => self.flights.in_order(message.link, message.from.number, arrival),
        });
        let is_doubled = self.applied(&all, |fault| match fault.kind {
            FaultKind::Duplicate(rate) => fault.draws(rate).then_some(()),
            _ => None,
        });
        if is_doubled.is_some() {
            let second = sent.saturating_add(self.latency(&all));
            arrivals.push(self.flights.in_order(message.link, message.from.number, second));
        }
        let (link, sender) = (message.link, message.from.number);
        let mut arrive = |at: u64| {
            // Behind one that is on its way, it is on its way, too.
            let is_on_its_way = at > now || self.flights.are_open(link, sender);
            if is_on_its_way {
                self.flights.depart(link, sender);
            }
            Arrival { at: at.max(now), is_on_its_way }
        };
        arrivals.into_iter().map(&mut arrive).collect()
    }

    /// Notes that a message on its way has arrived.
    pub(crate) fn arrive(&mut self, link: TopicId, sender: u32) {
        self.flights.arrive(link, sender);
    }

    /// The latency of a message, and the time at which it is sent so that it is not lost; `None` if it is lost for
    /// good.
    fn sent(&mut self, concerned: &[usize], is_event: bool, now: u64) -> Option<(u64, u64)> {
        let is_violated = self.applied(concerned, |fault| match fault.kind {
            FaultKind::Violate(rate) => fault.draws(rate).then_some(()),
            _ => None,
        });
        if is_violated.is_some() {
            return None;
        }
        let latency = self.latency(concerned);
        let round_trip = latency.saturating_mul(2).max(ROUND_TRIP);
        let mut at = now;
        for _ in 0..MOST_TRIES {
            let lost = self
                .applied(concerned, |fault| fault.loses(at).then(|| if fault.is_total() { fault.until } else { at }));
            match lost {
                None => break,
                Some(_) if !is_event => return None,
                Some(u64::MAX) => return None,
                Some(until) => at = until.saturating_add(round_trip),
            }
        }
        Some((latency, at))
    }

    fn latency(&mut self, concerned: &[usize]) -> u64 {
        let mut all = 0_u64;
        for place in concerned {
            let fault = &mut self.messages[*place];
            let latency = fault.latency();
            if latency > 0 {
                let kind = fault.kind;
                self.count(kind);
                all = all.saturating_add(latency);
            }
        }
        all
    }

    /// The first effect of these faults, which is counted.
    fn applied<T>(&mut self, concerned: &[usize], mut effect: impl FnMut(&mut MessageFault) -> Option<T>) -> Option<T> {
        for place in concerned {
            let fault = &mut self.messages[*place];
            let kind = fault.kind;
            if let Some(found) = effect(fault) {
                self.count(kind);
                return Some(found);
            }
        }
        None
    }
}

/// The time at which a fault that begins now is over.
fn end(call: &FaultCall, now: u64) -> u64 {
    call.lasting.map_or(u64::MAX, |time| now.saturating_add(nanos(time)))
}

fn nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
