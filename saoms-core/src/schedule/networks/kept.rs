//! Events that outlive the program: with a state folder, those that components of a network send are there before they
//! leave, until all that read them have received them.

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use saoms_api::Message;
use saoms_api::host::{SharedMessage, TopicKind, cdr};

use super::{NO_NETWORK, NetworkedFleet};
use crate::bus::TopicId;
use crate::network::FromRun;
use crate::network::exchange::{KeptEvent, KnownReader, Memory, Remembered};
use crate::schedule::component::part::Part;
use crate::schedule::engine::Engine;
use crate::schedule::engine::commit::Commits;
use crate::store::{Batch, Change};

/// In place of the number of a component: what no component keeps.
pub(in crate::schedule) const NOBODY: u32 = u32::MAX;

/// What stands in the state folder in place of the path of a component, before the url of a network; paths have no line
/// breaks.
const STARTS: &str = "(starts)\n";
const EVENTS: &str = "(events)\n";

/// The url of the network that an entry of the state folder is of, if it is of one.
pub(in crate::schedule) fn url_of(entry: &str) -> Option<&str> {
    let rest = entry.strip_prefix(STARTS).or_else(|| entry.strip_prefix(EVENTS))?;
    rest.split('\n').next()
}

/// The starts with a state folder, as it knows them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Starts")]
struct Starts {
    origin: u64,
    last: u64,
}

/// The events of this program in the state folder.
#[derive(Debug, Default)]
pub(in crate::schedule) struct KeptEvents {
    /// The last numbers that were found there, by networks and topics.
    found: HashMap<(u8, Arc<str>), u64>,
    topics: HashMap<(u8, TopicId), KeptTopic>,
    /// Events that no component sent and that are not committed.
    outside: VecDeque<Outside>,
}

/// The events of a topic.
#[derive(Debug)]
struct KeptTopic {
    /// What stands in the state folder in place of the path of a component.
    entry: Arc<str>,
    /// The number of the last event that was accepted, and of the last one that left. They leave in the order in which
    /// they were accepted, since the state folder commits in this order.
    accepted: u64,
    left: u64,
}

/// An event that no component sent.
#[derive(Debug)]
struct Outside {
    batch: u64,
    network: u8,
    topic: TopicId,
    message: FromRun,
}

impl KeptEvents {
    /// The number of an event that leaves.
    pub(super) fn leaves(&mut self, network: u8, topic: TopicId) -> Option<u64> {
        let topic = self.topics.get_mut(&(network, topic)).filter(|topic| topic.left < topic.accepted)?;
        topic.left += 1;
        Some(topic.left)
    }

    /// Nothing is committed any more.
    pub(in crate::schedule) fn fail(&mut self) {
        self.topics.values_mut().for_each(|topic| topic.accepted = topic.left);
    }

    /// Drops what waits for later batches than this one. Gives the number of messages.
    pub(in crate::schedule) fn drop_outside(&mut self, batch: u64) -> usize {
        let before = self.outside.len();
        self.outside.retain(|outside| outside.batch <= batch);
        before - self.outside.len()
    }
}

impl Engine {
    fn keeps_events(&self) -> bool {
        matches!(&self.commits, Commits::InStore(queue) if !queue.has_failed())
    }

    /// The events that an execution sends over a network, for the state folder.
    #[inline]
    pub(in crate::schedule) fn events_to_keep(&mut self, part: &Part) -> Vec<Change> {
        let network = self.slots[part.index as usize].network;
        if network == NO_NETWORK
            || self.networks.is_foreign(network)
            || !self.keeps_events()
            || self.memory.is_over(self.phase)
        {
            return Vec::new();
        }
        let outbox = part.outbox.iter().filter(|(topic, _)| self.bus.kind(*topic) == TopicKind::Event);
        let events: Vec<&(TopicId, SharedMessage)> = outbox.collect();
        events.into_iter().map(|(topic, message)| self.event_to_keep(network, &part.name, *topic, message)).collect()
    }

    fn event_to_keep(&mut self, network: u8, component: &Arc<str>, topic: TopicId, message: &SharedMessage) -> Change {
        let to = message.to().and_then(|to| self.name_of(to));
        let sent = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        let (schema, message) = self.as_on_network(topic, message);
        let event = KeptEvent {
            component: component.to_string(),
            to: to.map(|to| to.to_string()).unwrap_or_default(),
            sent: u64::try_from(sent).unwrap_or(u64::MAX),
            schema,
            cause: message.header().cause.0,
            bytes: message.bytes().to_vec(),
        };
        let (name, url) = (Arc::clone(self.bus.name(topic)), self.networks.url(network));
        let kept = &mut self.networks.kept;
        let known = kept.topics.entry((network, topic)).or_insert_with(|| {
            let found = kept.found.get(&(network, Arc::clone(&name))).copied().unwrap_or_default();
            KeptTopic { entry: entry(&url, &name), accepted: found, left: found }
        });
        known.accepted += 1;
        let bytes = Some(cdr::encode(&event).into());
        Change { component: Arc::clone(&known.entry), key: known.accepted, bytes }
    }

    /// Leaves a message for a network that no component sent; an event once it is in the state folder, if there is one.
    pub(super) fn put_outside(
        &mut self,
        network: u8,
        by: &Arc<str>,
        topic: TopicId,
        message: &SharedMessage,
        now: u64,
    ) {
        if self.memory.is_over(self.phase) {
            // The fleet goes on from before that.
            return;
        }
        let is_kept = self.bus.kind(topic) == TopicKind::Event && !self.networks.is_foreign(network);
        if !is_kept || !self.keeps_events() {
            return self.put_on_network(network, by, topic, message, now);
        }
        let change = self.event_to_keep(network, by, topic, message);
        let message = self.for_network(by, topic, message, Some(change.key));
        self.batches += 1;
        let batch = self.batches;
        self.hand_over(NOBODY, batch, vec![change], now);
        self.uncommitted += 1;
        self.networks.kept.outside.push_back(Outside { batch, network, topic, message });
    }

    /// What no component sent is committed up to this batch. True if there was something.
    pub(in crate::schedule) fn commit_outside(&mut self, batch: u64) -> bool {
        let kept = &mut self.networks.kept;
        let mut has_events = false;
        while let Some(first) = kept.outside.pop_front_if(|first| first.batch <= batch) {
            let Outside { network, topic, message, .. } = first;
            kept.leaves(network, topic);
            self.uncommitted -= 1;
            self.networks.waiting.push((network, message));
            has_events = true;
        }
        has_events
    }
}

fn entry(url: &str, topic: &str) -> Arc<str> {
    format!("{EVENTS}{url}\n{topic}").into()
}

impl NetworkedFleet {
    /// What the state folder has of earlier starts of this program, whose number is `program`; `None` without one.
    /// What it has is taken once.
    pub fn recall(&self, program: u64) -> Option<Memory> {
        let mut engine = self.shared.lock();
        let Commits::InStore(queue) = &engine.commits else { return None };
        let (queue, network) = (Arc::clone(queue), u8::try_from(self.network).unwrap_or(NO_NETWORK));
        let url = engine.networks.url(network);
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        let own: Arc<str> = format!("{STARTS}{url}").into();
        let mut memory = Memory { origin: program, ..Memory::default() };
        let found = engine.found.of(&own).cloned().unwrap_or_default();
        for (key, bytes) in &found {
            if *key != 0 {
                memory.readers.extend(cdr::decode::<KnownReader>(bytes));
            } else if let Ok(starts) = cdr::decode::<Starts>(bytes) {
                (memory.origin, memory.start) = (starts.origin, starts.last);
            }
        }
        // A folder that was restored does not begin a second time with the same number.
        memory.start = (memory.start + 1).max(u64::try_from(now).unwrap_or(u64::MAX));
        let prefix = entry(&url, "");
        let topics = engine.found.components().filter(|entry| entry.starts_with(&*prefix));
        for entry in topics.cloned().collect::<Vec<_>>() {
            let topic: Arc<str> = entry[prefix.len()..].into();
            let events = engine.found.of(&entry).into_iter().flatten();
            let events = events.filter_map(|(number, bytes)| Some((*number, cdr::decode(bytes).ok()?)));
            let events: std::collections::BTreeMap<u64, KeptEvent> = events.collect();
            let last = events.last_key_value().map_or(0, |(number, _)| *number);
            engine.networks.kept.found.insert((network, Arc::clone(&topic)), last);
            memory.events.insert(topic, events);
            engine.found.forget(&entry);
        }
        memory.received = engine.recall_received(&url);
        engine.found.forget(&own);
        let starts = Starts { origin: memory.origin, last: memory.start };
        let change = Change { component: own, key: 0, bytes: Some(cdr::encode(&starts).into()) };
        queue.put(Batch { index: NOBODY, number: 0, changes: vec![change], later: None });
        self.shared.release(engine);
        Some(memory)
    }

    /// Changes what the state folder has of this program's part of the network.
    pub(super) fn change_memory(&self, changes: Vec<Remembered>) {
        let engine = self.shared.lock();
        let Commits::InStore(queue) = &engine.commits else { return };
        let queue = Arc::clone(queue);
        let url = engine.networks.url(u8::try_from(self.network).unwrap_or(NO_NETWORK));
        self.shared.release(engine);
        let own: Arc<str> = format!("{STARTS}{url}").into();
        let mut all = Vec::new();
        for change in changes {
            match change {
                Remembered::Forget { topic, first, end } => {
                    let entry = entry(&url, &topic);
                    let forget = |key| Change { component: Arc::clone(&entry), key, bytes: None };
                    all.extend((first..end).map(forget));
                }
                Remembered::Reader(reader) => {
                    let bytes = Some(cdr::encode(&reader).into());
                    all.push(Change { component: Arc::clone(&own), key: reader.program, bytes });
                }
                Remembered::NoReader { program } => {
                    all.push(Change { component: Arc::clone(&own), key: program, bytes: None });
                }
            }
        }
        if !queue.has_failed() {
            queue.put(Batch { index: NOBODY, number: 0, changes: all, later: None });
        }
    }
}
