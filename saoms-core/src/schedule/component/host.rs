mod loops;

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use saoms_api::event::fault::FaultCall;
use saoms_api::event::{EventCall, STOP};
use saoms_api::host::{DynLoop, NamedLoops, Phase, ServiceCall, SharedMessage, TopicDeclaration};
use saoms_api::host::{Host, LoopVisit, TARGET_SHIFT, shown};
use saoms_api::{
    CallError, Cause, Chance, Departed, Failure, Header, KeptByOther, KnownPublisher, Level, Record, Region,
    ReportValue, StopFunction, Time, Value, Work,
};

use super::declared::TopicUse;
use super::part::Part;
use crate::observe::{Occurrence, RunEvent};
use crate::schedule::engine::lifecycle::Request;
use crate::schedule::inject::{OUTSIDE, OUTSIDE_NAME};
use crate::schedule::networks::NO_NETWORK;
use crate::schedule::shared::Shared;
use crate::schedule::topics::takers::EventMessage;
use saoms_lang::assembly::{ComponentSpec, Wire};

/// The host of a component while its code runs.
pub(crate) struct ComponentHost<'a> {
    pub(crate) shared: &'a Arc<Shared>,
    pub(crate) part: &'a mut Part,
}

/// Maximum number of targets of one reference that a handle can address.
const MOST_TARGETS: usize = (1 << (32 - TARGET_SHIFT)) - 1;

impl ComponentHost<'_> {
    pub(super) fn spec(&self) -> &ComponentSpec {
        &self.part.spec
    }

    /// The reference of a handle.
    fn wire(&self, reference: u32) -> Option<&Wire> {
        let place = reference & ((1 << TARGET_SHIFT) - 1);
        self.spec().references.get(place as usize)
    }
}

/// Greatest number of publishers, of subscriptions, and of functions that stop hardware of a component.
pub(super) const MAX_HANDLES: usize = 1000;
/// Greatest length of an event, in bytes.
const MAX_EVENT: usize = 65_536;

impl Host for ComponentHost<'_> {
    fn name(&self) -> &str {
        &self.part.name
    }

    fn sender(&self) -> u32 {
        self.part.index
    }

    fn name_of(&self, sender: u32) -> Option<&str> {
        match sender {
            OUTSIDE => Some(OUTSIDE_NAME),
            _ => self.shared.names.get(sender).map(AsRef::as_ref).or_else(|| self.shared.remote_names.get(sender)),
        }
    }

    fn now(&self) -> Time {
        Time::from_nanos(if self.shared.clock.is_virtual() { self.part.now } else { self.shared.clock.now() })
    }

    fn date(&self) -> Option<Duration> {
        self.shared.clock.date()
    }

    fn due(&self) -> Time {
        Time::from_nanos(self.part.due)
    }

    fn execution(&self) -> u64 {
        self.part.execution
    }

    fn period(&self) -> Duration {
        Duration::from_nanos(self.part.period)
    }

    fn cancelled(&self) -> bool {
        self.part.is_cancelled()
    }

    fn chance(&mut self) -> &mut Chance {
        &mut self.part.chance
    }

    fn publish(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        self.may_use(topic.name, TopicUse::Publish)?;
        let name = self.spec().topic(topic.name);
        let observers = self.shared.observers.of_topic(&name, topic);
        let mut engine = self.shared.lock();
        engine.may_act(self.part)?;
        let bus = &mut engine.bus;
        self.is_as_declared(topic, TopicUse::Publish, bus.find(&name).is_none())?;
        let id = bus
            .publisher(&name, topic, &self.part.name)
            .map_err(|mismatch| self.differs(topic, TopicUse::Publish, mismatch))?;
        bus.observe(id, &observers);
        let network = engine.slots[self.part.index as usize].network;
        if network != NO_NETWORK {
            engine.publish_on_network(network, id);
        }
        engine.note_publisher(self.part, id);
        drop(engine);
        self.part.publishers.push(id);
        Ok((self.part.publishers.len() - 1) as u32)
    }

    fn subscribe(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        let Some(task) = self.may_use(topic.name, TopicUse::Subscribe)? else {
            return Err(Failure::new(format!(
                "topic `{}`: a passive component has no periods in which it could receive, and cannot subscribe",
                topic.name
            )));
        };
        let name = self.spec().topic(topic.name);
        // Events from outside have no publisher.
        let takes = self.spec().class.declaration().takes.iter().any(|taken| taken.topic == topic.name);
        let observers = if takes { self.shared.observers.of_topic(&name, topic) } else { Vec::new() };
        let mut engine = self.shared.lock();
        engine.may_act(self.part)?;
        self.is_as_declared(topic, TopicUse::Subscribe, engine.bus.find(&name).is_none())?;
        let fresh = engine
            .bus
            .subscribe(&name, topic, &self.part.name, task.queue)
            .map_err(|mismatch| self.differs(topic, TopicUse::Subscribe, mismatch))?;
        let id = engine.bus.topic_of(&fresh);
        engine.bus.observe(id, &observers);
        let network = engine.slots[self.part.index as usize].network;
        if network != NO_NETWORK {
            engine.read_from_network(network, id);
        }
        // An instance that replaces a failed one gets the events that came meanwhile.
        let same = |kept: &crate::bus::TopicReader| engine.bus.topic_of(kept) == engine.bus.topic_of(&fresh);
        let triggers = task.trigger.has(topic.name);
        let mut subscription = match self.part.kept.iter().position(same) {
            Some(place) => {
                let mut kept = self.part.kept.swap_remove(place);
                engine.bus.unsubscribe(fresh);
                engine.bus.rewind(&mut kept);
                kept
            }
            None => {
                engine.bus.register(&fresh, self.part.index);
                fresh
            }
        };
        if triggers {
            engine.bus.set_trigger(&mut subscription, self.part.index);
        }
        if !engine.faults.is_quiet() {
            let topic = engine.bus.topic_of(&subscription);
            engine.link(topic);
        }
        engine.note_reader(self.part, &subscription);
        drop(engine);
        self.part.subscriptions.push(subscription);
        Ok((self.part.subscriptions.len() - 1) as u32)
    }

    #[inline]
    fn send(&mut self, publisher: u32, message: SharedMessage) -> Result<(), Failure> {
        match self.part.publishers.get(publisher as usize).copied() {
            Some(topic) => {
                let mut message = message;
                if !message.is_value() {
                    message = self.check(topic, message)?;
                    self.part.sent_bytes += message.bytes().len();
                }
                self.may_send()?;
                if self.shared.store.get().is_some() && self.spec().url().is_some() {
                    // An event of a network is kept until others have received it.
                    self.may_keep()?;
                }
                self.part.outbox.push((topic, message));
                self.part.recorder.acted();
                Ok(())
            }
            None => Err(Failure::new(
                "this publisher belongs to no topic: keep what `Context::publish` returned in `initialize`",
            )),
        }
    }

    #[cold]
    fn raise(&mut self, event: &str) -> Result<(), Failure> {
        if event.len() > MAX_EVENT {
            return Err(Failure::new(format!("an event of {} bytes is longer than {MAX_EVENT}", event.len())));
        }
        if !self.part.spent.has_record() {
            return self.part.spent.is_within();
        }
        self.may_act()?;
        if event == STOP {
            let mut engine = self.shared.lock();
            engine.may_act(self.part)?;
            engine.note_caller(self.part.index);
            engine.request(self.part.index, Request::Unschedule, self.part.now);
            self.shared.release(engine);
            return Ok(());
        }
        let refused = |fault: &dyn fmt::Display| Failure::new(format!("event `{event}`: {fault}"));
        if FaultCall::is_one(event) {
            let call = FaultCall::read(event).map_err(|fault| refused(&fault))?;
            let mut engine = self.shared.lock();
            engine.may_act(self.part)?;
            let cause = engine.record_outside(self.part.now, &self.part.name, event.to_owned());
            engine.begin_fault((&call, cause), &self.part.spec.site, self.part.now);
            self.shared.release(engine);
            self.part.recorder.acted();
            return Ok(());
        }
        let call = EventCall::read(event).map_err(|fault| refused(&fault))?;
        let takers = self.shared.takers();
        let messages = match takers.take(&self.spec().site, &call.name.text) {
            true => takers.messages(&self.spec().site, &call).map_err(|fault| refused(&fault))?,
            false => Vec::new(),
        };
        let sent = Time::from_nanos(self.part.due);
        let mut cause = None;
        for EventMessage { topic, to, bytes, marks: (key, place) } in messages {
            let mut engine = self.shared.lock();
            engine.may_act(self.part)?;
            // A component that is not scheduled reads no topic.
            let Some(topic) = engine.bus.find(&topic) else { continue };
            let now = self.part.now;
            let cause = *cause.get_or_insert_with(|| engine.record_outside(now, &self.part.name, event.to_owned()));
            drop(engine);
            self.part.sent_bytes += bytes.len();
            self.may_send()?;
            let header = Header { sender: self.part.index, sent, cause };
            let message = SharedMessage::from_bytes(header, None, bytes).of(key, place).only_to(to);
            self.part.outbox.push((topic, message));
        }
        if cause.is_some() {
            self.part.has_raised = true;
            self.part.recorder.acted();
        } else {
            self.has_no_receiver(&call.name.text, event);
        }
        Ok(())
    }

    fn reference(&mut self, name: &str, interface: &str) -> Result<u32, Failure> {
        let wires = &self.spec().references;
        let found = wires.iter().position(|wire| wire.reference == name && wire.interface == interface);
        if let Some(place) = found {
            return Ok(place as u32);
        }
        let known: Vec<String> =
            wires.iter().map(|wire| format!("`{}` ({})", wire.reference, wire.interface)).collect();
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        Err(Failure::new(format!(
            "class `{}` declares no reference `{name}` with the interface `{interface}`; it declares: {known}",
            self.spec().class.name()
        )))
    }

    fn set_region(&mut self, subscription: u32, region: Option<Region>) -> Result<(), Failure> {
        let queue = self.spec().task.as_ref().map_or(Some(1), |task| task.queue);
        let Some(reader) = self.part.subscriptions.get(subscription as usize) else {
            return Err(Failure::new("this subscription belongs to no topic: keep what `Context::subscribe` returned"));
        };
        let topic = self.shared.lock().bus.topic_of(reader);
        if region.is_some() && !self.schema(topic)?.has_place() {
            let name = self.shared.lock().bus.name(topic).to_string();
            return Err(Failure::new(format!(
                "topic `{name}`: its messages have no block, so a subscription can have no region: declare which field \
                 is their `place`"
            )));
        }
        let mut engine = self.shared.lock();
        engine.may_act(self.part)?;
        let reader = &mut self.part.subscriptions[subscription as usize];
        let was_in_region = engine.bus.has_region(reader);
        engine.bus.set_region(reader, region, queue);
        engine.tell_interest(topic);
        if !(was_in_region && region.is_some()) {
            self.part.collection.published = 0;
        }
        Ok(())
    }

    fn publishers(&self, topic: &str) -> Vec<KnownPublisher> {
        self.shared.publishers(&self.spec().topic(topic), self.part.index)
    }

    fn speaker(&self, topic: &str, number: u32) -> Option<u32> {
        self.shared.speaker(&self.spec().topic(topic), number)
    }

    fn departed(&self, subscription: u32) -> &[Departed] {
        self.part.departed.get(subscription as usize).map_or(&[], Vec::as_slice)
    }

    fn keep(&mut self, key: u64, bytes: &[u8]) -> Result<(), Failure> {
        self.may_keep()?;
        let part = &mut *self.part;
        let others = part.to_keep.iter().filter(|(other, _)| *other != key);
        let waiting: usize = others.filter_map(|(_, bytes)| bytes.as_ref()).map(|bytes| bytes.len()).sum();
        let before = part.stored.entries().get(&key).map_or(0, |bytes| bytes.len());
        let size = waiting + part.stored.size() - before + bytes.len();
        if size > saoms_abi::MAX_BYTES {
            let most = saoms_abi::MAX_BYTES >> 20;
            return Err(Failure::new(format!("{size} bytes are more than a component can keep: {most} MiB")));
        }
        part.to_keep.push((key, (!bytes.is_empty()).then(|| Arc::from(bytes))));
        Ok(())
    }

    fn kept(&self) -> BTreeMap<u64, &[u8]> {
        self.part.stored.entries().iter().map(|(key, bytes)| (*key, &**bytes)).collect()
    }

    fn kept_by_earlier_program(&self) -> bool {
        self.part.stored.is_earlier()
    }

    fn kept_by_others(&self) -> Vec<KeptByOther<'_>> {
        self.part.estate.kept_by_others(self.part.index, self.spec())
    }

    fn goes_on(&self) -> bool {
        self.part.lasting.goes_on()
    }

    fn goes_on_from_earlier_program(&self) -> bool {
        self.part.lasting.goes_on() && self.part.lasting.is_recalled()
    }

    fn register_stop(&mut self, stop: StopFunction) -> Result<(), Failure> {
        if !self.part.initializing {
            return Err(Failure::new(
                "a component can only register a function that stops its hardware in `initialize`",
            ));
        }
        let class = &self.spec().class;
        if !class.declaration().stops {
            return Err(Failure::new(format!(
                "class `{}` does not declare that it stops hardware: write `stops` in its `#[class(...)]`",
                class.name()
            )));
        }
        if self.part.stops.len() >= MAX_HANDLES {
            return Err(Failure::new(format!(
                "a component can register at most {MAX_HANDLES} functions that stop its hardware"
            )));
        }
        let registered = self.shared.stops.register(self.part.index, &self.part.name, stop);
        self.part.stops.push(Arc::clone(&registered));
        // Code that is left behind from now on has its functions called; before, nobody knew this one.
        self.may_act().inspect_err(|_| self.shared.stops.request(&[registered]))
    }

    fn is_wired(&self, reference: u32) -> bool {
        self.wire(reference).is_some_and(|wire| wire.ends() > (reference >> TARGET_SHIFT) as usize)
    }

    fn targets(&self, reference: u32) -> u32 {
        // No real fleet has more targets than a handle can address.
        self.wire(reference).map_or(0, |wire| wire.ends().min(MOST_TARGETS)) as u32
    }

    fn call(&mut self, reference: u32, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        self.part.recorder.acted();
        super::call::call(self.shared, self.part, reference, call)
    }

    fn loops(&mut self) -> Result<NamedLoops, Failure> {
        (0..self.spec().loops.len())
            .map(|place| Ok((self.spec().loops[place].name.clone(), self.chosen_loop(place as u32)?)))
            .collect()
    }

    fn chosen_loops(&mut self, visit: &mut LoopVisit<'_>) {
        for one in self.spec().loops.iter() {
            visit(&one.name, one.class.name(), &one.values);
        }
    }

    fn chosen_loop(&mut self, place: u32) -> Result<Box<dyn DynLoop>, Failure> {
        self.construct_loop(place)
    }

    fn name_loop(&mut self, place: u32, name: &str) {
        if self.part.spent.has_record() {
            self.part.recorder.name(place, name);
        }
    }

    fn enter_loop(&mut self, place: Option<u32>) {
        self.part.recorder.enter(place, self.part.execution);
    }

    fn because(&mut self, cause: Cause) {
        self.part.recorder.because(cause);
    }

    #[inline]
    fn cause(&self) -> Cause {
        self.part.recorder.cause()
    }

    fn journal(&mut self, phase: Phase, record: &Record) {
        if self.part.spent.has_record() {
            self.write_record(phase, record);
        }
    }

    fn changed(&mut self, entry: &'static str, before: Value, after: Value) {
        if self.part.spent.has_record() {
            self.write_change(entry, before, after);
        }
    }

    fn listens(&self, level: Option<Level>) -> bool {
        level.map_or_else(|| self.shared.events.wants_console(), |level| self.shared.events.wants(level))
    }

    fn log(&mut self, level: Level, line: fmt::Arguments<'_>) {
        if self.part.spent.has_line() && self.shared.events.wants(level) {
            let mut text = line.to_string();
            // That of a library was shortened when it came.
            if self.spec().class.origin().is_none() {
                text = shown(text.as_bytes()).into_owned();
            }
            self.emit(Occurrence::Log { level, text });
        }
    }

    fn alert(&mut self, kind: &str, subject: &str, line: Option<fmt::Arguments<'_>>) {
        if self.part.spent.has_line() && self.may_act().is_ok() {
            let text = line.map(|line| line.to_string());
            self.part.note_alert(kind, subject, text.as_deref());
            let (kind, subject) = (kind.into(), subject.into());
            self.emit(Occurrence::Alert { kind, subject, text });
        }
    }

    fn console(&mut self, line: fmt::Arguments<'_>) {
        if self.part.spent.has_line() && self.shared.events.wants_console() {
            self.emit(Occurrence::Console { text: line.to_string() });
        }
    }

    fn report(&mut self, path: &str, value: ReportValue) {
        if self.may_report(path) && self.may_act().is_ok() && !self.shared.sections().set(path, value) {
            self.cannot_report(path);
        }
    }

    fn count(&mut self, path: &str, more: i64) {
        if !self.may_report(path) || self.may_act().is_err() {
            return;
        }
        if self.shared.sections().add_in_code(path, more, (self.part.index, self.part.code)) {
            self.part.lasting.note_count(path, more);
        } else {
            self.cannot_report(path);
        }
    }

    fn vote(&mut self, work: Work) {
        self.part.vote.get_or_insert_default().mark(work);
    }
}

impl ComponentHost<'_> {
    /// Judges whether its code may act on others: not if a change has left it behind.
    fn may_act(&self) -> Result<(), Failure> {
        if self.part.apart.is_some() { self.shared.look(|engine| engine.may_act(self.part)) } else { Ok(()) }
    }

    pub(super) fn emit(&self, what: Occurrence) {
        self.shared.events.put(RunEvent { time: self.now(), component: Some(Arc::clone(&self.part.name)), what });
    }
}
