mod given;

use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

use saoms_api::host::contain::contained;
use saoms_api::host::{DynLoop, Host, LoopVisit, NamedLoops, Phase, ServiceCall, SharedMessage, TopicDeclaration, cdr};
use saoms_api::{
    CallError, Cause, Chance, Departed, Failure, KeptByOther, KnownPublisher, Level, Record, Region, ReportValue,
    StopFunction, Time, Value, Work,
};
use saoms_lang::registry::{RegisteredClass, RegisteredLoop, Registry};

use super::answers::{Answers, Calls};
use super::told::Interfaces;
use super::{Refusals, Values};
use crate::journal::{Recorder, Stamp};
use crate::tape::{Act, ActKind, KeptForm, PublisherForm, Step, StepKind, answer_of};

/// Records that were not written then have numbers from here on.
const FRESH: u64 = 1 << 62;

/// The host of a component that is replayed: it answers from the tape, and notes what the component does.
pub(super) struct ReplayHost {
    name: String,
    sender: u32,
    pub(super) is_initializing: bool,
    time: u64,
    due: u64,
    execution: u64,
    /// What it did in the present step.
    pub(super) deeds: Vec<Act>,
    recorder: Recorder,
    /// The numbers of the records of the present step on the tape, the next one last; then fresh ones.
    record_ids: Vec<u64>,
    fresh: u64,
    answers: Answers,
    calls: Calls,
    refusals: Refusals,
    refused_names: HashMap<(ActKind, String), String>,
    chance: Chance,
    loops: Vec<ReplayLoop>,
    said: BTreeMap<u16, String>,
    /// The topics with their schemas: those of the tape by their numbers, and those of today in order.
    pub(super) publishers_then: BTreeMap<u64, (String, String)>,
    subscriptions_then: BTreeMap<u64, (String, String)>,
    pub(super) publishers: Vec<(String, String)>,
    subscriptions: Vec<String>,
    /// What the present step gives to read.
    pub(super) inboxes: Vec<Vec<SharedMessage>>,
    departed: Vec<Vec<Departed>>,
    kept: BTreeMap<u64, Vec<u8>>,
    to_keep: Vec<(u64, Vec<u8>)>,
    others: Vec<KeptForm>,
    names: HashMap<u32, String>,
    /// References by their handles on the tape, and how many are new.
    pub(super) references: BTreeMap<u32, (String, String)>,
    new_references: u32,
    pub(super) interfaces: Interfaces,
}

struct ReplayLoop {
    name: String,
    class_name: String,
    class: Option<Arc<RegisteredLoop>>,
    values: Values,
}

impl ReplayHost {
    pub(super) fn new(name: &str) -> ReplayHost {
        ReplayHost {
            name: name.to_owned(),
            sender: 0,
            is_initializing: false,
            time: 0,
            due: 0,
            execution: 0,
            deeds: Vec::new(),
            recorder: Recorder::default(),
            record_ids: Vec::new(),
            fresh: FRESH,
            answers: Answers::default(),
            calls: Calls::default(),
            refusals: Refusals::new(),
            refused_names: HashMap::new(),
            chance: Chance::new(0),
            loops: Vec::new(),
            said: BTreeMap::new(),
            publishers_then: BTreeMap::new(),
            subscriptions_then: BTreeMap::new(),
            publishers: Vec::new(),
            subscriptions: Vec::new(),
            inboxes: Vec::new(),
            departed: Vec::new(),
            kept: BTreeMap::new(),
            to_keep: Vec::new(),
            others: Vec::new(),
            names: HashMap::new(),
            references: BTreeMap::new(),
            new_references: 0,
            interfaces: Interfaces::default(),
        }
    }

    /// Takes in what a step gives.
    pub(super) fn begin(&mut self, step: &Step) {
        if step.kind == StepKind::Start {
            let new = ReplayHost::new(&self.name);
            let (interfaces, fresh) = (std::mem::take(&mut self.interfaces), self.fresh);
            *self = ReplayHost { is_initializing: true, interfaces, fresh, ..new };
        }
        (self.time, self.due, self.execution) = (step.time, step.due, step.execution);
        self.recorder.begin(Cause(step.cause));
        self.answers.begin(step);
        self.calls.begin(step);
        self.deeds.clear();
        self.refusals.clear();
        self.record_ids = step.acts.iter().rev().filter(|act| act.what.is_record()).map(|act| act.number).collect();
        let mut counts: HashMap<ActKind, usize> = HashMap::new();
        for (place, act) in step.acts.iter().enumerate() {
            let number = counts.entry(act.what).or_default();
            let refusal = step.acts.get(place + 1).filter(|next| next.what == ActKind::Refused);
            if let Some(refusal) = refusal {
                let text = refusal.text().into_owned();
                self.refused_names.insert((act.what, act.name.clone()), text.clone());
                self.refusals.insert((act.what, *number), text);
            }
            *number += 1;
            self.take(act, refusal.is_some());
        }
        self.give(step);
    }

    /// Sets a new instance up, whose class and loops are those of today.
    pub(super) fn set_up(
        &mut self,
        class: &Arc<RegisteredClass>,
        loops: &[(String, String, Values)],
        registry: &Registry,
    ) {
        self.loops = loops
            .iter()
            .map(|(name, class, values)| ReplayLoop {
                name: name.clone(),
                class_name: class.clone(),
                class: registry.get_loop(class).cloned(),
                values: values.clone(),
            })
            .collect();
        let of_loops = self.loops.iter().filter_map(|one| one.class.as_ref());
        let of_loops = of_loops.flat_map(|class| &class.declaration().references);
        self.interfaces = Interfaces::of(class.declaration().references.iter().chain(of_loops));
    }

    /// Ends a step, which has failed or not.
    pub(super) fn end(&mut self, is_done: bool) {
        let kept = std::mem::take(&mut self.to_keep);
        for (key, bytes) in kept.into_iter().filter(|_| is_done) {
            match bytes.is_empty() {
                true => drop(self.kept.remove(&key)),
                false => drop(self.kept.insert(key, bytes)),
            }
        }
        self.recorder.batch.clear();
        self.recorder.notices.clear();
    }

    pub(super) fn has_departed(&self) -> bool {
        self.departed.iter().any(|departed| !departed.is_empty())
    }

    /// Names the loop whose code panicked, if it was one.
    pub(super) fn of_loop(&self, panic: Failure) -> Failure {
        match self.recorder.present().and_then(|place| self.loops.get(usize::from(place))) {
            Some(one) => Failure::new(format!("loop `{}`: {panic}", one.name)),
            None => panic,
        }
    }

    /// Notes what the component does.
    pub(super) fn note(&mut self, act: Act) {
        self.deeds.push(act);
    }

    /// The same where the host refused it then.
    fn did(&mut self, act: Act) -> Result<(), Failure> {
        let number = self.deeds.iter().filter(|deed| deed.what == act.what).count();
        let refusal = self.refusals.get(&(act.what, number));
        let result = refusal.map_or(Ok(()), |text| Err(Failure::new(text.clone())));
        self.note(act);
        result
    }

    /// Has the recorder write to the journal. The records have the numbers that they had then, so that causes are the
    /// same.
    fn write(&mut self, write: impl FnOnce(&mut Recorder, Stamp<'_>)) {
        let next = self.record_ids.last().copied().unwrap_or(self.fresh);
        let ids = AtomicU64::new(next.saturating_sub(1));
        let before = self.recorder.batch.len();
        write(&mut self.recorder, Stamp { ids: &ids, component: self.sender, time: self.time });
        let batch = &self.recorder.batch;
        for head in batch.heads().get(before..).unwrap_or_default() {
            let given = self.loops.get(usize::from(head.place)).map(|one| one.name.as_str());
            let by = self.said.get(&head.place).map(String::as_str).or(given).unwrap_or_default();
            self.deeds.push(Act::record(head, batch, by));
            if self.record_ids.pop().is_none() {
                self.fresh += 1;
            }
        }
    }

    /// What was recorded of a topic has to be what the code of today understands.
    fn understands(&self, topic: &TopicDeclaration<'_>) -> Result<(), Failure> {
        let then = self.subscriptions_then.values().find(|(name, _)| name == topic.name);
        match then.is_none_or(|(_, schema)| schema == topic.schema) {
            true => Ok(()),
            false => Err(Failure::new(format!(
                "topic `{}`: its messages had another form when they were recorded, and cannot be replayed",
                topic.name
            ))),
        }
    }

    fn refused(&self, what: ActKind, name: &str) -> Result<(), Failure> {
        let refusal = self.refused_names.get(&(what, name.to_owned()));
        refusal.map_or(Ok(()), |text| Err(Failure::new(text.clone())))
    }
}

fn nanos(bytes: &[u8]) -> Option<u64> {
    Some(u64::from_le_bytes(bytes.try_into().ok()?))
}

fn number(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.try_into().ok()?))
}

impl Host for ReplayHost {
    fn name(&self) -> &str {
        &self.name
    }

    fn sender(&self) -> u32 {
        self.sender
    }

    fn name_of(&self, sender: u32) -> Option<&str> {
        self.names.get(&sender).map(String::as_str).filter(|name| !name.is_empty())
    }

    fn now(&self) -> Time {
        Time::from_nanos(nanos(&self.answers.read(ActKind::Now)).unwrap_or(self.time))
    }

    fn date(&self) -> Option<Duration> {
        nanos(&self.answers.read(ActKind::Date)).map(Duration::from_nanos)
    }

    fn due(&self) -> Time {
        Time::from_nanos(self.due)
    }

    fn execution(&self) -> u64 {
        self.execution
    }

    fn period(&self) -> Duration {
        let known = self.answers.known(ActKind::Period, 0, "").and_then(nanos);
        Duration::from_nanos(known.unwrap_or_default())
    }

    fn cancelled(&self) -> bool {
        self.answers.read(ActKind::Cancelled).first().is_some_and(|byte| *byte != 0)
    }

    fn chance(&mut self) -> &mut Chance {
        &mut self.chance
    }

    fn publish(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        self.refused(ActKind::Publisher, topic.name)?;
        self.publishers.push((topic.name.to_owned(), topic.schema.to_owned()));
        Ok((self.publishers.len() - 1) as u32)
    }

    fn subscribe(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        self.refused(ActKind::Subscription, topic.name)?;
        self.understands(topic)?;
        self.subscriptions.push(topic.name.to_owned());
        Ok((self.subscriptions.len() - 1) as u32)
    }

    fn send(&mut self, publisher: u32, message: SharedMessage) -> Result<(), Failure> {
        let Some((topic, _)) = self.publishers.get(publisher as usize) else {
            return Err(Failure::new("this publisher belongs to no topic"));
        };
        let act = Act::sent(topic, &message);
        self.recorder.acted();
        self.did(act)
    }

    fn raise(&mut self, event: &str) -> Result<(), Failure> {
        self.recorder.acted();
        self.did(Act::new(ActKind::Raised, 0, event))
    }

    fn reference(&mut self, name: &str, interface: &str) -> Result<u32, Failure> {
        let known = self.references.iter().find(|(_, known)| (known.0.as_str(), known.1.as_str()) == (name, interface));
        if let Some((handle, _)) = known {
            return Ok(*handle);
        }
        self.refused(ActKind::Reference, name)?;
        // It leads nowhere: the tape has no answers of it.
        self.new_references += 1;
        let handle = u32::from(u16::MAX) - self.new_references;
        self.references.insert(handle, (name.to_owned(), interface.to_owned()));
        Ok(handle)
    }

    fn is_wired(&self, reference: u32) -> bool {
        self.answers.yes(ActKind::IsWired, u64::from(reference))
    }

    fn targets(&self, reference: u32) -> u32 {
        self.answers.known(ActKind::Targets, u64::from(reference), "").and_then(number).unwrap_or(0)
    }

    fn call(&mut self, reference: u32, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        self.recorder.acted();
        let (operation, arguments) = (call.operation(), call.arguments());
        self.note(Act::called(reference, operation, &arguments));
        match self.calls.answer(reference, operation, &arguments) {
            Some(answer) => call.reply(answer_of(&answer)?),
            None => {
                let failure = Failure::new("it was not called so when this was recorded: there is no answer");
                Err(CallError::Failed { provider: String::new(), failure })
            }
        }
    }

    fn set_region(&mut self, subscription: u32, region: Option<Region>) -> Result<(), Failure> {
        self.did(Act::region(subscription, region))
    }

    fn publishers(&self, topic: &str) -> Vec<KnownPublisher> {
        let known = self.answers.known(ActKind::Publishers, 0, topic);
        let forms: Vec<PublisherForm> = known.and_then(|bytes| cdr::decode(bytes).ok()).unwrap_or_default();
        forms.into_iter().map(PublisherForm::publisher).collect()
    }

    fn speaker(&self, topic: &str, number_of: u32) -> Option<u32> {
        self.answers.known(ActKind::Speaker, u64::from(number_of), topic).and_then(number)
    }

    fn departed(&self, subscription: u32) -> &[Departed] {
        self.departed.get(subscription as usize).map_or(&[], Vec::as_slice)
    }

    fn keep(&mut self, key: u64, bytes: &[u8]) -> Result<(), Failure> {
        self.did(Act::new(ActKind::Keeps, key, "").with(bytes))?;
        self.to_keep.push((key, bytes.to_vec()));
        Ok(())
    }

    fn kept(&self) -> BTreeMap<u64, &[u8]> {
        self.kept.iter().map(|(key, bytes)| (*key, bytes.as_slice())).collect()
    }

    fn kept_by_earlier_program(&self) -> bool {
        self.answers.yes(ActKind::KeptByEarlier, 0)
    }

    fn kept_by_others(&self) -> Vec<KeptByOther<'_>> {
        self.others.iter().map(KeptForm::kept).collect()
    }

    fn goes_on(&self) -> bool {
        self.answers.yes(ActKind::GoesOn, 0)
    }

    fn goes_on_from_earlier_program(&self) -> bool {
        self.answers.known(ActKind::GoesOn, 0, "").is_some_and(|bytes| bytes == [2])
    }

    fn register_stop(&mut self, stop: StopFunction) -> Result<(), Failure> {
        // There is no hardware.
        drop(stop);
        Ok(())
    }

    fn loops(&mut self) -> Result<NamedLoops, Failure> {
        (0..self.loops.len())
            .map(|place| Ok((self.loops[place].name.clone(), self.chosen_loop(place as u32)?)))
            .collect()
    }

    fn chosen_loops(&mut self, visit: &mut LoopVisit<'_>) {
        for one in &self.loops {
            visit(&one.name, &one.class_name, &one.values);
        }
    }

    fn chosen_loop(&mut self, place: u32) -> Result<Box<dyn DynLoop>, Failure> {
        if !self.is_initializing {
            return Err(Failure::new("take the loops in `initialize`, and keep what `loops` returns"));
        }
        let one = self.loops.get(place as usize).ok_or("there are fewer loops")?;
        let Some(class) = &one.class else {
            let name = &one.class_name;
            return Err(Failure::new(format!("there is no loop `{name}`: name its library by `--plugin`")));
        };
        let constructed = contained(|| class.construct(&one.values)).and_then(|made| made);
        constructed.map_err(|failure| Failure::new(format!("loop `{}`: {failure}", one.name)))
    }

    fn name_loop(&mut self, place: u32, name: &str) {
        if let Ok(place) = u16::try_from(place) {
            self.said.insert(place, name.to_owned());
        }
    }

    fn enter_loop(&mut self, place: Option<u32>) {
        self.recorder.enter(place, self.execution);
    }

    fn because(&mut self, cause: Cause) {
        self.recorder.because(cause);
    }

    fn cause(&self) -> Cause {
        self.recorder.cause()
    }

    fn journal(&mut self, phase: Phase, record: &Record) {
        let place = self.recorder.present().map(usize::from);
        let class = place.and_then(|place| self.loops.get(place)).and_then(|one| one.class.clone());
        self.write(|recorder, stamp| {
            let senses = class.as_ref().map_or(&[][..], |class| &class.declaration().senses);
            recorder.write(stamp, phase, record, senses);
        });
    }

    fn changed(&mut self, entry: &'static str, before: Value, after: Value) {
        self.write(|recorder, stamp| recorder.changed(stamp, entry, before, after));
    }

    fn listens(&self, level: Option<Level>) -> bool {
        self.answers.yes(ActKind::Listens, level.map_or(u64::MAX, |level| level as u64))
    }

    fn log(&mut self, level: Level, line: fmt::Arguments<'_>) {
        // Lines for people decide nothing.
        let _ = (level, line);
    }

    fn alert(&mut self, kind: &str, subject: &str, line: Option<fmt::Arguments<'_>>) {
        self.note(Act::alert(kind, subject, line.map(|line| line.to_string())));
    }

    fn console(&mut self, line: fmt::Arguments<'_>) {
        let _ = line;
    }

    fn report(&mut self, path: &str, value: ReportValue) {
        self.note(Act::reported(path, &value));
    }

    fn count(&mut self, path: &str, more: i64) {
        self.note(Act::counted(path, more));
    }

    fn vote(&mut self, work: Work) {
        self.note(Act::voted(work));
    }
}
