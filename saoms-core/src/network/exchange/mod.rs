//! The exchange of messages between the programs of a network, as a state machine without clock, thread and network.
//!
//! Each program numbers its messages on each topic, keeps them until all programs that read the topic have received
//! them, and sends them again to who asks. A sign of life, now and then, says how far it has sent and received. So a
//! transport may lose, repeat and reorder what it carries, in both directions.
//!
//! - A reader receives the events of a topic from the moment on in which their sender has heard of it: the sender says
//!   where it begins (*welcome*). It receives them once, and in the order of their sending.
//! - Of a state topic a reader receives the newest message of each component and key, at first all that there are; of
//!   one whose messages have a place those of the cells that it wants, and what left them.
//! - What is kept is bounded. Beyond the bound, programs that are away are given up first; then events are lost, and
//!   both ends say so.
//! - A [call] of a component of another program runs at most once.

mod action;
mod again;
mod around;
pub mod call;
mod cells;
mod ending;
mod frame;
mod hear;
mod incoming;
mod limit;
mod look;
mod memory;
mod outgoing;
mod owners;
mod peer;
#[cfg(test)]
mod tests;
pub mod wire;

use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};
use std::sync::Arc;

use saoms_api::host::cdr;

pub use self::action::{Action, Destination, Keys, News, OwnMessage, Settings};
use self::again::note_missing;
use self::call::Line;
use self::frame::ArrivedFrame;
pub use self::frame::Frame;
pub use self::incoming::Arrived;
use self::look::WantedCells;
use self::memory::Past;
pub use self::memory::{Delivered, KeptEvent, KnownReader, Memory, Remembered};
use self::outgoing::{Outgoing, Sent};
use self::owners::{Begun, Owner};
use self::peer::Peer;
use self::wire::{Alive, Vote};
use crate::bus::cell_of;

/// Nanoseconds of a millisecond.
const MILLISECOND: u64 = 1_000_000;
/// Least and greatest time between two signs of life while there is something to say: four in a period of the program.
const BUSY_INTERVAL: [u64; 2] = [100 * MILLISECOND, 250 * MILLISECOND];
/// Time for which a message may be late before it is asked for.
const LATENESS: u64 = 20 * MILLISECOND;
/// Longest time between two requests for the same messages.
const LONGEST_WAIT: u64 = 1_000 * MILLISECOND;

/// A topic that components of this program read.
#[derive(Clone, Debug)]
struct OwnTopic {
    is_state: bool,
    schema: u64,
    /// Of a state topic, the cells that are read, if not all of it is.
    cells: Option<WantedCells>,
}

/// One program on a network.
#[derive(Debug)]
pub struct Exchange {
    settings: Settings,
    outgoing: BTreeMap<Arc<str>, Outgoing>,
    /// The topics that components of this program read.
    reads: BTreeMap<Arc<str>, OwnTopic>,
    peers: BTreeMap<u64, Peer>,
    /// Programs that have left: what of them is still on its way is of no use.
    left: BTreeSet<u64>,
    /// What was received of programs that may start again, by their first starts.
    past: BTreeMap<u64, Past>,
    /// How far earlier starts of this program had received events, by the first starts of those that sent them.
    received_before: BTreeMap<u64, BTreeMap<Arc<str>, u64>>,
    /// The program that each component runs in, and how many of its messages were delivered.
    owners: HashMap<String, Owner>,
    /// Whether this program sees work left.
    vote: Vote,
    /// True if a program that has left had seen that all work is done.
    was_done: bool,
    /// The names of programs that were never heard, and without which no work is done.
    unheard: BTreeSet<String>,
    /// The present time, and the time at which the exchange began.
    now: u64,
    begun: u64,
    /// The number of the last sign of life.
    sign: u64,
    /// When the next sign of life is due.
    sign_at: u64,
    /// True if there is something to say since the last sign of life.
    has_news: bool,
    /// The calls of this program, by their lines.
    lines: BTreeMap<u64, Line>,
    /// When something is due for them.
    calls_at: u64,
    /// The number of the last look at cells, and when cells are due that nobody wants any more.
    looks: u64,
    drop_at: u64,
    /// The components with which other programs have begun, or are about to.
    begun_with: BTreeMap<u64, Begun>,
    /// True if it was told that a component of this program runs in one that began later.
    is_superseded: bool,
    /// The numbers of events that were lost for want of room, and were not told yet.
    overflow: BTreeMap<Arc<str>, u64>,
    /// The numbers of the newest signs of life, each with its time.
    signs: VecDeque<(u64, u64)>,
    actions: Vec<Action>,
}

impl Exchange {
    /// A program that joins a network.
    pub fn new(settings: Settings) -> Exchange {
        let memory = settings.memory.clone();
        let mut exchange = Exchange {
            unheard: settings.others.clone(),
            settings,
            outgoing: BTreeMap::new(),
            reads: BTreeMap::new(),
            peers: BTreeMap::new(),
            left: BTreeSet::new(),
            past: BTreeMap::new(),
            received_before: BTreeMap::new(),
            owners: HashMap::new(),
            vote: Vote::default(),
            was_done: false,
            now: 0,
            begun: 0,
            sign: 0,
            sign_at: 0,
            has_news: true,
            lines: BTreeMap::new(),
            calls_at: u64::MAX,
            looks: 0,
            drop_at: u64::MAX,
            begun_with: BTreeMap::new(),
            is_superseded: false,
            overflow: BTreeMap::new(),
            signs: VecDeque::new(),
            actions: Vec::new(),
        };
        if let Some(memory) = memory {
            exchange.recall(&memory);
            // It is in the exchange now.
            exchange.settings.memory = Some(Memory { origin: memory.origin, start: memory.start, ..Memory::default() });
        }
        exchange
    }

    /// Its settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What the program has to do, in this order.
    pub fn take_actions(&mut self) -> Vec<Action> {
        self.keep_within_limit();
        std::mem::take(&mut self.actions)
    }

    /// Components of this program read a topic from now on.
    pub fn read(&mut self, topic: &Arc<str>, is_state: bool, schema: u64) {
        if let Some(own) = self.reads.get_mut(topic) {
            (own.is_state, own.schema) = (is_state, schema);
            return;
        }
        self.reads.insert(Arc::clone(topic), OwnTopic { is_state, schema, cells: None });
        let both = [Keys::All, Keys::Again].map(|keys| Action::Subscribe(keys(Arc::clone(topic))));
        self.actions.extend(both);
        self.say_soon();
    }

    /// A component sends a message.
    pub fn send(&mut self, message: OwnMessage<'_>) {
        let OwnMessage { topic, is_state, component, to, key, sent, schema, cause, place, number, bytes } = message;
        if !self.outgoing.contains_key(topic) {
            self.outgoing.insert(Arc::clone(topic), Outgoing::new(is_state));
            // Readers that were heard before read it from its first message on.
            self.say_soon();
        }
        let Some(outgoing) = self.outgoing.get_mut(topic) else { return };
        let (component, bytes) = (Arc::clone(component), bytes.into());
        let number = number.map_or(outgoing.last + 1, |number| number.max(outgoing.last + 1));
        if number > outgoing.last + 1 {
            // Those before it found no room on their way here, which was told.
            let count = outgoing.skip_before(number);
            *self.overflow.entry(Arc::clone(topic)).or_default() += count;
        }
        let cells = outgoing.place(&(Arc::clone(&component), key), place.map(cell_of));
        let sent = Sent { number, component, to, key, sent, schema, cause, bytes, cells };
        if is_state || self.peers.values().any(|peer| peer.needs(topic).is_some()) {
            outgoing.keep(sent.clone());
        } else {
            outgoing.last = sent.number;
        }
        let to = |cell| Destination::Topic(Arc::clone(topic), Arc::clone(&sent.component), cell);
        let left = sent.cells.iter().find(|cell| cell.has_left).map(|left| to(Some((left.x, left.y))));
        let to = to(sent.cell());
        if let Some(left) = left {
            self.put_message(left, is_state, sent.clone());
        }
        self.put_message(to, is_state, sent);
        self.has_news = true;
    }

    /// So many events of a topic found no room on their way here, which was told, after all that were sent before:
    /// their readers learn it. The last one has this number in the state folder. Without a number they learn it once
    /// they have received what was sent before: it is on its way, or may have to be sent again.
    pub fn skip(&mut self, topic: &Arc<str>, count: u64, last: Option<u64>) {
        let outgoing = self.outgoing.entry(Arc::clone(topic)).or_insert_with(|| Outgoing::new(false));
        let Some(last) = last else {
            outgoing.owed = outgoing.owed.saturating_add(count);
            return self.forget_received();
        };
        if last > outgoing.last {
            let count = outgoing.skip_before(last + 1);
            *self.overflow.entry(Arc::clone(topic)).or_default() += count;
            self.say_soon();
        }
    }

    /// Puts a message on the network: with the one before, if both are events of one component.
    fn put_message(&mut self, to: Destination, is_state: bool, sent: Sent) {
        let last = self.actions.last_mut().filter(|_| !is_state);
        let sent = match last {
            Some(Action::Send { to: before, frame }) if *before == to => match frame.add(sent) {
                Ok(()) => return,
                Err(sent) => sent,
            },
            _ => sent,
        };
        let frame = Frame::new(self.settings.program, sent);
        self.actions.push(Action::Send { to, frame });
    }

    /// Messages of a component of another program arrived, with their envelope. True if some before them are missing,
    /// and are to be asked for.
    pub fn receive(&mut self, topic: &str, bytes: &[u8], envelope: &[u8], now: u64) -> bool {
        self.pass(now);
        let Some((topic, own)) = self.reads.get_key_value(topic) else { return false };
        let topic = Arc::clone(topic);
        let Some(ArrivedFrame { program, schema, messages, cells }) = ArrivedFrame::decode(bytes, envelope) else {
            return false;
        };
        // One that was never heard is heard soon, and its messages are sent again.
        let Some(peer) = self.peers.get_mut(&program) else { return false };
        let incoming = peer.incoming.entry(Arc::clone(&topic)).or_default();
        if !cells.is_empty() && incoming.around.is_none() {
            incoming.is_by_cells = true;
            incoming.around = own.cells.as_ref().map(look::read);
        }
        if schema != own.schema
            && let Some((_, Arrived { component, .. })) = messages.first()
            && peer.differing.insert(Arc::clone(&topic))
        {
            let (name, component, topic) = (Arc::clone(&peer.name), Arc::clone(component), Arc::clone(&topic));
            self.actions.push(Action::Tell(News::Differs { program, name, component, topic }));
        }
        let mut ready = Vec::with_capacity(messages.len());
        for (number, arrived) in messages {
            match own.is_state {
                true => ready.extend(incoming.take_state(number, arrived, &cells)),
                false => incoming.take_event(number, arrived, &mut ready),
            }
        }
        note_missing(incoming, now);
        let mut is_missing = incoming.ask_at.is_some();
        if let Some(around) = &mut incoming.around {
            around.settle(now);
            is_missing |= around.look_at.is_some();
        }
        self.has_news = true;
        self.deliver(program, &topic, ready);
        is_missing
    }

    /// Does what is due. Gives the time at which something is due next.
    pub fn tick(&mut self, now: u64) -> u64 {
        self.pass(now);
        self.miss(now);
        self.drop_cells(now);
        let next = self.ask(now).min(self.look(now)).min(self.drop_at);
        if now >= self.sign_at {
            self.tell_overflow();
            self.remember();
            let alive = self.sign_of_life(false);
            self.put_alive(&alive);
            let quiet = self.settings.patience / 4;
            let is_busy = std::mem::take(&mut self.has_news) || !self.is_complete();
            let [least, most] = BUSY_INTERVAL;
            self.sign_at =
                now + if is_busy { quiet.min((self.settings.patience / 12).clamp(least, most)) } else { quiet };
        }
        self.pursue_calls();
        next.min(self.sign_at).min(self.calls_at)
    }

    /// Bytes of messages that are kept for other programs.
    pub fn kept_bytes(&self) -> usize {
        self.outgoing.values().map(|outgoing| outgoing.size).sum()
    }

    /// The program was held up for so long, and has not heard what others said meanwhile: they are not missed for that.
    pub fn hold_up(&mut self, time: u64, now: u64) {
        self.pass(now);
        self.peers.values_mut().for_each(|peer| peer.heard = (peer.heard + time).min(now));
    }

    /// The other programs that are known, with their names, whether they are heard or not.
    pub fn others(&self) -> impl Iterator<Item = (u64, &Arc<str>)> {
        self.peers.iter().map(|(program, peer)| (*program, &peer.name))
    }

    /// True if no other program was ever heard.
    pub fn has_met_nobody(&self) -> bool {
        self.left.is_empty() && self.peers.values().all(|peer| peer.is_recalled)
    }

    /// True if other programs are known, and none of them gives a sign of life.
    pub fn hears_nobody(&self) -> bool {
        let mut heard = self.peers.values().filter(|peer| !peer.is_recalled && !peer.is_over).peekable();
        heard.peek().is_some() && heard.all(|peer| !peer.is_reachable)
    }

    /// Notes the present time.
    fn pass(&mut self, now: u64) {
        if self.now == 0 {
            self.begun = now;
            // Who is known from an earlier start has its time from now on.
            self.peers.values_mut().for_each(|peer| (peer.since, peer.heard) = (now, now));
        }
        self.now = self.now.max(now);
    }

    /// True if a sign of life is due at once.
    pub fn has_to_speak(&self) -> bool {
        self.sign_at == 0
    }

    fn say_soon(&mut self) {
        (self.has_news, self.sign_at) = (true, 0);
    }

    /// Delivers messages that are for the fleet; a sender keeps nothing for those that are not.
    fn deliver(&mut self, program: u64, topic: &Arc<str>, ready: Vec<Arrived>) {
        let origin = self.peers.get(&program).map_or(program, |peer| peer.origin);
        for mut arrived in ready {
            arrived.origin = origin;
            let differs = self.peers.get(&program).is_some_and(|peer| peer.differing.contains(topic));
            if !differs && self.is_of(program, &arrived.component) {
                self.actions.push(Action::Deliver { program, topic: Arc::clone(topic), arrived });
            }
        }
    }

    fn name_of(&self, program: u64) -> Arc<str> {
        self.peers.get(&program).map_or_else(|| "".into(), |peer| Arc::clone(&peer.name))
    }

    /// Programs that give no sign of life are missed.
    fn miss(&mut self, now: u64) {
        let mut missed = Vec::new();
        for (program, peer) in &mut self.peers {
            if peer.is_reachable && now.saturating_sub(peer.heard) > peer.patience {
                peer.is_reachable = false;
                missed.push(*program);
                // Calls may be for another one of its name.
                self.calls_at = 0;
                let of_program = self.owners.iter().filter(|(_, owner)| owner.program == *program);
                let mut components: Vec<Arc<str>> =
                    of_program.map(|(component, _)| component.as_str().into()).collect();
                components.sort_unstable();
                let news = News::Unreachable { program: *program, name: Arc::clone(&peer.name), components };
                self.actions.push(Action::Tell(news));
            }
        }
        if !missed.is_empty() {
            self.settle_owners(&missed);
        }
    }

    fn put_alive(&mut self, alive: &Alive) {
        let bytes = cdr::encode(alive).into();
        let to = if alive.leaves { Destination::Leaves } else { Destination::Alive };
        self.actions.push(Action::Put { to: to(self.settings.program), bytes });
    }
}
