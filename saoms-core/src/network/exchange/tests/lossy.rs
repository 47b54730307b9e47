//! A network in virtual time.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use saoms_api::host::cdr;

use crate::bus::cell_of;
use crate::network::exchange::call::{Outcome, OwnCall};
use crate::network::exchange::{
    Action, Destination, Exchange, KeptEvent, Keys, Memory, News, OwnMessage, Remembered, Settings,
};

pub(in crate::network::exchange) const MILLISECOND: u64 = 1_000_000;

/// What the network does to what it carries.
#[derive(Clone, Copy, Debug)]
pub(in crate::network::exchange) struct Weather {
    /// Percent that it loses.
    pub(in crate::network::exchange) loss: u32,
    /// Percent that it carries twice.
    pub(in crate::network::exchange) repeats: u32,
    /// Greatest delay in milliseconds.
    pub(in crate::network::exchange) jitter: u64,
}

impl Weather {
    pub(in crate::network::exchange) fn calm() -> Weather {
        Weather { loss: 0, repeats: 0, jitter: 0 }
    }
}

/// A message that reached a program.
#[derive(Clone, Debug)]
pub(in crate::network::exchange) struct Delivered {
    pub(in crate::network::exchange) sender: usize,
    pub(in crate::network::exchange) reader: usize,
    pub(in crate::network::exchange) topic: Arc<str>,
    pub(in crate::network::exchange) key: Option<u64>,
    pub(in crate::network::exchange) number: u64,
}

pub(in crate::network::exchange) struct Program {
    pub(in crate::network::exchange) exchange: Exchange,
    pub(in crate::network::exchange) is_stopped: bool,
    component: Arc<str>,
    name: String,
    sent: BTreeMap<String, u64>,
    told: Vec<String>,
    /// Number of the messages that it has counted as lost.
    pub(in crate::network::exchange) lost: u64,
    /// Its state folder, if it has one.
    pub(in crate::network::exchange) folder: Option<Memory>,
}

type Packet = (usize, Destination, Arc<[u8]>, Option<Arc<[u8]>>);

pub(in crate::network::exchange) struct Lossy {
    pub(in crate::network::exchange) programs: Vec<Program>,
    pub(in crate::network::exchange) delivered: Vec<Delivered>,
    pub(in crate::network::exchange) is_cut: bool,
    /// True while no program with a state folder carries out what it receives.
    pub(in crate::network::exchange) is_busy: bool,
    /// Calls that ran: the program that served them, the one that made them, their lines and numbers.
    pub(in crate::network::exchange) ran: Vec<(usize, u64, u64, u64)>,
    /// What came of calls: the program that made them, their lines and numbers.
    pub(in crate::network::exchange) outcomes: Vec<(usize, u64, u64, Outcome)>,
    /// Time that all takes on its way, beside the jitter.
    pub(in crate::network::exchange) delay: u64,
    /// Time that a call takes.
    pub(in crate::network::exchange) service_time: u64,
    /// Answers that programs give at their times.
    answers: BTreeMap<(u64, u64), (usize, u64, u64, u64)>,
    states: BTreeMap<(usize, Option<u64>), u64>,
    /// The blocks of states with a place, by their senders and numbers.
    places: BTreeMap<(usize, u64), (i32, i32)>,
    /// What programs ask the network for, and what they are about to ask for, or no more.
    subscribed: BTreeSet<(usize, String)>,
    subscribing: BTreeMap<(u64, u64), (usize, String, bool)>,
    /// Number of the messages of components that reached each program, and of those that were put.
    pub(in crate::network::exchange) carried: BTreeMap<usize, u64>,
    pub(in crate::network::exchange) put: u64,
    weather: Weather,
    chance: u64,
    now: u64,
    count: u64,
    flying: BTreeMap<(u64, u64), Packet>,
}

impl Lossy {
    pub(in crate::network::exchange) fn new(programs: usize, weather: Weather, seed: u64) -> Lossy {
        let mut network = Lossy {
            programs: Vec::new(),
            delivered: Vec::new(),
            is_cut: false,
            is_busy: false,
            ran: Vec::new(),
            outcomes: Vec::new(),
            delay: 0,
            service_time: 0,
            answers: BTreeMap::new(),
            states: BTreeMap::new(),
            places: BTreeMap::new(),
            subscribed: BTreeSet::new(),
            subscribing: BTreeMap::new(),
            carried: BTreeMap::new(),
            put: 0,
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
    pub(in crate::network::exchange) fn change(&mut self, weather: Weather) {
        self.weather = weather;
    }

    /// Another program joins.
    pub(in crate::network::exchange) fn join(&mut self) {
        self.join_with(&format!("Robot{}", self.programs.len()), 0);
    }

    /// Another program joins, with this component, and this schema of events.
    pub(in crate::network::exchange) fn join_with(&mut self, component: &str, schema: u64) {
        self.join_as(&self.programs.len().to_string(), component, schema);
    }

    /// Another program joins under this name.
    pub(in crate::network::exchange) fn join_as(&mut self, name: &str, component: &str, schema: u64) {
        self.add(name, component, schema, None);
    }

    /// Another program joins, on a machine whose clock says this.
    pub(in crate::network::exchange) fn join_at(&mut self, name: &str, component: &str, began: u64) {
        self.add_at(name, component, 0, None, began);
    }

    /// Another program joins, with a state folder.
    pub(in crate::network::exchange) fn join_with_folder(&mut self) {
        let number = self.programs.len();
        self.add(&number.to_string(), &format!("Robot{number}"), 0, Some(Memory::default()));
    }

    /// Kills a program, and starts it again with its state folder. Gives its number from then on.
    pub(in crate::network::exchange) fn start_again(&mut self, program: usize) -> usize {
        self.start_again_from(program, self.programs[program].folder.clone())
    }

    /// The same from another state folder.
    pub(in crate::network::exchange) fn start_again_from(&mut self, program: usize, folder: Option<Memory>) -> usize {
        self.programs[program].is_stopped = true;
        let Program { name, component, sent, .. } = &self.programs[program];
        let (name, component, sent) = (name.clone(), Arc::clone(component), sent.clone());
        self.add(&name, &component, 0, folder);
        let again = self.programs.len() - 1;
        self.programs[again].sent = sent;
        again
    }

    fn add(&mut self, name: &str, component: &str, schema: u64, folder: Option<Memory>) {
        self.add_at(name, component, schema, folder, self.programs.len() as u64);
    }

    fn add_at(&mut self, name: &str, component: &str, schema: u64, folder: Option<Memory>, began: u64) {
        let number = self.programs.len();
        let folder = folder.map(|folder| match folder.start {
            0 => Memory { origin: number as u64, start: 1, ..folder },
            start => Memory { start: start + 1, ..folder },
        });
        let mut exchange = Exchange::new(Settings {
            program: number as u64,
            began,
            name: name.to_owned(),
            patience: 1_000 * MILLISECOND,
            limit: 256 << 10,
            linger: 10_000 * MILLISECOND,
            components: BTreeSet::from([component.to_owned()]),
            others: BTreeSet::new(),
            memory: folder.clone(),
        });
        exchange.read(&Arc::from("EVENTS"), false, schema);
        exchange.read(&Arc::from("STATES"), true, 0);
        exchange.read(&Arc::from("PLACES"), true, 0);
        self.programs.push(Program {
            exchange,
            is_stopped: false,
            component: Arc::from(component),
            name: name.to_owned(),
            sent: BTreeMap::new(),
            told: Vec::new(),
            lost: 0,
            folder,
        });
        self.carry_out(number);
    }

    /// A program sends an event.
    pub(in crate::network::exchange) fn send(&mut self, program: usize, topic: &str) {
        self.say(program, topic, false, None, None);
    }

    /// A program puts a state.
    pub(in crate::network::exchange) fn put(&mut self, program: usize, topic: &str, key: u64) {
        let number = self.say(program, topic, true, Some(key), None);
        self.states.insert((program, Some(key)), number);
    }

    /// A program puts a state at a block, on the topic `PLACES`.
    pub(in crate::network::exchange) fn put_at(&mut self, program: usize, key: u64, block: (i32, i32)) {
        let number = self.say(program, "PLACES", true, Some(key), Some(block));
        self.places.insert((program, number), block);
    }

    /// A program wants these cells of the topic `PLACES`, or all.
    pub(in crate::network::exchange) fn want(&mut self, program: usize, cells: Option<&[(i32, i32)]>) {
        let cells = cells.map(|cells| cells.iter().copied().collect());
        self.programs[program].exchange.want(&Arc::from("PLACES"), cells.as_ref(), self.now);
        self.carry_out(program);
    }

    /// The number of the last state with this key that a program has of another one, and the cell that it is in.
    pub(in crate::network::exchange) fn has(
        &self,
        reader: usize,
        sender: usize,
        key: u64,
    ) -> Option<(u64, (i32, i32))> {
        let is_it = |one: &&Delivered| {
            &*one.topic == "PLACES" && one.reader == reader && (one.sender, one.key) == (sender, Some(key))
        };
        let number = self.delivered.iter().filter(is_it).map(|one| one.number).next_back()?;
        Some((number, cell_of(self.places[&(sender, number)])))
    }

    /// Number of the messages that a program has sent on a topic.
    pub(in crate::network::exchange) fn sent(&self, program: usize, topic: &str) -> u64 {
        self.programs[program].sent.get(topic).copied().unwrap_or_default()
    }

    /// The last message of each program and key.
    pub(in crate::network::exchange) fn newest_states(&self) -> BTreeMap<(usize, Option<u64>), u64> {
        self.states.clone()
    }

    /// What a program was told.
    pub(in crate::network::exchange) fn told(&self, program: usize) -> Vec<String> {
        self.programs[program].told.clone()
    }

    fn say(&mut self, program: usize, topic: &str, is_state: bool, key: Option<u64>, place: Option<(i32, i32)>) -> u64 {
        let sender = &mut self.programs[program];
        let number = sender.sent.entry(topic.to_owned()).or_default();
        *number += 1;
        let number = *number;
        let mut kept = None;
        if let Some(folder) = sender.folder.as_mut().filter(|_| !is_state) {
            // The folder has it before it leaves.
            let events = folder.events.entry(Arc::from(topic)).or_default();
            let next = events.last_key_value().map_or(1, |(last, _)| last + 1);
            let (component, bytes) = (sender.component.to_string(), number.to_le_bytes().to_vec());
            events.insert(next, KeptEvent { component, sent: self.now, bytes, ..KeptEvent::default() });
            kept = Some(next);
        }
        sender.exchange.send(OwnMessage {
            topic: &Arc::from(topic),
            is_state,
            component: &Arc::clone(&sender.component),
            to: None,
            key,
            sent: self.now,
            schema: 0,
            cause: 0,
            place,
            number: kept,
            bytes: &number.to_le_bytes(),
        });
        self.carry_out(program);
        number
    }

    /// A program leaves.
    pub(in crate::network::exchange) fn leave(&mut self, program: usize) {
        self.programs[program].exchange.leave();
        self.carry_out(program);
    }

    /// A program calls a component of the program of this name. Gives the number of the call.
    pub(in crate::network::exchange) fn call(&mut self, program: usize, node: &str, call: OwnCall) -> u64 {
        let call = OwnCall { node: node.to_owned(), ..call };
        let number = self.programs[program].exchange.call(call, self.now);
        self.carry_out(program);
        number
    }

    /// What came of the calls of a program.
    pub(in crate::network::exchange) fn outcomes_of(&self, program: usize) -> Vec<(u64, u64, Outcome)> {
        let own = self.outcomes.iter().filter(|(caller, ..)| *caller == program);
        own.map(|(_, line, number, outcome)| (*line, *number, outcome.clone())).collect()
    }

    /// Lets time pass.
    pub(in crate::network::exchange) fn run(&mut self, time: u64) {
        let end = self.now + time;
        loop {
            for program in 0..self.programs.len() {
                if !self.programs[program].is_stopped {
                    let exchange = &mut self.programs[program].exchange;
                    exchange.tick(self.now);
                    if !self.is_busy {
                        let delivered = exchange.delivered();
                        exchange.note_done(delivered);
                    }
                    self.carry_out(program);
                }
            }
            // A program that is stopped gives its answers when it goes on.
            let is_due = |at: u64, server: usize| at <= self.now && !self.programs[server].is_stopped;
            let due = self.answers.iter().filter(|((at, _), (server, ..))| is_due(*at, *server));
            for key in due.map(|(key, _)| *key).collect::<Vec<_>>() {
                let Some((server, program, line, number)) = self.answers.remove(&key) else { continue };
                let bytes = number.to_le_bytes().to_vec();
                self.programs[server].exchange.reply(program, line, number, Ok(bytes));
                self.carry_out(server);
            }
            while let Some(entry) = self.subscribing.first_entry().filter(|entry| entry.key().0 <= self.now) {
                let (program, keys, is_wanted) = entry.remove();
                match is_wanted {
                    true => self.subscribed.insert((program, keys)),
                    false => self.subscribed.remove(&(program, keys)),
                };
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
                Action::Subscribe(keys) => self.subscribe(program, &keys, true),
                Action::Unsubscribe(keys) => self.subscribe(program, &keys, false),
                Action::Put { to, bytes } => self.carry((program, to, bytes, None)),
                Action::Send { to, frame } => {
                    let (bytes, envelope) = frame.encode();
                    self.put += 1;
                    self.carry((program, to, bytes, Some(envelope)));
                }
                Action::Deliver { program: sender, topic, arrived } => {
                    let number = u64::from_le_bytes(arrived.bytes.try_into().unwrap());
                    let (sender, reader) = (sender as usize, program);
                    self.delivered.push(Delivered { sender, reader, topic, key: arrived.key, number });
                }
                Action::Serve(request) => {
                    self.ran.push((program, request.program, request.line, request.number));
                    self.count += 1;
                    let answer = (program, request.program, request.line, request.number);
                    self.answers.insert((self.now + self.service_time, self.count), answer);
                }
                Action::Answered { line, number, outcome } => self.outcomes.push((program, line, number, outcome)),
                Action::Remember(changes) => {
                    let folder = self.programs[program].folder.as_mut().unwrap();
                    changes.into_iter().for_each(|change| remember(folder, change));
                }
                Action::Tell(news) => {
                    self.programs[program].lost += news.lost();
                    let line = match news {
                        News::Joined { program, .. } => format!("Joined {program}"),
                        News::GoesOn { program, .. } => format!("GoesOn {program}"),
                        News::Older { name, topic, after } => format!("Older {name} {topic} {after}"),
                        News::Left { program, .. } => format!("Left {program}"),
                        News::Unreachable { program, .. } => format!("Unreachable {program}"),
                        News::Back { program, .. } => format!("Back {program}"),
                        News::GivenUp { program, .. } => format!("GivenUp {program}"),
                        News::NotKept { name, count } => format!("NotKept {name} {count}"),
                        News::Lost { program, topic, count, .. } => format!("Lost {program} {topic} {count}"),
                        News::Stays { name, topic, count } => format!("Stays {name} {topic} {count}"),
                        News::Replaced { name } => format!("Replaced {name}"),
                        News::Unreceived { name, topic, count } => format!("Unreceived {name} {topic} {count}"),
                        News::Later { name, topic, count } => format!("Later {name} {topic} {count}"),
                        News::Superseded { component, name } => format!("Superseded {component} {name}"),
                        News::Twice { component, program, .. } => format!("Twice {component} {program}"),
                        News::Anew { component, program, after, .. } => format!("Anew {component} {program} {after}"),
                        News::Differs { program, component, topic, .. } => {
                            format!("Differs {program} {component} {topic}")
                        }
                        News::Overflow { topic, count } => format!("Overflow {topic} {count}"),
                    };
                    self.programs[program].told.push(line);
                }
            }
        }
    }

    /// A network hears later what a program asks it for.
    fn subscribe(&mut self, program: usize, keys: &Keys, is_wanted: bool) {
        let at = self.now + self.delay + self.random(self.weather.jitter + 1) * MILLISECOND;
        // In the order of asking: it is one connection.
        let last = self.subscribing.keys().map(|(at, _)| *at).max().unwrap_or_default();
        self.count += 1;
        self.subscribing.insert((at.max(last), self.count), (program, format!("{keys:?}"), is_wanted));
    }

    fn is_subscribed(&self, program: usize, topic: &Arc<str>, cell: Option<(i32, i32)>) -> bool {
        let part = match cell {
            Some(cell) => Keys::Cell(Arc::clone(topic), cell),
            None => Keys::Elsewhere(Arc::clone(topic)),
        };
        let has = |keys: Keys| self.subscribed.contains(&(program, format!("{keys:?}")));
        has(Keys::All(Arc::clone(topic))) || has(part)
    }

    fn carry(&mut self, packet: Packet) {
        let repeats = self.random(100) < u64::from(self.weather.repeats);
        for _ in 0..1 + u64::from(repeats) {
            if self.is_cut || self.random(100) < u64::from(self.weather.loss) {
                continue;
            }
            let at = self.now + self.delay + self.random(self.weather.jitter + 1) * MILLISECOND;
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
            if let Destination::Topic(topic, _, cell) = to {
                if !self.is_subscribed(reader, topic, *cell) {
                    continue;
                }
                *self.carried.entry(reader).or_default() += 1;
            }
            let (exchange, now) = (&mut self.programs[reader].exchange, self.now);
            let is_mine = |program: &u64| *program == reader as u64;
            match to {
                Destination::Topic(topic, ..) => {
                    exchange.receive(topic, bytes, envelope.as_ref().unwrap(), now);
                }
                Destination::Look(program) if is_mine(program) => exchange.show(&cdr::decode(bytes).unwrap()),
                Destination::Around(program, _) if is_mine(program) => {
                    exchange.see(cdr::decode(bytes).unwrap(), now);
                }
                Destination::Again(program, topic) if is_mine(program) => {
                    exchange.receive(topic, bytes, envelope.as_ref().unwrap(), now);
                }
                Destination::Alive(_) | Destination::Leaves(_) => exchange.hear(&cdr::decode(bytes).unwrap(), now),
                Destination::Call(program) if is_mine(program) => {
                    exchange.take_request(cdr::decode(bytes).unwrap(), now);
                }
                Destination::Reply(program) if is_mine(program) => {
                    exchange.take_reply(cdr::decode(bytes).unwrap(), now);
                }
                Destination::Runs(program) if is_mine(program) => exchange.note_begin(cdr::decode(bytes).unwrap()),
                Destination::Ask(program) if is_mine(program) => exchange.answer(&cdr::decode(bytes).unwrap()),
                Destination::Covered(program) if is_mine(program) => exchange.cover(&cdr::decode(bytes).unwrap(), now),
                _ => {}
            }
            self.carry_out(reader);
        }
    }
}

fn remember(folder: &mut Memory, change: Remembered) {
    match change {
        Remembered::Forget { topic, first, end } => {
            let events = folder.events.get_mut(&topic).unwrap();
            events.retain(|number, _| !(first..end).contains(number));
        }
        Remembered::Reader(reader) => {
            folder.readers.retain(|one| one.program != reader.program);
            folder.readers.push(reader);
        }
        Remembered::NoReader { program } => folder.readers.retain(|one| one.program != program),
    }
}
