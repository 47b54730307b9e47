//! Samples of the fleet for observers: what all components say of themselves, now and then. A run is the same without:
//! where code fails that says it, that is told, and nothing comes of it.
//!
//! A sample is taken between executions. In virtual time it is taken before time goes on to a later one than that at
//! which it is due, so that no instant is added to the run: nothing happens in between. Where virtual time passes in
//! step with a clock, something from outside may: there, a sample waits for its time as in real time.

use std::sync::Arc;

use saoms_api::host::SharedMessage;
use saoms_api::{Failure, Level, Time};

use super::slot::NEVER;
use super::{Engine, Next};
use crate::bus::TopicId;
use crate::observe::{FleetSample, Notification, Observers, Occurrence, SampleRate, SentMessage, StateOfTopic};
use crate::report::Sections;
use crate::schedule::component::library::with_library;
use crate::schedule::inject::OUTSIDE_NAME;
use crate::schedule::settings::nanos;
use crate::status::ComponentStatus;

/// Time for which components that run on threads of their own may take to answer.
const PATIENCE: u64 = 50_000_000;

/// When samples are taken.
#[derive(Debug)]
pub(crate) struct Sampling {
    rates: Vec<Pace>,
    /// Time of the next one; `NEVER` where nobody wants any.
    next: u64,
    /// Time of the one that is taken.
    time: u64,
    /// The topics of which samples have what they retain.
    states: WantedStates,
    /// While components are asked for one, the time until which answers are waited for.
    asks_until: Option<u64>,
    /// True while that of the end is due.
    is_last: bool,
}

/// The state topics that observers want, looked up once for each change of the topics in use.
#[derive(Debug, Default)]
struct WantedStates {
    /// The number of that change.
    change: Option<u64>,
    all: Vec<WantedState>,
}

#[derive(Debug)]
struct WantedState {
    id: TopicId,
    topic: Arc<str>,
    message: Arc<str>,
    schema: Arc<str>,
}

/// A rate, with what was sampled at it.
#[derive(Debug)]
struct Pace {
    every: u64,
    next: u64,
    /// Samples until the time between two doubles, and then.
    left: Option<u32>,
    half: u32,
}

impl Default for Sampling {
    fn default() -> Sampling {
        Sampling {
            rates: Vec::new(),
            next: NEVER,
            time: 0,
            states: WantedStates::default(),
            asks_until: None,
            is_last: false,
        }
    }
}

impl Sampling {
    /// The samples that observers want.
    pub(crate) fn of(rates: impl Iterator<Item = SampleRate>) -> Sampling {
        let pace = |SampleRate { every, most }: SampleRate| Pace {
            every: nanos(every).max(1),
            next: 0,
            left: most.map(|most| most.max(2)),
            half: most.map_or(0, |most| most.max(2) / 2),
        };
        let rates: Vec<Pace> = rates.map(pace).collect();
        let next = if rates.is_empty() { NEVER } else { 0 };
        Sampling { rates, next, ..Sampling::default() }
    }

    /// The run ends.
    pub(super) fn end(&mut self) {
        self.asks_until = None;
        self.is_last = !self.rates.is_empty();
    }

    /// True while the sample of the end is due.
    pub(super) fn is_last_due(&self) -> bool {
        self.is_last
    }

    /// A sample is taken, of all times before this one. Those that follow are at multiples of the time between two.
    fn taken(&mut self, until: u64) {
        for pace in self.rates.iter_mut().filter(|pace| pace.next < until) {
            if let Some(left) = &mut pace.left {
                *left -= 1;
                if *left == 0 {
                    (pace.every, *left) = (pace.every.saturating_mul(2), pace.half);
                }
            }
            pace.next = until.div_ceil(pace.every).saturating_mul(pace.every);
        }
        self.next = self.rates.iter().map(|pace| pace.next).min().unwrap_or(NEVER);
    }
}

impl Engine {
    /// The next action where nothing is due before a time: a sample, or to wait.
    #[inline]
    pub(super) fn sample_or_wait(&mut self, now: u64, until: u64) -> Option<Next> {
        let Sampling { next, asks_until, .. } = self.sampling;
        // Where virtual time stands still for good, nothing is sampled any more.
        let waits = self.real || self.pace.is_some() && until != NEVER;
        // Not beyond a time at which somebody outside may act.
        let ahead = (!waits && until != NEVER).then(|| until.min(self.pause).min(self.hold));
        let is_due = ahead.map_or(waits && now >= next, |ahead| ahead > next);
        match (asks_until, is_due) {
            (None, false) => Some(Next::Wait(if waits { until.min(next) } else { until })),
            _ => self.sample_next(now, until, is_due.then_some(ahead)),
        }
    }

    /// The next action for a sample; `None` where components are asked first. `due` is `None` where it is not due any
    /// more, and else the time before which nothing happens, if nobody waits for the time of the sample.
    #[cold]
    fn sample_next(&mut self, now: u64, until: u64, due: Option<Option<u64>>) -> Option<Next> {
        match (self.sampling.asks_until, due) {
            (None, _) => {
                self.sampling.asks_until = Some(now.saturating_add(PATIENCE));
                self.slots.iter_mut().for_each(|slot| slot.sampled = None);
                self.ask_all_for_sample();
                None
            }
            (Some(patience), _) if self.real && now < patience && !self.are_answered() => {
                Some(Next::Wait(until.min(patience)))
            }
            (Some(_), None) => {
                // While components were asked, something came from outside that happens before.
                self.sampling.asks_until = None;
                None
            }
            (Some(_), Some(ahead)) => {
                self.sampling.time = if ahead.is_some() { now.max(self.sampling.next) } else { now };
                self.sampling.taken(ahead.unwrap_or(now.saturating_add(1)));
                Some(Next::Sample)
            }
        }
    }

    /// The next action for the sample of the end: components are asked before they shut down.
    pub(super) fn next_for_last_sample(&mut self) -> Next {
        if self.sampling.asks_until.is_none() {
            self.sampling.asks_until = Some(NEVER);
            self.slots.iter_mut().for_each(|slot| slot.sampled = None);
            self.ask_all_for_sample();
        }
        self.next_question().unwrap_or(Next::Sample)
    }

    /// Notes how a component is that has answered, for the sample that is due.
    pub(super) fn note_sampled(&mut self, index: u32, now: u64) {
        if self.sampling.asks_until.is_some() {
            let status = self.component_status(&self.slots[index as usize], now);
            self.slots[index as usize].sampled = Some(Box::new(status));
        }
    }

    /// Notes that a component had no answer for a sample: what it said before has to do.
    #[cold]
    pub(super) fn note_unsampled(&mut self, index: u32, failure: &Failure, now: u64) {
        self.questions.note_incomplete();
        if !std::mem::replace(&mut self.slots[index as usize].is_unsampled, true) {
            let failure = with_library(&self.slots[index as usize].spec, failure);
            let text = format!("its `status` fails, so that what it said before is shown: {failure}");
            self.emit(now, index, Occurrence::Note { level: Level::Warning, text });
        }
    }

    /// Looks up the topics of which samples have what they retain, if others are in use than before.
    fn look_up_states(&mut self, observers: &Observers) {
        let change = Some(self.bus.changes());
        if self.sampling.states.change == change {
            return;
        }
        let topics = self.bus.topics().filter(|id| self.bus.kind(*id).name() == "state");
        let wanted = topics.filter(|id| observers.want_state(self.bus.message(*id))).map(|id| WantedState {
            id,
            topic: self.bus.name(id).clone(),
            message: self.bus.message(id).into(),
            schema: self.bus.schema(id).into(),
        });
        self.sampling.states = WantedStates { change, all: wanted.collect() };
    }

    /// Takes a sample for the observers.
    pub(crate) fn sample(&mut self, observers: &Observers, sections: &Sections) {
        self.sampling.asks_until = None;
        let is_last = std::mem::take(&mut self.sampling.is_last);
        let now = if is_last { self.ended.0 } else { self.sampling.time };
        self.look_up_states(observers);
        let states = self.sampling.states.all.iter().map(|wanted| StateOfTopic {
            topic: Arc::clone(&wanted.topic),
            message: Arc::clone(&wanted.message),
            schema: Arc::clone(&wanted.schema),
            retained: self.retained(wanted.id),
        });
        let states = states.collect();
        let members = self.slots.iter_mut().filter(|slot| slot.is_member());
        let sampled: Vec<_> = members.map(|slot| slot.sampled.take()).collect();
        let others = self.slots.iter().filter(|slot| slot.is_member());
        let components = sampled.into_iter().zip(others);
        let components = components.map(|(sampled, slot)| match sampled {
            Some(status) => *status,
            None => self.component_status(slot, now),
        });
        let components: Vec<ComponentStatus> = components.collect();
        self.note_wanted(observers, &components);
        let status = self.status_with(sections, now, components);
        let sample = FleetSample { time: Time::from_nanos(now), status, states, is_last };
        self.notifications.push(Notification::Sample(Box::new(sample)));
    }

    /// Notes who has to be asked for further samples, of those who have said something for the first time, or whom
    /// nobody wanted and somebody else has asked since.
    fn note_wanted(&mut self, observers: &Observers, components: &[ComponentStatus]) {
        let members = self.slots.iter_mut().filter(|slot| slot.is_member()).zip(components);
        for (slot, status) in members.filter(|(slot, status)| slot.is_wanted != Some(true) && !status.values.is_empty())
        {
            let said = slot.described.as_ref().map(|one| one.at);
            // What it said before it had other values says nothing of what it says now.
            if slot.judged_by != said {
                slot.is_wanted = Some(observers.want_status(status));
                slot.judged_by = said;
            }
        }
    }

    /// The messages that a state topic retains, the oldest first.
    pub(in crate::schedule) fn retained(&self, topic: TopicId) -> Vec<SentMessage> {
        let name = self.bus.name(topic);
        let sent = |message: SharedMessage| {
            let sender = message.header().sender;
            let component = self.name_of(sender).unwrap_or_else(|| OUTSIDE_NAME.into());
            let is_of_other = self.slots.get(sender as usize).is_none();
            SentMessage { topic: name.clone(), component, message, is_of_other }
        };
        self.bus.retained(topic).into_iter().map(sent).collect()
    }
}
