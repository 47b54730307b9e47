//! The networks that components of the fleet are on: their messages leave the program, and those of other programs come
//! to the topics of this one.

mod calls;
mod caught_up;
pub(super) mod elsewhere;
pub(super) mod kept;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use saoms_api::host::{SharedMessage, TopicKind};
use saoms_api::{Header, Level, Time};
use saoms_lang::assembly::ComponentSpec;
use saoms_lang::schema::Schema;
use serde_json::Value;

use super::engine::ending::EndCause;
use super::engine::{Engine, RunPhase};
use super::handle::Handle;
use super::inject::{OUTSIDE, OUTSIDE_NAME};
use super::shared::Shared;
use crate::bus::TopicId;
use crate::hash::text_hash;
use crate::network::control::{ControlRequest, Reply};
use crate::network::exchange::wire::{Request, Vote};
use crate::network::exchange::{Arrived, Remembered};
use crate::network::{Fleet, FromRun, Port, TopicFleet, Undelivered};
use crate::observe::{Notification, SentMessage};
pub(super) use calls::interface_hash;
use caught_up::Mark;
use elsewhere::Elsewhere;
use kept::KeptEvents;

/// The network of a component that is on none.
pub(super) const NO_NETWORK: u8 = u8::MAX;

/// The networks of a run.
#[derive(Debug, Default)]
pub(super) struct Networks {
    /// By their numbers: the url, and where messages for it are left.
    all: Vec<(String, Arc<Port>)>,
    /// Of each, whether all its programs agree that no work is left.
    are_done: Vec<bool>,
    /// Of each, whether it has topics of programs that do not speak our language.
    are_foreign: Vec<bool>,
    /// Of each, the number of messages that were lost, and what was told of the first.
    lost: Vec<(u64, String)>,
    /// What is left there just before the engine is unlocked.
    pub(super) waiting: Vec<(u8, FromRun)>,
    /// The networks of the components that use each topic.
    topics: HashMap<TopicId, Vec<u8>>,
    pub(super) elsewhere: Elsewhere,
    /// Wall clock of the start of the run, in nanoseconds since 1970: times are since then on a network.
    epoch: i64,
    pub(super) kept: KeptEvents,
    /// Of networks, what components have to do until others hear that it was received.
    marks: HashMap<usize, Mark>,
    /// The schemas of topics, by the numbers of these.
    schemas: HashMap<TopicId, (u64, Option<Arc<Schema>>)>,
}

impl Networks {
    /// The number of the network of a component.
    pub(super) fn of(&self, spec: &ComponentSpec) -> u8 {
        let place = spec.url().and_then(|url| self.all.iter().position(|(known, _)| known == url));
        place.and_then(|place| u8::try_from(place).ok()).unwrap_or(NO_NETWORK)
    }

    /// True if the program takes part in the network of this url.
    pub(super) fn has(&self, url: &str) -> bool {
        self.all.iter().any(|(known, _)| known == url)
    }

    /// The url of a network.
    pub(super) fn url(&self, network: u8) -> String {
        self.all.get(usize::from(network)).map(|(url, _)| url.clone()).unwrap_or_default()
    }

    /// True if the programs of a network do not speak our language: nobody there says what was received.
    pub(super) fn is_foreign(&self, network: u8) -> bool {
        self.are_foreign.get(usize::from(network)).is_some_and(|is_foreign| *is_foreign)
    }

    /// Where messages for a network are left.
    pub(super) fn port(&self, network: u8) -> Option<Arc<Port>> {
        self.all.get(usize::from(network)).map(|(_, port)| Arc::clone(port))
    }

    /// The url of each network, and the number of messages that were lost on it.
    pub(super) fn lost(&self) -> impl Iterator<Item = (&str, u64)> {
        self.all.iter().zip(&self.lost).map(|((url, _), (count, _))| (url.as_str(), *count))
    }

    /// Of each network on which messages were lost, how many, and what was told of the first.
    pub(super) fn losses(&self) -> impl Iterator<Item = String> {
        let lost = self.all.iter().zip(&self.lost).filter(|(_, (count, _))| *count > 0);
        lost.map(|((url, _), (count, first))| {
            let messages = if *count == 1 { "1 message was".to_owned() } else { format!("{count} messages were") };
            format!("{messages} lost on the network `{url}`: {first}")
        })
    }

    /// True if the programs of all networks agree that no work is left, also where there is no network.
    pub(super) fn are_done(&self) -> bool {
        self.are_done.iter().all(|is_done| *is_done)
    }

    /// Leaves what waits for the threads of the networks. What was left has to be [sent](Port::send) once the engine is
    /// unlocked.
    #[cold]
    pub(super) fn leave(&mut self) -> Vec<Arc<Port>> {
        let mut ports = Vec::new();
        let mut waiting = self.waiting.drain(..).peekable();
        while let Some((network, first)) = waiting.next() {
            let others = std::iter::from_fn(|| waiting.next_if(|(other, _)| *other == network));
            if let Some((_, port)) = self.all.get(usize::from(network)) {
                port.leave(std::iter::once(first).chain(others.map(|(_, from_run)| from_run)));
                if !ports.iter().any(|known| Arc::ptr_eq(known, port)) {
                    ports.push(Arc::clone(port));
                }
            }
        }
        ports
    }
}

impl Engine {
    /// Leaves a message of a component for its network.
    #[cold]
    pub(super) fn put_on_network(
        &mut self,
        network: u8,
        component: &Arc<str>,
        topic: TopicId,
        message: &SharedMessage,
        now: u64,
    ) {
        let is_event = self.bus.kind(topic) == TopicKind::Event;
        let number = if is_event { self.networks.kept.leaves(network, topic) } else { None };
        let from_run = self.for_network(component, topic, message, number);
        match number {
            // It was kept, and is committed.
            Some(_) => self.networks.waiting.push((network, from_run)),
            None => self.leave_for_network(network, from_run, now),
        }
    }

    /// A message as a network takes it.
    fn for_network(
        &mut self,
        component: &Arc<str>,
        topic: TopicId,
        message: &SharedMessage,
        number: Option<u64>,
    ) -> FromRun {
        let to = message.to().and_then(|to| self.name_of(to));
        let (schema, message) = self.as_on_network(topic, message);
        let is_state = self.bus.kind(topic) == TopicKind::State;
        let (topic, component) = (Arc::clone(self.bus.name(topic)), Arc::clone(component));
        FromRun::Message { topic, component, to, is_state, schema, number, message }
    }

    /// The hash of the schema of a topic, and a message of it as it is on a network.
    fn as_on_network(&mut self, topic: TopicId, message: &SharedMessage) -> (u64, SharedMessage) {
        let epoch = self.networks.epoch;
        let (schema, known) = self.schema_of(topic);
        (*schema, dated(message, known.as_deref(), epoch))
    }

    /// Leaves a message for all networks of the components that use its topic: one that comes from outside, or that
    /// tells of a component.
    pub(super) fn put_on_networks(&mut self, component: &Arc<str>, topic: TopicId, message: &SharedMessage, now: u64) {
        for network in self.networks.topics.get(&topic).cloned().unwrap_or_default() {
            self.put_outside(network, component, topic, message, now);
        }
    }

    /// A component of a network uses a topic.
    pub(super) fn use_on_network(&mut self, network: u8, topic: TopicId) {
        let networks = self.networks.topics.entry(topic).or_default();
        if !networks.contains(&network) {
            networks.push(network);
        }
    }

    /// A component of a network publishes a topic.
    pub(super) fn publish_on_network(&mut self, network: u8, topic: TopicId) {
        self.use_on_network(network, topic);
        if self.networks.is_foreign(network) {
            let topic = Arc::clone(self.bus.name(topic));
            self.networks.waiting.push((network, FromRun::Publishes { topic }));
        }
    }

    /// A component of a network reads a topic.
    pub(super) fn read_from_network(&mut self, network: u8, topic: TopicId) {
        self.use_on_network(network, topic);
        let (schema, has_place) = {
            let (hash, schema) = self.schema_of(topic);
            (*hash, schema.as_ref().is_some_and(|schema| schema.has_place()))
        };
        let (name, is_state) = (Arc::clone(self.bus.name(topic)), self.bus.kind(topic) == TopicKind::State);
        self.networks.waiting.push((network, FromRun::Reads { topic: name, is_state, schema }));
        if is_state && has_place {
            self.bus.note_interest(topic);
            self.tell_interest(topic);
        }
    }

    /// Tells the networks of a topic which of its cells are read here, if that has changed.
    #[inline]
    pub(super) fn tell_interest(&mut self, topic: TopicId) {
        if let Some(cells) = self.bus.changed_interest(topic) {
            for network in self.networks.topics.get(&topic).into_iter().flatten() {
                let (topic, cells) = (Arc::clone(self.bus.name(topic)), cells.clone());
                self.networks.waiting.push((*network, FromRun::Wants { topic, cells }));
            }
        }
    }

    /// Takes messages of other programs on a topic, as many as find room.
    fn deliver_from_network(&mut self, network: usize, topic: &Arc<str>, waiting: &mut VecDeque<Arrived>, now: u64) {
        let found = match self.phase {
            // Its components are about to be there.
            RunPhase::Starting => return,
            RunPhase::Running => self.bus.find(topic),
            RunPhase::Stopping | RunPhase::Ended => None,
        };
        let Some((topic, schema)) = found.and_then(|topic| Some((topic, self.schema_of(topic).1.clone()?))) else {
            return waiting.clear();
        };
        while self.bus.has_room(topic)
            && let Some(mut arrived) = waiting.pop_front()
        {
            if self.bus.kind(topic) == TopicKind::Event && !self.networks.are_foreign[network] {
                self.note_received(network, topic, (arrived.origin, arrived.number), now);
            }
            let to = (!arrived.to.is_empty()).then(|| self.numbers.get(arrived.to.as_str()).copied());
            // One that is for a component of another program, or that is no message of the topic, is nothing here.
            if to == Some(None) || schema.check(&arrived.bytes).is_err() {
                continue;
            }
            if schema.move_times(&mut arrived.bytes, self.networks.epoch.saturating_neg()).is_err() {
                continue;
            }
            let sender = match arrived.component.starts_with(OUTSIDE_NAME) {
                true => OUTSIDE,
                false => self.networks.elsewhere.hear(&arrived.component),
            };
            let cause = self.networks.elsewhere.cause(sender, arrived.cause);
            let header = Header { sender, sent: Time::from_nanos(now), cause };
            let (key, place) = (schema.key(&arrived.bytes), schema.place(&arrived.bytes));
            let message = SharedMessage::from_bytes(header, None, arrived.bytes).of(key, place).only_to(to.flatten());
            self.standstill.note_effect(now);
            if let Some(observers) = self.bus.observers(topic).cloned() {
                let (topic, component) = (Arc::clone(self.bus.name(topic)), arrived.component);
                let sent = SentMessage { topic, component, message: message.clone(), is_of_other: true };
                self.notifications.push(Notification::Sent(sent, observers));
            }
            self.send(topic, message, now);
        }
    }

    /// True if the run may end although no component votes: some are periodic, and nothing is to come from outside.
    fn has_nothing_to_wait_for(&mut self) -> bool {
        let is_periodic = self.slots.iter().any(|slot| slot.is_member() && slot.policy.periodic);
        is_periodic && self.injections.are_over() && self.commits_are_over()
    }

    /// The schema of a topic, with its hash.
    pub(super) fn schema_of(&mut self, topic: TopicId) -> &(u64, Option<Arc<Schema>>) {
        let bus = &self.bus;
        self.networks.schemas.entry(topic).or_insert_with(|| {
            let text = bus.schema(topic);
            // Two texts of one schema are one, as they are in a program.
            let canonical = serde_json::from_str::<Value>(text).map_or_else(|_| text.to_owned(), |it| it.to_string());
            (text_hash(&canonical), Schema::parse(text).ok().map(Arc::new))
        })
    }
}

impl Handle {
    /// Puts the components whose `url` is this text on a network, in the code that gets the control
    /// [before they initialize](super::RunningFleet::start_with).
    ///
    /// `hooks` are called by the thread of the network.
    pub fn use_network(&self, url: &str, port: &Arc<Port>, hooks: impl NetworkHooks) -> NetworkedFleet {
        self.join_network(url, port, hooks, false)
    }

    /// The same of a network of programs that do not speak our language.
    pub fn use_topics(&self, url: &str, port: &Arc<Port>, hooks: impl NetworkHooks) -> NetworkedFleet {
        self.join_network(url, port, hooks, true)
    }

    fn join_network(&self, url: &str, port: &Arc<Port>, hooks: impl NetworkHooks, is_foreign: bool) -> NetworkedFleet {
        let mut engine = self.shared.lock();
        let network = engine.networks.all.len();
        let date = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let date = i64::try_from(date.as_nanos()).unwrap_or(i64::MAX);
        engine.networks.epoch = date.saturating_sub_unsigned(self.shared.clock.now());
        engine.networks.all.push((url.to_owned(), Arc::clone(port)));
        // Nobody there is asked whether work is left.
        engine.networks.are_done.push(is_foreign);
        engine.networks.are_foreign.push(is_foreign);
        engine.networks.lost.push((0, String::new()));
        self.shared.release(engine);
        NetworkedFleet { shared: Arc::clone(&self.shared), network, hooks: Box::new(hooks) }
    }
}

/// A message as it leaves the program: with times since 1970, not since the start of the run.
fn dated(message: &SharedMessage, schema: Option<&Schema>, epoch: i64) -> SharedMessage {
    let Some(schema) = schema.filter(|schema| schema.has_times()) else { return message.clone() };
    let mut bytes = message.bytes().to_vec();
    match schema.move_times(&mut bytes, epoch) {
        Ok(()) => SharedMessage::from_bytes(message.header(), None, bytes).of(message.key(), message.place()),
        // It is no message of its topic, and others will say so.
        Err(_) => message.clone(),
    }
}

/// What a program does for a network beside its fleet. Nothing of it may wait.
pub trait NetworkHooks: Send + 'static {
    /// No other program of the network is heard any more.
    fn lose(&self);

    /// True if a signal has come that ends the run.
    fn is_interrupted(&self) -> bool;

    /// An operator asks something over the network.
    fn control(&self, request: ControlRequest, reply: Reply);
}

/// A running fleet as one of its networks sees it.
pub struct NetworkedFleet {
    shared: Arc<Shared>,
    network: usize,
    hooks: Box<dyn NetworkHooks>,
}

impl TopicFleet for NetworkedFleet {
    fn declared(&self, topic: &str) -> Option<(String, bool)> {
        self.shared.look(|engine| {
            let topic = engine.bus.find(topic)?;
            Some((engine.bus.schema(topic).to_owned(), engine.bus.kind(topic) == TopicKind::State))
        })
    }

    fn judge(&self, topic: &str, message: &[u8]) -> Result<(), String> {
        let mut engine = self.shared.lock();
        let schema = engine.bus.find(topic).and_then(|topic| engine.schema_of(topic).1.clone());
        self.shared.release(engine);
        let schema = schema.ok_or("the fleet does not have the topic any more")?;
        schema.check(message).map_err(|error| error.to_string())?;
        let speakers = self.shared.speakers();
        if speakers.are_named_on(topic) {
            let fields = schema.decode(message).map_err(|error| error.to_string())?;
            if let Some(speaker) = speakers.find(topic, &fields) {
                return Err(speaker.to_string());
            }
        }
        Ok(())
    }

    fn count_refused(&self, count: u64) {
        self.shared.sections().add("topics.refused", i64::try_from(count).unwrap_or(i64::MAX));
    }
}

impl Fleet for NetworkedFleet {
    fn has_started(&self) -> bool {
        self.shared.look(|engine| engine.phase != RunPhase::Starting)
    }

    fn deliver(&self, messages: &mut Undelivered) {
        if messages.is_empty() {
            return;
        }
        let shared = &self.shared;
        let mut engine = shared.lock();
        let now = shared.clock.now();
        messages.retain(|topic, waiting| {
            engine.deliver_from_network(self.network, topic, waiting, now);
            !waiting.is_empty()
        });
        shared.release(engine);
    }

    fn serve(&self, request: Request) {
        let mut engine = self.shared.lock();
        let beaten = engine.serve(u8::try_from(self.network).unwrap_or(NO_NETWORK), request, self.shared.clock.now());
        self.shared.release(engine);
        if let Some((component, period)) = beaten
            && let Err((_, failure)) = self.shared.stops.beat(&[component], period)
        {
            // Its hardware stops by itself.
            self.shared.note(Level::Error, failure.to_string());
        }
    }

    fn misses(&self, program: &str) {
        let mut engine = self.shared.lock();
        engine.stop_hardware_for(program);
        self.shared.release(engine);
    }

    fn vote(&self) -> Vote {
        let mut engine = self.shared.lock();
        let voters = engine.votes.voters;
        let vote = match voters {
            0 => Vote::Silent,
            _ if engine.sees_work() => Vote::Open,
            _ => Vote::Done,
        };
        self.shared.release(engine);
        vote
    }

    fn agree(&self, is_done: bool) {
        let mut engine = self.shared.lock();
        if let Some(known) = engine.networks.are_done.get_mut(self.network) {
            *known = is_done;
        }
        let now = self.shared.clock.now();
        if is_done && engine.votes.voters > 0 {
            engine.end_if_done(now);
        } else if is_done && engine.networks.are_done() && engine.has_nothing_to_wait_for() {
            engine.begin_stop(EndCause::Done, now);
        }
        self.shared.release(engine);
    }

    fn mark(&self) {
        self.mark();
    }

    fn has_passed_mark(&self) -> bool {
        self.has_passed_mark()
    }

    fn remember(&self, changes: Vec<Remembered>) {
        self.change_memory(changes);
    }

    fn tell(&self, level: Level, text: String) {
        self.shared.note(level, text);
    }

    fn count_lost(&self, count: u64, text: &str) {
        let mut engine = self.shared.lock();
        if let Some((lost, first)) = engine.networks.lost.get_mut(self.network) {
            if *lost == 0 {
                text.clone_into(first);
            }
            *lost += count;
        }
        self.shared.release(engine);
    }

    fn fail(&self, reason: String) {
        let mut engine = self.shared.lock();
        engine.reasons.push(reason);
        engine.begin_stop(EndCause::Failed, self.shared.clock.now());
        self.shared.release(engine);
    }

    fn is_interrupted(&self) -> bool {
        self.hooks.is_interrupted()
    }

    fn alert(&self, kind: &str, subject: &str, text: Option<String>) {
        self.shared.alert(kind, subject, text);
    }

    fn lose(&self) {
        self.hooks.lose();
    }

    fn control(&self, request: ControlRequest, reply: Reply) {
        self.hooks.control(request, reply);
    }
}
