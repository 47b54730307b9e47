//! A host that runs components in virtual time, and can delay their messages.

mod restart;

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::fmt;
use std::time::Duration;

use saoms_api::host::Host;
use saoms_api::host::{
    DynComponent, Invocation, LoopRegistration, NamedLoops, Phase, PropertyValue, Registration, ServiceCall,
    SharedMessage, SmolStr, TopicDeclaration, TopicKind,
};
use saoms_api::{
    CallError, Cause, Chance, Class, Context, Failure, KnownPublisher, Level, Record, ReportValue, Time, Work,
};

/// A fleet in virtual time.
pub(crate) struct Fleet {
    components: Vec<Option<Box<dyn DynComponent>>>,
    seats: Vec<Seat>,
    topics: Vec<Topic>,
    queue: BinaryHeap<Reverse<(Time, u64, Due)>>,
    order: u64,
    now: Time,
    seed: u64,
    /// Maximum delay of a component's messages, as a share of its period.
    lateness: f64,
    chance: Chance,
    /// An execution, by its component and its number, that a crash of the program takes back.
    pub(crate) crash: Option<(usize, u64)>,
    pub(crate) counts: BTreeMap<String, i64>,
    pub(crate) log: Vec<String>,
    pub(crate) console: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Due {
    /// Messages of a component are sent.
    Delivery(usize),
    Execution(usize),
}

struct Topic {
    name: String,
    kind: TopicKind,
    newest: BTreeMap<(u32, u64), SharedMessage>,
    readers: Vec<(usize, usize)>,
}

/// State of a component in the host.
struct Seat {
    loops: &'static [LoopRegistration],
    is_classic: bool,
    name: String,
    period: Duration,
    execution: u64,
    chance: Chance,
    references: Vec<(String, Option<(usize, String)>)>,
    publishes: Vec<usize>,
    inboxes: Vec<Vec<SharedMessage>>,
    outbox: Vec<(u32, SharedMessage)>,
    /// Messages that the component has sent and that did not arrive yet, in order.
    travelling: Vec<(u32, SharedMessage)>,
    vote: Option<Work>,
    make: Box<dyn Fn() -> Box<dyn DynComponent>>,
    kept: BTreeMap<u64, Vec<u8>>,
    /// True after a crash, for what kept something, and while one initializes that goes on from a saved state.
    kept_before: bool,
    goes_on: bool,
}

impl Fleet {
    pub(crate) fn new(seed: u64, lateness: f64) -> Fleet {
        Fleet {
            components: Vec::new(),
            seats: Vec::new(),
            topics: Vec::new(),
            queue: BinaryHeap::new(),
            order: 0,
            now: Time::START,
            seed,
            lateness,
            chance: Chance::for_component(seed, "host"),
            crash: None,
            counts: BTreeMap::new(),
            log: Vec::new(),
            console: Vec::new(),
        }
    }

    /// Adds a component; references are given as (name, provider, service).
    pub(crate) fn add<C: Class>(
        &mut self,
        name: &str,
        period: Duration,
        delay: Duration,
        values: &[(&str, &str)],
        references: &[(&str, usize, &str)],
    ) -> usize {
        let values: Vec<_> =
            values.iter().map(|(name, value)| (SmolStr::from(*name), PropertyValue::from(*value))).collect();
        let registration = Registration::of::<C>();
        let component = registration.construct(&values).unwrap();
        let is_classic = values.contains(&("policy".into(), "classic".into()));
        let index = self.components.len();
        self.components.push(Some(component));
        let references = references
            .iter()
            .map(|(name, provider, service)| ((*name).to_owned(), Some((*provider, (*service).to_owned()))))
            .collect();
        self.seats.push(Seat {
            name: name.to_owned(),
            period,
            execution: 0,
            chance: Chance::for_component(self.seed, name),
            references,
            publishes: Vec::new(),
            inboxes: Vec::new(),
            outbox: Vec::new(),
            travelling: Vec::new(),
            vote: None,
            make: Box::new(move || Registration::of::<C>().construct(&values).unwrap()),
            kept: BTreeMap::new(),
            kept_before: false,
            goes_on: false,
            loops: registration.loops(),
            is_classic,
        });
        if period > Duration::ZERO {
            self.schedule(Time::START + delay, Due::Execution(index));
        }
        index
    }

    fn schedule(&mut self, at: Time, due: Due) {
        self.order += 1;
        // At one instant messages arrive first, then components run in the order of their addition.
        let order = match due {
            Due::Delivery(_) => 0,
            Due::Execution(index) => 1 + index as u64,
        };
        self.queue.push(Reverse((at, order, due)));
    }

    /// Initializes all components; their messages arrive at once.
    pub(crate) fn initialize(&mut self) -> Result<(), Failure> {
        for index in 0..self.components.len() {
            self.call(index, |component, context| component.initialize(context))?;
        }
        for index in 0..self.components.len() {
            let outbox = std::mem::take(&mut self.seats[index].outbox);
            self.deliver(index, outbox);
        }
        Ok(())
    }

    /// Runs until all components that vote are done, or until a time; `true` if they are done.
    pub(crate) fn run(&mut self, until: Duration) -> bool {
        while let Some(Reverse((at, _, due))) = self.queue.pop() {
            if at > Time::START + until {
                self.queue.push(Reverse((at, 0, due)));
                return false;
            }
            self.now = at;
            match due {
                Due::Delivery(index) => {
                    let travelling = std::mem::take(&mut self.seats[index].travelling);
                    self.deliver(index, travelling);
                }
                Due::Execution(index) => self.execute(index),
            }
            let mut votes = self.seats.iter().filter_map(|seat| seat.vote).peekable();
            if votes.peek().is_some() && votes.all(|vote| vote == Work::Done) {
                return true;
            }
        }
        false
    }

    fn execute(&mut self, index: usize) {
        let late = std::mem::take(&mut self.seats[index].travelling);
        self.deliver(index, late);
        if self.crash.take_if(|crash| *crash == (index, self.seats[index].execution)).is_some() {
            self.schedule(self.now + self.seats[index].period, Due::Execution(index));
            return self.crash_in(index);
        }
        self.call(index, |component, context| component.execute(context))
            .unwrap_or_else(|failure| panic!("{} failed: {failure}", self.seats[index].name));
        let seat = &mut self.seats[index];
        seat.execution += 1;
        seat.travelling = std::mem::take(&mut seat.outbox);
        let period = seat.period;
        let share = self.lateness * (self.chance.below(1000) as f64 / 1000.0);
        let latency = period.mul_f64(share);
        if latency.is_zero() {
            let travelling = std::mem::take(&mut self.seats[index].travelling);
            self.deliver(index, travelling);
        } else {
            self.schedule(self.now + latency, Due::Delivery(index));
        }
        self.schedule(self.now + period, Due::Execution(index));
    }

    fn deliver(&mut self, sender: usize, messages: Vec<(u32, SharedMessage)>) {
        for (publisher, message) in messages {
            let topic = &mut self.topics[self.seats[sender].publishes[publisher as usize]];
            let key_of = |message: &SharedMessage| (message.header().sender, message.key().unwrap_or_default());
            let key = key_of(&message);
            for (reader, inbox) in &topic.readers {
                let inbox = &mut self.seats[*reader].inboxes[*inbox];
                if topic.kind == TopicKind::State {
                    inbox.retain(|waiting| key_of(waiting) != key);
                }
                inbox.push(message.clone());
            }
            if topic.kind == TopicKind::State {
                topic.newest.insert(key, message);
            }
        }
    }

    fn call<R>(
        &mut self,
        index: usize,
        work: impl FnOnce(&mut dyn DynComponent, &mut Context<'_>) -> Result<R, Failure>,
    ) -> Result<R, Failure> {
        let mut component = self.components[index].take().expect("no component calls itself");
        let mut inboxes = std::mem::take(&mut self.seats[index].inboxes);
        let result = work(&mut *component, &mut Context::new(&mut View { fleet: self, index }, &inboxes));
        for inbox in &mut inboxes {
            inbox.clear();
        }
        let seat = &mut self.seats[index];
        // Subscriptions add inboxes.
        inboxes.append(&mut seat.inboxes);
        seat.inboxes = inboxes;
        self.components[index] = Some(component);
        result
    }

    fn topic(&mut self, topic: &TopicDeclaration<'_>) -> usize {
        self.topics.iter().position(|known| known.name == topic.name).unwrap_or_else(|| {
            self.topics.push(Topic {
                name: topic.name.to_owned(),
                kind: topic.kind,
                newest: BTreeMap::new(),
                readers: Vec::new(),
            });
            self.topics.len() - 1
        })
    }

    pub(crate) fn time(&self) -> Time {
        self.now
    }

    pub(crate) fn count(&self, path: &str) -> i64 {
        self.counts.get(path).copied().unwrap_or(0)
    }
}

/// A component's view of the fleet during a call.
struct View<'a> {
    fleet: &'a mut Fleet,
    index: usize,
}

impl View<'_> {
    fn seat(&self) -> &Seat {
        &self.fleet.seats[self.index]
    }

    fn seat_mut(&mut self) -> &mut Seat {
        &mut self.fleet.seats[self.index]
    }
}

impl Host for View<'_> {
    fn name(&self) -> &str {
        &self.seat().name
    }

    fn sender(&self) -> u32 {
        self.index as u32
    }

    fn now(&self) -> Time {
        self.fleet.now
    }

    fn due(&self) -> Time {
        self.fleet.now
    }

    fn execution(&self) -> u64 {
        self.seat().execution
    }

    fn date(&self) -> Option<Duration> {
        None
    }

    fn period(&self) -> Duration {
        self.seat().period
    }

    fn cancelled(&self) -> bool {
        false
    }

    fn chance(&mut self) -> &mut Chance {
        &mut self.seat_mut().chance
    }

    fn publish(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        let topic = self.fleet.topic(topic);
        let publishes = &mut self.seat_mut().publishes;
        publishes.push(topic);
        Ok(publishes.len() as u32 - 1)
    }

    fn subscribe(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        let topic = self.fleet.topic(topic);
        let inboxes = &mut self.seat_mut().inboxes;
        inboxes.push(Vec::new());
        let inbox = inboxes.len() - 1;
        self.fleet.topics[topic].readers.push((self.index, inbox));
        Ok(inbox as u32)
    }

    fn send(&mut self, publisher: u32, message: SharedMessage) -> Result<(), Failure> {
        self.seat_mut().outbox.push((publisher, message));
        Ok(())
    }

    fn reference(&mut self, name: &str, _interface: &str) -> Result<u32, Failure> {
        let references = &mut self.seat_mut().references;
        let place = references.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
            references.push((name.to_owned(), None));
            references.len() - 1
        });
        Ok(place as u32)
    }

    fn set_region(&mut self, _: u32, _: Option<saoms_api::Region>) -> Result<(), Failure> {
        Ok(())
    }

    fn departed(&self, _: u32) -> &[saoms_api::Departed] {
        &[]
    }

    fn keep(&mut self, key: u64, bytes: &[u8]) -> Result<(), Failure> {
        match bytes {
            [] => self.seat_mut().kept.remove(&key),
            bytes => self.seat_mut().kept.insert(key, bytes.to_vec()),
        };
        Ok(())
    }

    fn kept(&self) -> BTreeMap<u64, &[u8]> {
        self.seat().kept.iter().map(|(key, bytes)| (*key, &**bytes)).collect()
    }

    fn kept_by_earlier_program(&self) -> bool {
        self.seat().kept_before
    }

    fn goes_on(&self) -> bool {
        self.seat().goes_on
    }

    fn goes_on_from_earlier_program(&self) -> bool {
        self.seat().goes_on
    }

    fn publishers(&self, topic: &str) -> Vec<KnownPublisher> {
        let publishes = |seat: &&Seat| seat.publishes.iter().any(|place| self.fleet.topics[*place].name == topic);
        let publisher = |sender| KnownPublisher { sender, has_begun: true, number: None };
        (0..).zip(&self.fleet.seats).filter(|(_, seat)| publishes(seat)).map(|(sender, _)| publisher(sender)).collect()
    }

    fn register_stop(&mut self, _: saoms_api::StopFunction) -> Result<(), Failure> {
        Ok(())
    }

    fn is_wired(&self, reference: u32) -> bool {
        self.seat().references[reference as usize].1.is_some()
    }

    fn call(&mut self, reference: u32, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        let (name, target) = self.seat().references[reference as usize].clone();
        let Some((provider, service)) = target else { return Err(CallError::NotWired { reference: name }) };
        let mut component = self.fleet.components[provider].take().expect("no component calls itself");
        let mut view = View { fleet: self.fleet, index: provider };
        let result = component.serve(&mut Invocation { service: &service, call }, &mut Context::new(&mut view, &[]));
        self.fleet.components[provider] = Some(component);
        result
    }

    /// The loops of the robots' policy; all other components have one list.
    fn loops(&mut self) -> Result<NamedLoops, Failure> {
        let seat = self.seat();
        let name = |one: &LoopRegistration| {
            one.declaration().split("\"loop\":\"").nth(1).unwrap().split('"').next().unwrap().to_owned()
        };
        let fits = |one: &&LoopRegistration| name(one).starts_with("saoms.classic.") == seat.is_classic;
        let short = |name: String| name.rsplit('.').next().unwrap().to_owned();
        seat.loops.iter().filter(fits).map(|one| Ok((short(name(one)), one.construct(&[])?))).collect()
    }

    fn enter_loop(&mut self, _place: Option<u32>) {}

    fn because(&mut self, _cause: Cause) {}

    fn cause(&self) -> Cause {
        Cause::default()
    }

    fn journal(&mut self, _phase: Phase, _record: &Record) {}

    fn listens(&self, _level: Option<Level>) -> bool {
        true
    }

    fn log(&mut self, level: Level, line: fmt::Arguments<'_>) {
        let line = format!("{} {}: {level:?}: {line}", self.fleet.now, self.name());
        self.fleet.log.push(line);
    }

    fn console(&mut self, line: fmt::Arguments<'_>) {
        self.fleet.console.push(line.to_string());
    }

    fn report(&mut self, _path: &str, _value: ReportValue) {}

    fn count(&mut self, path: &str, more: i64) {
        *self.fleet.counts.entry(path.to_owned()).or_default() += more;
    }

    fn vote(&mut self, work: Work) {
        // What is given up says nothing about what is left.
        if work != Work::GivenUp {
            self.seat_mut().vote = Some(work);
        }
    }
}
