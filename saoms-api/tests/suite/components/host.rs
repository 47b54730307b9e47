//! A host that a test can look into.

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use saoms_api::host::Host;
use saoms_api::host::{
    DynComponent, Invocation, LoopRegistration, NamedLoops, Operation, Phase, ServiceCall, SharedMessage,
    TopicDeclaration,
};
use saoms_api::{CallError, Cause, Chance, Context, Failure, Level, Record, ReportValue, Time, Value, Work};

/// Way in which calls reach the provider.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Boundary {
    /// Within one build of the program.
    None,
    /// Between two: only bytes pass.
    Bytes,
}

/// Notes down what its component does.
pub(crate) struct FakeHost {
    pub(crate) now: Time,
    pub(crate) chance: Chance,
    pub(crate) published: Vec<String>,
    pub(crate) subscribed: Vec<String>,
    pub(crate) sent: Vec<(u32, SharedMessage)>,
    pub(crate) lines: Vec<String>,
    pub(crate) report: Vec<(String, ReportValue)>,
    pub(crate) votes: Vec<Work>,
    /// Behind the only reference, with the name of its service.
    pub(crate) provider: Option<(Box<dyn DynComponent>, &'static str)>,
    pub(crate) boundary: Boundary,
    pub(crate) loops: &'static [(&'static str, LoopRegistration)],
    pub(crate) journal: Vec<String>,
}

impl FakeHost {
    pub(crate) fn new() -> FakeHost {
        FakeHost {
            now: Time::from_nanos(1_500_000_000),
            chance: Chance::for_component(0, "Fake"),
            published: Vec::new(),
            subscribed: Vec::new(),
            sent: Vec::new(),
            lines: Vec::new(),
            report: Vec::new(),
            votes: Vec::new(),
            provider: None,
            boundary: Boundary::None,
            loops: &[],
            journal: Vec::new(),
        }
    }

    /// Lets the work be done with no messages.
    pub(crate) fn run<R>(&mut self, work: impl FnOnce(&mut Context<'_>) -> R) -> R {
        work(&mut Context::new(self, &[]))
    }
}

impl Host for FakeHost {
    fn name(&self) -> &str {
        "hall/Fake"
    }

    fn sender(&self) -> u32 {
        3
    }

    fn now(&self) -> Time {
        self.now
    }

    fn due(&self) -> Time {
        Time::from_nanos(1_000_000_000)
    }

    fn execution(&self) -> u64 {
        2
    }

    fn date(&self) -> Option<Duration> {
        None
    }

    fn period(&self) -> Duration {
        Duration::from_millis(500)
    }

    fn raise(&mut self, event: &str) -> Result<(), Failure> {
        match event {
            "fire size=2 to Hall\u{fc}" => {
                self.lines.push(format!("raised {event}"));
                Ok(())
            }
            other => Err(Failure::new(format!("no component takes `{other}`"))),
        }
    }

    fn cancelled(&self) -> bool {
        false
    }

    fn chance(&mut self) -> &mut Chance {
        &mut self.chance
    }

    fn publish(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        self.published.push(topic.name.to_owned());
        Ok(self.published.len() as u32 - 1)
    }

    fn subscribe(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        self.subscribed.push(topic.name.to_owned());
        Ok(self.subscribed.len() as u32 - 1)
    }

    fn send(&mut self, publisher: u32, message: SharedMessage) -> Result<(), Failure> {
        if publisher as usize >= self.published.len() {
            return Err("the publisher belongs to no topic".into());
        }
        self.sent.push((publisher, message));
        Ok(())
    }

    fn reference(&mut self, _: &str, _: &str) -> Result<u32, Failure> {
        Ok(0)
    }

    fn set_region(&mut self, _: u32, _: Option<saoms_api::Region>) -> Result<(), Failure> {
        Ok(())
    }

    fn departed(&self, _: u32) -> &[saoms_api::Departed] {
        &[]
    }

    fn keep(&mut self, _: u64, _: &[u8]) -> Result<(), Failure> {
        Ok(())
    }

    fn kept(&self) -> BTreeMap<u64, &[u8]> {
        BTreeMap::new()
    }

    fn register_stop(&mut self, _: saoms_api::StopFunction) -> Result<(), Failure> {
        Ok(())
    }

    fn is_wired(&self, reference: u32) -> bool {
        reference == 0 && self.provider.is_some()
    }

    fn call(&mut self, reference: u32, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        let unwired = CallError::NotWired { reference: reference.to_string() };
        let (mut provider, service) = self.provider.take().ok_or(unwired)?;
        let mut bytes = OnlyBytes(call);
        let call: &mut dyn ServiceCall = match self.boundary {
            Boundary::None => bytes.0,
            Boundary::Bytes => &mut bytes,
        };
        let result = provider.serve(&mut Invocation { service, call }, &mut Context::new(self, &[]));
        self.provider = Some((provider, service));
        result
    }

    fn loops(&mut self) -> Result<NamedLoops, Failure> {
        let construct =
            |(name, registration): &(&str, LoopRegistration)| Ok(((*name).to_owned(), registration.construct(&[])?));
        self.loops.iter().map(construct).collect()
    }

    fn enter_loop(&mut self, _place: Option<u32>) {}

    fn because(&mut self, _cause: Cause) {}

    fn cause(&self) -> Cause {
        Cause::default()
    }

    fn journal(&mut self, phase: Phase, record: &Record) {
        self.journal.push(format!("{phase:?}: {record}"));
    }

    fn changed(&mut self, entry: &'static str, before: Value, after: Value) {
        self.journal.push(format!("{entry}: {before} -> {after}"));
    }

    fn listens(&self, _level: Option<Level>) -> bool {
        true
    }

    fn log(&mut self, level: Level, line: fmt::Arguments<'_>) {
        self.lines.push(format!("{level:?}: {line}"));
    }

    fn alert(&mut self, kind: &str, subject: &str, line: Option<fmt::Arguments<'_>>) {
        let line = line.map(|line| line.to_string());
        self.lines.push(format!("alert {kind} `{subject}`: {line:?}"));
    }

    fn console(&mut self, line: fmt::Arguments<'_>) {
        self.lines.push(line.to_string());
    }

    fn report(&mut self, path: &str, value: ReportValue) {
        self.report.push((path.to_owned(), value));
    }

    fn count(&mut self, path: &str, more: i64) {
        self.report.push((path.to_owned(), more.into()));
    }

    fn vote(&mut self, work: Work) {
        self.votes.push(work);
    }
}

/// A call that arrived from another build.
struct OnlyBytes<'a>(&'a mut dyn ServiceCall);

impl ServiceCall for OnlyBytes<'_> {
    fn operation(&self) -> Operation {
        self.0.operation()
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        None
    }

    fn arguments(&mut self) -> Vec<u8> {
        self.0.arguments()
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        self.0.reply(bytes)
    }
}
