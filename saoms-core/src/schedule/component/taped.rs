//! The seam at which the tape of a component is written: a host that notes what the one behind it gives and takes.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use saoms_api::host::{DynLoop, Host, LoopVisit, NamedLoops, Phase, ServiceCall, SharedMessage, TopicDeclaration, cdr};
use saoms_api::{
    CallError, Cause, Chance, Departed, Failure, KeptByOther, KnownPublisher, Level, Record, Region, ReportValue,
    StopFunction, Time, Value, Work,
};

use super::host::ComponentHost;
use crate::tape::{Act, ActKind, KeptForm, PublisherForm, Tape, TapedCall, answered};

/// The host of a component whose tape is written.
pub(super) struct TapedHost<'a> {
    host: ComponentHost<'a>,
    tape: RefCell<Box<Tape>>,
}

impl<'a> TapedHost<'a> {
    pub(super) fn new(host: ComponentHost<'a>, tape: Box<Tape>) -> TapedHost<'a> {
        TapedHost { host, tape: RefCell::new(tape) }
    }

    /// The host behind it, whose component has its tape again.
    pub(super) fn into_host(self) -> ComponentHost<'a> {
        let TapedHost { host, tape } = self;
        host.part.tape = Some(tape.into_inner());
        host
    }

    /// Notes the answer to a question.
    fn answered(&self, what: ActKind, number: u64, name: &str, answer: &[u8]) {
        self.tape.borrow_mut().answered(what, number, name, answer);
    }

    fn yes_or_no(&self, what: ActKind, number: u64, answer: bool) -> bool {
        self.answered(what, number, "", &[u8::from(answer)]);
        answer
    }

    fn note_goes_on(&self) {
        let goes_on = u8::from(self.host.goes_on()) + u8::from(self.host.goes_on_from_earlier_program());
        self.answered(ActKind::GoesOn, 0, "", &[goes_on]);
    }

    /// Notes what the component does, and whether the host refused it.
    fn did<T, E: fmt::Display>(&mut self, act: Act, result: Result<T, E>) -> Result<T, E> {
        let tape = self.tape.get_mut();
        tape.note(act);
        tape.note_refusal(&result);
        result
    }

    /// Notes the records that the host has written since it had so many.
    fn note_records(&mut self, before: usize) {
        let tape = self.tape.get_mut();
        let batch = &self.host.part.recorder.batch;
        for head in batch.heads().get(before..).unwrap_or_default() {
            let loops = &self.host.part.spec.loops;
            let given = loops.get(usize::from(head.place)).map(|one| one.name.as_str());
            let by = tape.loops.get(&head.place).map(String::as_str).or(given).unwrap_or_default().to_owned();
            tape.note(Act::record(head, batch, &by));
        }
    }
}

impl Host for TapedHost<'_> {
    fn name(&self) -> &str {
        self.host.name()
    }

    fn sender(&self) -> u32 {
        self.host.sender()
    }

    fn name_of(&self, sender: u32) -> Option<&str> {
        let name = self.host.name_of(sender);
        self.answered(ActKind::NameOf, u64::from(sender), "", name.unwrap_or_default().as_bytes());
        name
    }

    fn now(&self) -> Time {
        let now = self.host.now();
        self.answered(ActKind::Now, 0, "", &now.as_nanos().to_le_bytes());
        now
    }

    fn date(&self) -> Option<Duration> {
        let date = self.host.date();
        let bytes = date.map(|date| (date.as_nanos() as u64).to_le_bytes());
        self.answered(ActKind::Date, 0, "", bytes.as_ref().map_or(&[], |bytes| bytes.as_slice()));
        date
    }

    fn due(&self) -> Time {
        self.host.due()
    }

    fn execution(&self) -> u64 {
        self.host.execution()
    }

    fn period(&self) -> Duration {
        let period = self.host.period();
        self.answered(ActKind::Period, 0, "", &(period.as_nanos() as u64).to_le_bytes());
        period
    }

    fn cancelled(&self) -> bool {
        self.yes_or_no(ActKind::Cancelled, 0, self.host.cancelled())
    }

    fn chance(&mut self) -> &mut Chance {
        let chance = self.host.chance();
        self.tape.get_mut().draws(|| cdr::encode(chance));
        chance
    }

    fn publish(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        let result = self.host.publish(topic);
        let tape = self.tape.get_mut();
        if let Ok(number) = result {
            let place = number as usize;
            if tape.publishers.len() <= place {
                tape.publishers.resize(place + 1, String::new());
            }
            tape.publishers[place] = topic.name.to_owned();
        }
        let number = result.as_ref().map_or(0, |number| u64::from(*number));
        self.did(Act::new(ActKind::Publisher, number, topic.name).with(topic.schema), result)
    }

    fn subscribe(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        let result = self.host.subscribe(topic);
        let number = result.as_ref().map_or(0, |number| u64::from(*number));
        self.did(Act::new(ActKind::Subscription, number, topic.name).with(topic.schema), result)
    }

    fn send(&mut self, publisher: u32, message: SharedMessage) -> Result<(), Failure> {
        let tape = self.tape.get_mut();
        let topic = tape.publishers.get(publisher as usize).map_or("", String::as_str);
        let act = Act::sent(topic, &message);
        let result = self.host.send(publisher, message);
        self.did(act, result)
    }

    fn raise(&mut self, event: &str) -> Result<(), Failure> {
        let result = self.host.raise(event);
        self.did(Act::new(ActKind::Raised, 0, event), result)
    }

    fn reference(&mut self, name: &str, interface: &str) -> Result<u32, Failure> {
        let result = self.host.reference(name, interface);
        let number = result.as_ref().map_or(0, |number| u64::from(*number));
        self.did(Act::new(ActKind::Reference, number, name).with(interface), result)
    }

    fn is_wired(&self, reference: u32) -> bool {
        self.yes_or_no(ActKind::IsWired, u64::from(reference), self.host.is_wired(reference))
    }

    fn targets(&self, reference: u32) -> u32 {
        let targets = self.host.targets(reference);
        self.answered(ActKind::Targets, u64::from(reference), "", &targets.to_le_bytes());
        targets
    }

    fn call(&mut self, reference: u32, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        let mut taped = TapedCall::new(call);
        self.tape.get_mut().note(Act::called(reference, taped.operation(), &taped.arguments));
        let result = self.host.call(reference, &mut taped);
        let reply = taped.reply.unwrap_or_default();
        self.tape.get_mut().note(answered(ActKind::Answer, &result.clone().map(|()| reply)));
        result
    }

    fn set_region(&mut self, subscription: u32, region: Option<Region>) -> Result<(), Failure> {
        let result = self.host.set_region(subscription, region);
        self.did(Act::region(subscription, region), result)
    }

    fn publishers(&self, topic: &str) -> Vec<KnownPublisher> {
        let publishers = self.host.publishers(topic);
        let known: Vec<PublisherForm> = publishers.iter().map(PublisherForm::of).collect();
        self.answered(ActKind::Publishers, 0, topic, &cdr::encode(&known));
        publishers
    }

    fn speaker(&self, topic: &str, number: u32) -> Option<u32> {
        let speaker = self.host.speaker(topic, number);
        let bytes = speaker.map(u32::to_le_bytes);
        let bytes = bytes.as_ref().map_or(&[][..], |bytes| bytes);
        self.answered(ActKind::Speaker, u64::from(number), topic, bytes);
        speaker
    }

    fn departed(&self, subscription: u32) -> &[Departed] {
        self.host.departed(subscription)
    }

    fn keep(&mut self, key: u64, bytes: &[u8]) -> Result<(), Failure> {
        let result = self.host.keep(key, bytes);
        self.did(Act::new(ActKind::Keeps, key, "").with(bytes), result)
    }

    fn kept(&self) -> BTreeMap<u64, &[u8]> {
        self.host.kept()
    }

    fn kept_by_earlier_program(&self) -> bool {
        self.yes_or_no(ActKind::KeptByEarlier, 0, self.host.kept_by_earlier_program())
    }

    fn kept_by_others(&self) -> Vec<KeptByOther<'_>> {
        let others = self.host.kept_by_others();
        let forms: Vec<KeptForm> = others.iter().map(KeptForm::of).collect();
        self.answered(ActKind::KeptByOthers, 0, "", &cdr::encode(&forms));
        others
    }

    fn goes_on(&self) -> bool {
        self.note_goes_on();
        self.host.goes_on()
    }

    fn goes_on_from_earlier_program(&self) -> bool {
        self.note_goes_on();
        self.host.goes_on_from_earlier_program()
    }

    fn register_stop(&mut self, stop: StopFunction) -> Result<(), Failure> {
        self.host.register_stop(stop)
    }

    fn loops(&mut self) -> Result<NamedLoops, Failure> {
        self.host.loops()
    }

    fn chosen_loops(&mut self, visit: &mut LoopVisit<'_>) {
        self.host.chosen_loops(visit);
    }

    fn chosen_loop(&mut self, place: u32) -> Result<Box<dyn DynLoop>, Failure> {
        self.host.chosen_loop(place)
    }

    fn name_loop(&mut self, place: u32, name: &str) {
        if let Ok(place) = u16::try_from(place) {
            self.tape.get_mut().loops.insert(place, name.to_owned());
        }
        self.host.name_loop(place, name);
    }

    fn enter_loop(&mut self, place: Option<u32>) {
        self.host.enter_loop(place);
    }

    fn because(&mut self, cause: Cause) {
        self.host.because(cause);
    }

    fn cause(&self) -> Cause {
        self.host.cause()
    }

    fn journal(&mut self, phase: Phase, record: &Record) {
        let before = self.host.part.recorder.batch.len();
        self.host.journal(phase, record);
        self.note_records(before);
    }

    fn changed(&mut self, entry: &'static str, before: Value, after: Value) {
        let count = self.host.part.recorder.batch.len();
        self.host.changed(entry, before, after);
        self.note_records(count);
    }

    fn listens(&self, level: Option<Level>) -> bool {
        let listens = self.host.listens(level);
        self.yes_or_no(ActKind::Listens, level.map_or(u64::MAX, |level| level as u64), listens)
    }

    fn log(&mut self, level: Level, line: fmt::Arguments<'_>) {
        self.host.log(level, line);
    }

    fn alert(&mut self, kind: &str, subject: &str, line: Option<fmt::Arguments<'_>>) {
        self.tape.get_mut().note(Act::alert(kind, subject, line.map(|line| line.to_string())));
        self.host.alert(kind, subject, line);
    }

    fn console(&mut self, line: fmt::Arguments<'_>) {
        self.host.console(line);
    }

    fn report(&mut self, path: &str, value: ReportValue) {
        self.tape.get_mut().note(Act::reported(path, &value));
        self.host.report(path, value);
    }

    fn count(&mut self, path: &str, more: i64) {
        self.tape.get_mut().note(Act::counted(path, more));
        self.host.count(path, more);
    }

    fn vote(&mut self, work: Work) {
        self.tape.get_mut().note(Act::voted(work));
        self.host.vote(work);
    }
}
