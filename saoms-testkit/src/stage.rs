//! The host of a component on a [`Bench`].

mod transcript;

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use saoms_api::event::{EventCall, Events, STOP};
use saoms_api::extension::LineFault;
use saoms_api::host::{Host, LoopVisit};
use saoms_api::host::{NamedLoops, Phase, PropertyValue, ServiceCall, SharedMessage, SmolStr, TopicDeclaration};
use saoms_api::{
    CallError, Cause, Chance, Departed, Failure, Level, Record, Region, ReportValue, StopFunction, Time, Value, Work,
};
use saoms_registry::registry::{ClassTopic, PropertyDeclaration, RegisteredClass, RegisteredLoop, Registry};
use saoms_registry::schema::Schema;

pub(crate) use self::transcript::Action;
use crate::Bench;

/// A topic to which the component subscribed.
pub(crate) struct BoundTopic {
    pub(crate) name: String,
    schema: Option<Schema>,
    /// The blocks whose messages it receives; all with `None`.
    pub(crate) region: Option<Region>,
    /// Messages that left the region.
    pub(crate) departed: Vec<Departed>,
}

/// A reference of the component, and the service that it leads to.
pub(crate) struct Wire {
    pub(crate) reference: String,
    pub(crate) service: String,
    pub(crate) provider: Bench,
    pub(crate) is_busy: bool,
}

/// A loop of the component, with the values of its properties.
pub(crate) struct StageLoop {
    name: String,
    class: Arc<RegisteredLoop>,
    values: Vec<(SmolStr, PropertyValue)>,
}

impl StageLoop {
    pub(crate) fn new(name: &str, class: Arc<RegisteredLoop>, values: Vec<(SmolStr, PropertyValue)>) -> StageLoop {
        StageLoop { name: name.to_owned(), class, values }
    }

    fn usual(class: Arc<RegisteredLoop>) -> StageLoop {
        StageLoop { name: class.declaration().short_name().to_owned(), class, values: Vec::new() }
    }
}

pub(crate) struct Stage {
    /// `None` if the stage runs only a loop.
    class: Option<Arc<RegisteredClass>>,
    /// The events that known classes take.
    events: Events,
    loops: Vec<StageLoop>,
    loop_names: Vec<String>,
    acting: Option<u32>,
    pub(crate) period: Duration,
    pub(crate) now: Time,
    execution: u64,
    chance: Chance,
    pub(crate) initializing: bool,
    pub(crate) publishers: Vec<BoundTopic>,
    pub(crate) subscriptions: Vec<BoundTopic>,
    pub(crate) wires: Vec<Wire>,
    pub(crate) actions: Vec<(Time, Action)>,
    /// The text of each record by loop, phase and id.
    texts: BTreeMap<(Option<u32>, &'static str, &'static str), &'static str>,
    pub(crate) stops: Vec<StopFunction>,
    /// What the component keeps, by its numbers.
    pub(crate) kept: BTreeMap<u64, Vec<u8>>,
    pub(crate) report: Vec<(String, ReportValue)>,
    pub(crate) work: Option<Work>,
    pub(crate) gave_up: bool,
}

/// The component's name.
const NAME: &str = "Bench";

impl Stage {
    /// The stage of a component with these values; its loops are those of its class.
    pub(crate) fn new(
        registry: &Registry,
        class: &Arc<RegisteredClass>,
        values: &[(SmolStr, PropertyValue)],
    ) -> Result<Stage, Failure> {
        let declaration = class.declaration();
        let find = |name: &String| {
            registry.get_loop(name).cloned().ok_or_else(|| Failure::new(format!("there is no loop `{name}`")))
        };
        let loops = declaration.loops_of(values).iter().map(find).collect::<Result<_, _>>()?;
        let events = registry.iter().flat_map(|class| class.declaration().events());
        Ok(Stage { class: Some(Arc::clone(class)), events: Events::of(events), ..Stage::of_loops(loops) })
    }

    /// The stage of loops without a component around them.
    pub(crate) fn of_loops(loops: Vec<Arc<RegisteredLoop>>) -> Stage {
        Stage {
            class: None,
            events: Events::default(),
            loops: loops.into_iter().map(StageLoop::usual).collect(),
            loop_names: Vec::new(),
            acting: None,
            period: Duration::from_millis(100),
            now: Time::START,
            execution: 0,
            chance: Chance::for_component(0, NAME),
            initializing: false,
            publishers: Vec::new(),
            subscriptions: Vec::new(),
            wires: Vec::new(),
            actions: Vec::new(),
            texts: BTreeMap::new(),
            stops: Vec::new(),
            kept: BTreeMap::new(),
            report: Vec::new(),
            work: None,
            gave_up: false,
        }
    }

    /// Puts a loop in the place of the one of this name, or behind all others.
    pub(crate) fn put_loop(&mut self, new: StageLoop) {
        match self.loops.iter_mut().find(|one| one.name == new.name) {
            Some(old) => *old = new,
            None => self.loops.push(new),
        }
    }

    pub(crate) fn set_seed(&mut self, seed: u64) {
        self.chance = Chance::for_component(seed, NAME);
    }

    pub(crate) fn end_of_execution(&mut self) {
        self.execution += 1;
        self.now = self.now + self.period;
    }

    /// A property of the class that can change while the component runs.
    pub(crate) fn class_property(&self, name: &str) -> Result<PropertyDeclaration, Failure> {
        let class = self.class.as_ref().map(|class| class.declaration());
        let property = class.and_then(|class| class.property(name));
        let property = property.ok_or_else(|| Failure::new(format!("its class has no property `{name}`")))?;
        match property.live {
            true => Ok(property.clone()),
            false => {
                Err(Failure::new(format!("property `{name}` is not `live`: it cannot change while the component runs")))
            }
        }
    }

    /// Tells the hardware of the component, and of those that it is wired to, that it is alive.
    pub(crate) fn beat(&self, period: Duration) {
        let wired = self.wires.iter().flat_map(|wire| &wire.provider.stage().stops);
        self.stops.iter().chain(wired).for_each(|stop| stop.beat(period));
    }

    pub(crate) fn stop_hardware(&self) -> Result<(), Failure> {
        let wired = self.wires.iter().flat_map(|wire| &wire.provider.stage().stops);
        self.stops.iter().chain(wired).try_for_each(StopFunction::stop)
    }

    pub(crate) fn skipped(&mut self, provider: &str) {
        self.log_action(Action::Skipped(provider.to_owned()));
    }

    fn log_action(&mut self, what: Action) {
        self.actions.push((self.now, what));
    }

    fn declared(&self, publishes: bool) -> impl Iterator<Item = &ClassTopic> {
        let of_class = self.class.iter().flat_map(move |class| {
            let class = class.declaration();
            if publishes { &class.publishes } else { &class.subscribes }
        });
        let of_loops = self.loops.iter().flat_map(move |one| {
            let one = one.class.declaration();
            if publishes { &one.publishes } else { &one.subscribes }
        });
        of_class.chain(of_loops)
    }

    /// The topics that are heard by declaration, with their schemas.
    pub(crate) fn heard(&self) -> impl Iterator<Item = (String, Schema)> {
        self.declared(false).filter_map(|topic| Some((topic.name.clone(), Schema::of(&topic.schema).ok()?)))
    }

    pub(crate) fn schema_heard(&self, topic: &str) -> Result<Schema, Failure> {
        let found = self.heard().find(|(name, _)| name == topic);
        found.map(|(_, schema)| schema).ok_or_else(|| Failure::new(format!("it does not subscribe to `{topic}`")))
    }

    pub(crate) fn schema_said(&self, topic: &str) -> Option<Schema> {
        self.publishers.iter().find(|taken| taken.name == topic).and_then(|taken| taken.schema.clone())
    }

    fn take(&self, topic: &TopicDeclaration<'_>, publishes: bool) -> Result<BoundTopic, Failure> {
        let verb = if publishes { "publishes" } else { "subscribes" };
        if !self.initializing {
            return Err(Failure::new(format!("topic `{}`: it {verb} after `initialize`", topic.name)));
        }
        if !self.declared(publishes).any(|declared| declared.name == topic.name) {
            return Err(Failure::new(format!(
                "topic `{}`: it {verb}, but neither its class `{}` nor a loop declares that",
                topic.name,
                self.class.as_ref().map_or("(none)", |class| class.name())
            )));
        }
        Ok(BoundTopic {
            name: topic.name.to_owned(),
            schema: Schema::parse(topic.schema).ok(),
            region: None,
            departed: Vec::new(),
        })
    }
}

impl Host for Stage {
    /// A test speaks for everybody.
    fn speaker(&self, _: &str, _: u32) -> Option<u32> {
        Some(crate::bench::TEST)
    }

    fn name(&self) -> &str {
        NAME
    }

    fn sender(&self) -> u32 {
        0
    }

    fn now(&self) -> Time {
        self.now
    }

    fn date(&self) -> Option<Duration> {
        None
    }

    fn due(&self) -> Time {
        self.now
    }

    fn execution(&self) -> u64 {
        self.execution
    }

    fn period(&self) -> Duration {
        self.period
    }

    fn cancelled(&self) -> bool {
        false
    }

    fn chance(&mut self) -> &mut Chance {
        &mut self.chance
    }

    fn publish(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        let taken = self.take(topic, true)?;
        self.publishers.push(taken);
        Ok(self.publishers.len() as u32 - 1)
    }

    fn subscribe(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        let taken = self.take(topic, false)?;
        self.subscriptions.push(taken);
        Ok(self.subscriptions.len() as u32 - 1)
    }

    fn send(&mut self, publisher: u32, message: SharedMessage) -> Result<(), Failure> {
        let place = publisher as usize;
        if place >= self.publishers.len() {
            return Err(Failure::new("this publisher belongs to no topic: keep what `Context::publish` returned"));
        }
        self.log_action(Action::Sent(place, message));
        Ok(())
    }

    fn raise(&mut self, event: &str) -> Result<(), Failure> {
        if event == STOP {
            self.log_action(Action::Raised(event.to_owned()));
            return Ok(());
        }
        let refused = |fault: LineFault| Failure::new(format!("event `{event}`: {fault}"));
        let call = EventCall::read(event).map_err(refused)?;
        // One that no known class takes is no failure: in a fleet, a component of another class may take it.
        if let Some(known) = self.events.get(&call.name.text) {
            known.check(&call).map_err(refused)?;
        }
        self.log_action(Action::Raised(event.to_owned()));
        Ok(())
    }

    fn reference(&mut self, name: &str, interface: &str) -> Result<u32, Failure> {
        let of_class = self.class.iter().flat_map(|class| &class.declaration().references);
        let of_loops = self.loops.iter().flat_map(|one| &one.class.declaration().references);
        let declared =
            of_class.chain(of_loops).any(|reference| reference.name == name && reference.interface.name == interface);
        if !declared {
            return Err(Failure::new(format!("neither its class nor a loop declares the reference `{name}`")));
        }
        // A reference that is not wired has a handle, too.
        let wired = self.wires.iter().position(|wire| wire.reference == name);
        Ok(wired.unwrap_or(usize::from(u16::MAX)) as u32)
    }

    fn set_region(&mut self, subscription: u32, region: Option<Region>) -> Result<(), Failure> {
        match self.subscriptions.get_mut(subscription as usize) {
            Some(topic) => topic.region = region,
            None => return Err(Failure::new("this subscription belongs to no topic")),
        }
        Ok(())
    }

    fn departed(&self, subscription: u32) -> &[Departed] {
        self.subscriptions.get(subscription as usize).map_or(&[], |topic| &topic.departed)
    }

    fn keep(&mut self, key: u64, bytes: &[u8]) -> Result<(), Failure> {
        drop(if bytes.is_empty() { self.kept.remove(&key) } else { self.kept.insert(key, bytes.to_vec()) });
        Ok(())
    }

    fn kept(&self) -> BTreeMap<u64, &[u8]> {
        self.kept.iter().map(|(key, bytes)| (*key, bytes.as_slice())).collect()
    }

    fn register_stop(&mut self, stop: StopFunction) -> Result<(), Failure> {
        if !self.initializing {
            return Err(Failure::new("it registers a function that stops its hardware after `initialize`"));
        }
        match &self.class {
            Some(class) if class.declaration().stops => self.stops.push(stop),
            _ => return Err(Failure::new("it stops hardware, but its class does not say `stops` in `#[class(...)]`")),
        }
        Ok(())
    }

    fn is_wired(&self, reference: u32) -> bool {
        (reference as usize) < self.wires.len()
    }

    fn call(&mut self, reference: u32, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        match self.wires.get_mut(reference as usize) {
            Some(wire) if wire.is_busy => Err(CallError::Busy { provider: wire.reference.clone() }),
            Some(wire) => wire.provider.serve(&wire.service, call, self.now),
            None => Err(CallError::NotWired { reference: reference.to_string() }),
        }
    }

    fn loops(&mut self) -> Result<NamedLoops, Failure> {
        self.loops.iter().map(|one| Ok((one.name.clone(), one.class.construct(&one.values)?))).collect()
    }

    fn chosen_loops(&mut self, visit: &mut LoopVisit<'_>) {
        for one in &self.loops {
            visit(&one.name, one.class.name(), &one.values);
        }
    }

    fn chosen_loop(&mut self, place: u32) -> Result<Box<dyn saoms_api::host::DynLoop>, Failure> {
        let one = self.loops.get(place as usize).ok_or("there are fewer loops")?;
        one.class.construct(&one.values)
    }

    fn name_loop(&mut self, place: u32, name: &str) {
        let place = place as usize;
        if self.loop_names.len() <= place {
            self.loop_names.resize(place + 1, String::new());
        }
        name.clone_into(&mut self.loop_names[place]);
    }

    fn enter_loop(&mut self, place: Option<u32>) {
        self.acting = place;
    }

    fn because(&mut self, _: Cause) {}

    fn cause(&self) -> Cause {
        Cause::default()
    }

    fn journal(&mut self, phase: Phase, record: &Record) {
        let (id, text) = (record.id(), record.text());
        let known = *self.texts.entry((self.acting, phase.name(), id)).or_insert(text);
        assert!(
            known == text,
            "the record `{id}` has two texts, `{known}` and `{text}`: give one of them another id; with the same values \
             the journal takes one for a repetition of the other"
        );
        let line = format!("{}{}: {record}", self.acting(), phase.name());
        self.log_action(Action::Journal(line));
    }

    fn changed(&mut self, entry: &'static str, before: Value, after: Value) {
        if before.is_same(after) {
            return;
        }
        let line = format!("{}{entry}: {before} -> {after}", self.acting());
        self.log_action(Action::Journal(line));
    }

    fn listens(&self, _: Option<Level>) -> bool {
        true
    }

    fn log(&mut self, level: Level, line: fmt::Arguments<'_>) {
        self.log_action(Action::Log(level, line.to_string()));
    }

    fn console(&mut self, line: fmt::Arguments<'_>) {
        self.log_action(Action::Console(line.to_string()));
    }

    fn report(&mut self, path: &str, value: ReportValue) {
        self.log_action(Action::Report(format!("{path} = {value:?}")));
        self.report.push((path.to_owned(), value));
    }

    fn count(&mut self, path: &str, more: i64) {
        let before = self.report.iter().rev().find(|(known, _)| known == path);
        let before = match before {
            Some((_, ReportValue::Integer(before))) => *before,
            _ => 0,
        };
        let now = before.saturating_add(more);
        self.log_action(Action::Report(format!("{path} = {now}")));
        self.report.push((path.to_owned(), ReportValue::Integer(now)));
    }

    fn vote(&mut self, work: Work) {
        let is_new = match work {
            Work::GivenUp => !std::mem::replace(&mut self.gave_up, true),
            _ => self.work.replace(work) != Some(work),
        };
        if is_new {
            self.log_action(Action::Work(work));
        }
    }
}

impl Stage {
    fn acting(&self) -> String {
        let name = self.acting.and_then(|place| self.loop_names.get(place as usize));
        name.map_or_else(String::new, |name| format!("{name} "))
    }
}
