//! What outlives the program: events that others may lack, who they are, and with whose numbers events go on.
//!
//! A program with a state folder that starts again is another program to all others, but for its events: these have the
//! numbers of its first start, its *origin*. So who reads them, and has received some, receives the others, once and in
//! order; and what it had not received itself is sent to it again.

use std::collections::BTreeMap;
use std::sync::Arc;

use saoms_api::Message;

use super::action::{Action, News};
use super::incoming::Incoming;
use super::outgoing::{Kept, Outgoing, Sent};
use super::peer::{Peer, Reading};
use super::wire::{Alive, Received, Sends};
use super::{Exchange, MILLISECOND};
use crate::network::FROM_OUTSIDE;

/// Programs that have ended and may start again whose messages are remembered, at most.
const MOST_PAST: usize = 4_096;

/// What a program knows of its earlier starts.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    /// The first start, with whose numbers its events go on.
    pub origin: u64,
    /// Greater than that of each earlier start.
    pub start: u64,
    /// The events that were accepted and may not have been received, by their topics and numbers.
    pub events: BTreeMap<Arc<str>, BTreeMap<u64, KeptEvent>>,
    /// Who reads them.
    pub readers: Vec<KnownReader>,
    /// What was received of others: the first start of the program that sent it, the topic, and the number of the first
    /// event that was not.
    pub received: Vec<(u64, Arc<str>, u64)>,
}

/// An event that outlives its program.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/KeptEvent")]
pub struct KeptEvent {
    /// The component that sent it: its path.
    pub component: String,
    /// The component that it is for; empty: all readers of the topic.
    pub to: String,
    /// Wall clock of its sending, in nanoseconds since 1970.
    pub sent: u64,
    /// The hash of the schema.
    pub schema: u64,
    /// The record of the journal with the reason; 0 is none.
    pub cause: u64,
    /// The message.
    pub bytes: Vec<u8>,
}

/// A program that reads events of this one, and what it has received of them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/KnownReader")]
pub struct KnownReader {
    /// The program.
    pub program: u64,
    /// Its first start.
    pub origin: u64,
    /// Its start.
    pub start: u64,
    /// Its name for people.
    pub name: String,
    /// Time after which it is missed, in milliseconds.
    pub patience: u64,
    /// What it has received on each topic, by the numbers of the origin of this program.
    pub received: Vec<Received>,
}

/// A change of what outlives the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remembered {
    /// All that read it have received the events of a topic from a number on, up to before another one.
    Forget {
        /// The topic.
        topic: Arc<str>,
        /// The number of the first event.
        first: u64,
        /// The number of the first event that stays.
        end: u64,
    },
    /// A program reads, or has received more.
    Reader(KnownReader),
    /// A program does not read any more.
    NoReader {
        /// The program.
        program: u64,
    },
}

/// How far the events of a program on a topic were delivered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Delivered {
    program: u64,
    topic: Arc<str>,
    next: u64,
}

impl Exchange {
    /// Knows what an earlier start knew.
    pub(super) fn recall(&mut self, memory: &Memory) {
        for (topic, events) in &memory.events {
            let mut outgoing = Outgoing::new(false);
            outgoing.stored = events.keys().next().copied().unwrap_or(1);
            for (number, event) in events {
                let KeptEvent { component, to, sent, schema, cause, bytes } = event.clone();
                let component = match component.as_str() {
                    FROM_OUTSIDE => format!("{FROM_OUTSIDE} {:x}", memory.origin).into(),
                    _ => component.into(),
                };
                let to = (!to.is_empty()).then(|| to.into());
                let bytes = bytes.into();
                outgoing.keep(Sent {
                    number: *number,
                    component,
                    to,
                    key: None,
                    sent,
                    schema,
                    cause,
                    bytes,
                    cells: Vec::new(),
                });
            }
            outgoing.before = outgoing.last;
            self.outgoing.insert(Arc::clone(topic), outgoing);
        }
        for reader in &memory.readers {
            let mut peer = Peer::new(&reader.name, 0);
            (peer.origin, peer.start) = (reader.origin, reader.start);
            (peer.patience, peer.is_reachable) = (reader.patience.saturating_mul(MILLISECOND), false);
            peer.is_recalled = true;
            for Received { topic, next, .. } in &reader.received {
                let reading = Reading { next: *next, ..Reading::default() };
                peer.reading.insert(Arc::from(topic.as_str()), reading);
            }
            peer.known = Some(reader.clone());
            self.peers.insert(reader.program, peer);
        }
        for (origin, topic, next) in &memory.received {
            self.received_before.entry(*origin).or_default().insert(Arc::clone(topic), *next);
        }
        self.forget_received();
    }

    /// Goes on behind the events of a program that an earlier start of this one had received.
    pub(super) fn go_on_reading(&mut self, alive: &Alive) {
        let Some(topics) = self.received_before.remove(&alive.origin) else { return };
        let Some(peer) = self.peers.get_mut(&alive.program) else { return };
        for (topic, next) in topics {
            // One that has not sent so much has another state than it had.
            let has_sent = |sends: &Sends| sends.topic == *topic && !sends.is_state && next <= sends.last + 1;
            if alive.sends.iter().any(has_sent) {
                peer.incoming.entry(topic).or_insert_with(|| Incoming::after(next));
            }
        }
    }

    /// A program is heard first that may go on from the state of a known one: its events go on with their numbers, and
    /// it receives what that had not; all else begins anew. False: it is older than the one that is known.
    pub(super) fn succeed(&mut self, alive: &Alive) -> bool {
        let before = self.peers.iter().find(|(_, peer)| peer.start != 0 && peer.origin == alive.origin);
        let Some((before, start)) = before.map(|(program, peer)| (*program, peer.start)) else { return true };
        if alive.start <= start {
            return false;
        }
        let Some(mut peer) = self.remove_peer(before) else { return true };
        (peer.sign, peer.since, peer.start) = (0, self.now, alive.start);
        peer.served.clear();
        peer.differing.clear();
        let outgoing = &self.outgoing;
        peer.reading.retain(|topic, _| outgoing.get(topic).is_none_or(|outgoing| !outgoing.is_state()));
        peer.reading.values_mut().for_each(|reading| reading.is_welcomed = false);
        let incoming = std::mem::take(&mut peer.incoming);
        self.past.insert(alive.origin, Past { program: before, incoming });
        self.peers.insert(alive.program, peer);
        true
    }

    /// A program of which something was received is there again.
    pub(super) fn go_on(&mut self, alive: &Alive) {
        let Some(past) = self.past.remove(&alive.origin) else { return };
        let Some(peer) = self.peers.get_mut(&alive.program) else { return };
        for owner in self.owners.values_mut().filter(|owner| owner.program == past.program) {
            (owner.program, owner.began) = (alive.program, alive.began);
        }
        for (topic, mut incoming) in past.incoming {
            if self.reads.get(&topic).is_none_or(|own| own.is_state) {
                continue;
            }
            let before = alive.sends.iter().find(|sends| sends.topic == *topic).map_or(0, |sends| sends.before);
            let is_older = incoming.next > 1 && incoming.next > before + 1;
            // What it had said that it has sent, and does not have any more.
            let count = incoming.drop_after(before);
            if count > 0 {
                let (name, topic) = (Arc::clone(&peer.name), Arc::clone(&topic));
                self.actions.push(Action::Tell(News::Lost { program: alive.program, name, topic, count }));
            }
            if !is_older {
                incoming.go_on();
                peer.incoming.insert(topic, incoming);
                continue;
            }
            // Its state is older than what was received: it was restored, or removed.
            let (name, after) = (Arc::clone(&peer.name), incoming.next - 1);
            self.actions.push(Action::Tell(News::Older { name, topic, after }));
        }
    }

    /// Remembers what was received of a program that has ended, if it may start again.
    pub(super) fn remember_past(&mut self, program: u64, peer: &mut Peer) {
        if peer.start == 0 {
            return;
        }
        if self.past.len() >= MOST_PAST {
            self.past.pop_first();
        }
        let incoming = std::mem::take(&mut peer.incoming);
        self.past.insert(peer.origin, Past { program, incoming });
    }

    /// Says what the state folder has to know from now on.
    pub(super) fn remember(&mut self) {
        if self.settings.memory.is_none() {
            return;
        }
        let mut changes = Vec::new();
        for (program, peer) in &mut self.peers {
            // A topic on which nothing was sent yet may be one of events.
            let of_events = |topic: &str| self.outgoing.get(topic).is_none_or(|outgoing| !outgoing.is_state());
            let received = peer.reading.iter().filter(|(topic, _)| of_events(topic));
            let received = received.map(|(topic, reading)| Received {
                program: *program,
                topic: topic.to_string(),
                next: reading.next,
            });
            let reader = KnownReader {
                program: *program,
                origin: peer.origin,
                start: peer.start,
                name: peer.name.to_string(),
                patience: peer.patience / MILLISECOND,
                received: received.collect(),
            };
            let reader = Some(reader).filter(|reader| !reader.received.is_empty() && !peer.is_given_up);
            if peer.known != reader {
                peer.known.clone_from(&reader);
                changes.push(match reader {
                    Some(reader) => Remembered::Reader(reader),
                    None => Remembered::NoReader { program: *program },
                });
            }
        }
        for (topic, outgoing) in &mut self.outgoing {
            let Kept::Events(events) = &outgoing.kept else { continue };
            // The last one stays: it has the number with which the next start goes on.
            let end = events.front().map_or(outgoing.last, |sent| sent.number).min(outgoing.last);
            if end > outgoing.stored {
                let first = std::mem::replace(&mut outgoing.stored, end);
                changes.push(Remembered::Forget { topic: Arc::clone(topic), first, end });
            }
        }
        if !changes.is_empty() {
            self.actions.push(Action::Remember(changes));
        }
    }

    /// How far events were delivered that others have not heard of as received. Nothing without a state folder: there,
    /// what was delivered counts as received.
    pub fn delivered(&self) -> Vec<Delivered> {
        if self.settings.memory.is_none() {
            return Vec::new();
        }
        let all = self.peers.iter().flat_map(|(program, peer)| peer.incoming.iter().map(move |one| (*program, one)));
        let events = all.filter(|(_, (topic, _))| self.reads.get(*topic).is_some_and(|own| !own.is_state));
        let open = events.filter(|(_, (_, incoming))| incoming.done < incoming.next);
        open.map(|(program, (topic, incoming))| Delivered { program, topic: Arc::clone(topic), next: incoming.next })
            .collect()
    }

    /// These were carried out: others may forget them.
    pub fn note_done(&mut self, all: Vec<Delivered>) {
        for Delivered { program, topic, next } in all {
            let incoming = self.peers.get_mut(&program).and_then(|peer| peer.incoming.get_mut(&topic));
            if let Some(incoming) = incoming {
                incoming.done = incoming.done.max(next);
                self.has_news = true;
            }
        }
    }

    /// Takes a program out of those that are known.
    pub(super) fn remove_peer(&mut self, program: u64) -> Option<Peer> {
        if self.left.len() >= MOST_PAST {
            self.left.pop_first();
        }
        self.left.insert(program);
        self.calls_at = 0;
        let peer = self.peers.remove(&program)?;
        if peer.known.is_some() {
            self.actions.push(Action::Remember(vec![Remembered::NoReader { program }]));
        }
        Some(peer)
    }
}

/// What was received of a program that may start again.
#[derive(Debug)]
pub(super) struct Past {
    program: u64,
    /// On each topic.
    incoming: BTreeMap<Arc<str>, Incoming>,
}
