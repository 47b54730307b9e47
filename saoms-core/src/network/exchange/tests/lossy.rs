//! A network in virtual time.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use saoms_api::host::cdr;

use crate::network::exchange::{Action, Destination, Exchange, News, OwnMessage, Settings};

pub(super) const MILLISECOND: u64 = 1_000_000;

/// What the network does to what it carries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weather {
    /// Percent that it loses.
    pub(super) loss: u32,
    /// Percent that it carries twice.
    pub(super) repeats: u32,
    /// Greatest delay in milliseconds.
    pub(super) jitter: u64,
}

impl Weather {
    pub(super) fn calm() -> Weather {
        Weather { loss: 0, repeats: 0, jitter: 0 }
    }
}

/// A message that reached a program.
#[derive(Clone, Debug)]
pub(super) struct Delivered {
    pub(super) sender: usize,
    pub(super) reader: usize,
    pub(super) topic: Arc<str>,
    pub(super) key: Option<u64>,
    pub(super) number: u64,
}

pub(super) struct Program {
    pub(super) exchange: Exchange,
    pub(super) is_stopped: bool,
    component: Arc<str>,
    sent: BTreeMap<String, u64>,
    told: Vec<String>,
}

type Packet = (usize, Destination, Arc<[u8]>, Option<Arc<[u8]>>);

pub(super) struct Lossy {
    pub(super) programs: Vec<Program>,
    pub(super) delivered: Vec<Delivered>,
    pub(super) is_cut: bool,
    states: BTreeMap<(usize, Option<u64>), u64>,
    weather: Weather,
    chance: u64,
    now: u64,
    count: u64,
    flying: BTreeMap<(u64, u64), Packet>,
}

impl Lossy {
    pub(super) fn new(programs: usize, weather: Weather, seed: u64) -> Lossy {
        let mut network = Lossy {
            programs: Vec::new(),
            delivered: Vec::new(),
            is_cut: false,
            states: BTreeMap::new(),
            weather,
            chance: seed | 1,
            now: 0,
            count: 0,
            flying: BTreeMap::new(),
        };
        (0..programs).for_each(|_| network.join());
        network
    }

    /// From now on the network does this.
    pub(super) fn change(&mut self, weather: Weather) {
        self.weather = weather;
    }

    /// Another program joins.
    pub(super) fn join(&mut self) {
        self.join_with(&format!("Robot{}", self.programs.len()), 0);
    }

    /// Another program joins, with this component, and this schema of events.
    pub(super) fn join_with(&mut self, component: &str, schema: u64) {
        let number = self.programs.len();
        let mut exchange = Exchange::new(Settings {
            program: number as u64,
            name: number.to_string(),
            patience: 1_000 * MILLISECOND,
            limit: 256 << 10,
            components: BTreeSet::from([component.to_owned()]),
            others: BTreeSet::new(),
        });
        exchange.read(&Arc::from("EVENTS"), false, schema);
        exchange.read(&Arc::from("STATES"), true, 0);
        self.programs.push(Program {
            exchange,
            is_stopped: false,
            component: Arc::from(component),
            sent: BTreeMap::new(),
            told: Vec::new(),
        });
    }

    /// A program sends an event.
    pub(super) fn send(&mut self, program: usize, topic: &str) {
        self.say(program, topic, false, None);
    }

    /// A program puts a state.
    pub(super) fn put(&mut self, program: usize, topic: &str, key: u64) {
        let number = self.say(program, topic, true, Some(key));
        self.states.insert((program, Some(key)), number);
    }

    /// Number of the messages that a program has sent on a topic.
    pub(super) fn sent(&self, program: usize, topic: &str) -> u64 {
        self.programs[program].sent.get(topic).copied().unwrap_or_default()
    }

    /// The last message of each program and key.
    pub(super) fn newest_states(&self) -> BTreeMap<(usize, Option<u64>), u64> {
        self.states.clone()
    }

    /// What a program was told.
    pub(super) fn told(&self, program: usize) -> Vec<String> {
        self.programs[program].told.clone()
    }

    fn say(&mut self, program: usize, topic: &str, is_state: bool, key: Option<u64>) -> u64 {
        let sender = &mut self.programs[program];
        let number = sender.sent.entry(topic.to_owned()).or_default();
        *number += 1;
        let number = *number;
        sender.exchange.send(OwnMessage {
            topic: &Arc::from(topic),
            is_state,
            component: &Arc::clone(&sender.component),
            to: None,
            key,
            sent: self.now,
            schema: 0,
            cause: 0,
            bytes: &number.to_le_bytes(),
        });
        self.carry_out(program);
        number
    }

    /// A program leaves.
    pub(super) fn leave(&mut self, program: usize) {
        self.programs[program].exchange.leave();
        self.carry_out(program);
    }

    /// Lets time pass.
    pub(super) fn run(&mut self, time: u64) {
        let end = self.now + time;
        loop {
            for program in 0..self.programs.len() {
                if !self.programs[program].is_stopped {
                    self.programs[program].exchange.tick(self.now);
                    self.carry_out(program);
                }
            }
            while let Some(entry) = self.flying.first_entry().filter(|entry| entry.key().0 <= self.now) {
                let packet = entry.remove();
                self.arrive(&packet);
            }
            if self.now >= end {
                return;
            }
            self.now = (self.now + 5 * MILLISECOND).min(end);
        }
    }

    fn random(&mut self, below: u64) -> u64 {
        self.chance ^= self.chance << 13;
        self.chance ^= self.chance >> 7;
        self.chance ^= self.chance << 17;
        self.chance % below.max(1)
    }

    fn carry_out(&mut self, program: usize) {
        for action in self.programs[program].exchange.take_actions() {
            match action {
                Action::Put { to, bytes } => self.carry((program, to, bytes, None)),
                Action::Send { to, frame } => {
                    let (bytes, envelope) = frame.encode();
                    self.carry((program, to, bytes, Some(envelope)));
                }
                Action::Deliver { program: sender, topic, arrived } => {
                    let number = u64::from_le_bytes(arrived.bytes.try_into().unwrap());
                    let (sender, reader) = (sender as usize, program);
                    self.delivered.push(Delivered { sender, reader, topic, key: arrived.key, number });
                }
                Action::Tell(news) => {
                    let line = match news {
                        News::Joined { program, .. } => format!("Joined {program}"),
                        News::Left { program, .. } => format!("Left {program}"),
                        News::Unreachable { program, .. } => format!("Unreachable {program}"),
                        News::Back { program, .. } => format!("Back {program}"),
                        News::GivenUp { program, .. } => format!("GivenUp {program}"),
                        News::Lost { program, topic, count, .. } => format!("Lost {program} {topic} {count}"),
                        News::Unreceived { name, topic, count } => format!("Unreceived {name} {topic} {count}"),
                        News::Twice { component, program, .. } => format!("Twice {component} {program}"),
                        News::Anew { component, program, after, .. } => format!("Anew {component} {program} {after}"),
                        News::Differs { program, topic, .. } => format!("Differs {program} {topic}"),
                        News::Overflow { topic, count } => format!("Overflow {topic} {count}"),
                    };
                    self.programs[program].told.push(line);
                }
            }
        }
    }

    fn carry(&mut self, packet: Packet) {
        let repeats = self.random(100) < u64::from(self.weather.repeats);
        for _ in 0..1 + u64::from(repeats) {
            if self.is_cut || self.random(100) < u64::from(self.weather.loss) {
                continue;
            }
            let at = self.now + self.random(self.weather.jitter + 1) * MILLISECOND;
            self.count += 1;
            self.flying.insert((at, self.count), packet.clone());
        }
    }

    fn arrive(&mut self, packet: &Packet) {
        let (sender, to, bytes, envelope) = packet;
        for reader in 0..self.programs.len() {
            if reader == *sender || self.programs[reader].is_stopped {
                continue;
            }
            let (exchange, now) = (&mut self.programs[reader].exchange, self.now);
            let is_mine = |program: &u64| *program == reader as u64;
            match to {
                Destination::Topic(topic, _) => exchange.receive(topic, bytes, envelope.as_ref().unwrap(), now),
                Destination::Again(program, topic) if is_mine(program) => {
                    exchange.receive(topic, bytes, envelope.as_ref().unwrap(), now);
                }
                Destination::Alive(_) => exchange.hear(&cdr::decode(bytes).unwrap(), now),
                Destination::Ask(program) if is_mine(program) => exchange.answer(&cdr::decode(bytes).unwrap()),
                Destination::Covered(program) if is_mine(program) => exchange.cover(&cdr::decode(bytes).unwrap(), now),
                _ => {}
            }
            self.carry_out(reader);
        }
    }
}
