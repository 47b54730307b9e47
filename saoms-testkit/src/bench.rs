use std::collections::BTreeMap;
#[cfg(feature = "fleets")]
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use saoms_api::host::contain::{contained, install_hook};
use saoms_api::host::{
    DynComponent, Invocation, LoopRegistration, PropertyValue, Registration, ServiceCall, SharedMessage, SmolStr,
};
use saoms_api::{
    CallError, Cause, Class, Context, Departed, Failure, Header, LoopClass, Message, Region, ReportValue, Time, Topic,
    Work,
};
#[cfg(feature = "fleets")]
use saoms_core::plugin::Plugin;
use saoms_registry::registry::{RegisteredLoop, Registry};
use saoms_registry::schema::Schema;
use serde_json::Value;

use crate::stage::{Action, Stage, StageLoop, Wire};

/// One component without a fleet: a test sends it messages, and sees its messages and other output.
///
/// Time is virtual: each [`execute`](Bench::execute) is one period later. What the component did is that of the last
/// step (a start, an execution, the end), but for the [transcript](Bench::transcript), which has everything.
///
/// ```
/// use saoms_components::grid::Block;
/// use saoms_components::messages::{ENVIRONMENT, EXCEPTIONAL_EVENT};
/// use saoms_components::messages::{EnvironmentEvent, ExceptionalEvent, ExceptionalKind};
/// use saoms_components::master::MasterEnvironment;
/// use saoms_testkit::Bench;
///
/// let mut master = Bench::of::<MasterEnvironment>(&[])?;
/// master.start()?;
/// let landing = ExceptionalEvent { kind: ExceptionalKind::Landing, pieces: 4 };
/// master.deliver(&ENVIRONMENT, landing.clone().into());
/// master.execute()?;
/// assert_eq!(master.sent(&EXCEPTIONAL_EVENT), [landing]);
/// # Ok::<(), saoms_api::Failure>(())
/// ```
pub struct Bench {
    component: Box<dyn DynComponent>,
    stage: Stage,
    /// Messages for the next execution, by subscription.
    waiting: Vec<(String, SharedMessage)>,
    /// Index of the first event of the last step.
    step: usize,
    started: bool,
    /// The values of its properties.
    values: Vec<(SmolStr, PropertyValue)>,
}

/// Component index of the sender of the test's messages.
pub(crate) const TEST: u32 = u32::MAX;

impl Bench {
    /// A component of a class that the test links, with these values of its properties.
    ///
    /// # Errors
    /// The component refuses the values.
    pub fn of<C: Class>(values: &[(&str, &str)]) -> Result<Bench, Failure> {
        // Built once, as a test makes many benches.
        static LINKED: OnceLock<Result<Registry, String>> = OnceLock::new();
        let linked = LINKED.get_or_init(|| Registry::linked().map_err(|error| error.to_string()));
        let mut registry = linked.clone()?;
        let registration = Registration::of::<C>();
        let declared = |registry: &Registry| {
            registry.iter().find(|class| class.declaration_json() == registration.declaration()).cloned()
        };
        if declared(&registry).is_none() {
            registry.add(registration).map_err(|error| Failure::new(error.to_string()))?;
        }
        let name = declared(&registry).map(|class| class.name().to_owned()).unwrap_or_default();
        Bench::in_registry(&registry, &name, values)
    }

    /// A component of a class in a library, across the boundary to plugins. With the feature `fleets`.
    ///
    /// # Errors
    /// The library cannot be used, has no such class, or its component refuses the values.
    #[cfg(feature = "fleets")]
    pub fn of_library(library: &Path, class: &str, values: &[(&str, &str)]) -> Result<Bench, Failure> {
        let mut registry = Registry::new();
        let plugin = Plugin::open(library).map_err(|error| Failure::new(error.to_string()))?;
        plugin.register(&mut registry).map_err(|error| Failure::new(error.to_string()))?;
        Bench::in_registry(&registry, class, values)
    }

    /// A component of a class by its name.
    ///
    /// # Errors
    /// There is no such class, or its component refuses the values.
    pub fn in_registry(registry: &Registry, class: &str, values: &[(&str, &str)]) -> Result<Bench, Failure> {
        install_hook();
        let found = registry.get(class).ok_or_else(|| Failure::new(format!("there is no class `{class}`")))?;
        let mut values = given(values);
        let absent = found.presets().iter().filter(|(name, _)| !values.iter().any(|(given, _)| given == name));
        let absent: Vec<_> = absent.cloned().collect();
        values.extend(absent);
        let component = contained(|| found.construct(&values))??;
        let stage = Stage::new(registry, found, &values)?;
        Ok(Bench { component, stage, waiting: Vec::new(), step: 0, started: false, values })
    }

    pub(crate) fn of_loop(class: &Arc<RegisteredLoop>, component: Box<dyn DynComponent>) -> Bench {
        let stage = Stage::of_loops(vec![Arc::clone(class)]);
        Bench { component, stage, waiting: Vec::new(), step: 0, started: false, values: Vec::new() }
    }

    /// Sets the period, which is 100 ms by default.
    #[must_use]
    pub fn period(mut self, period: Duration) -> Bench {
        self.stage.period = period;
        self
    }

    /// Sets the seed of its random numbers, which is 0 by default.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Bench {
        self.stage.set_seed(seed);
        self
    }

    /// Wires one of its references to a service of another component, which has to be started before.
    #[must_use]
    pub fn wire(mut self, reference: &str, provider: Bench, service: &str) -> Bench {
        let (reference, service) = (reference.to_owned(), service.to_owned());
        self.stage.wires.push(Wire { reference, service, provider, is_busy: false });
        self
    }

    /// Puts a loop that the test links into the place of the one of this name, or behind the others where there is
    /// none, with these values of its properties: a loop is tested in the component that it is made for.
    ///
    /// ```
    /// use saoms_components::robot::Robot;
    /// use saoms_components::robot::classic::ClassicRobotList;
    /// use saoms_components::messages::ROBOT_LIST;
    /// use saoms_testkit::Bench;
    ///
    /// // The manual's loop announces a robot in each execution, that of the policy `safe` only what is new.
    /// let robot = || Bench::of::<Robot>(&[("ID", "Robot1")]);
    /// for (mut robot, said) in [(robot()?, 0), (robot()?.with_loop::<ClassicRobotList>("RobotListMS", &[])?, 1)] {
    ///     robot.start()?;
    ///     robot.execute()?;
    ///     robot.execute()?;
    ///     assert_eq!(robot.sent(&ROBOT_LIST).len(), said);
    /// }
    /// # Ok::<(), saoms_api::Failure>(())
    /// ```
    ///
    /// # Errors
    /// Two loops have one name, or the loop refuses the values.
    pub fn with_loop<L: LoopClass>(mut self, name: &str, values: &[(&str, &str)]) -> Result<Bench, Failure> {
        let class = loop_class::<L>()?;
        let values: Vec<_> = given(values);
        contained(|| class.construct(&values))??;
        self.stage.put_loop(StageLoop::new(name, class, values));
        Ok(self)
    }

    /// Makes the provider of a wired reference busy, or free again: calls of a busy one are answered
    /// [`CallError::Busy`].
    ///
    /// # Panics
    /// No provider is wired to this reference.
    #[expect(clippy::panic, reason = "a test that wires nothing has failed")]
    pub fn set_busy(&mut self, reference: &str, is_busy: bool) {
        match self.stage.wires.iter_mut().find(|wire| wire.reference == reference) {
            Some(wire) => wire.is_busy = is_busy,
            None => panic!("no provider is wired to the reference `{reference}`: call `wire` first"),
        }
    }

    /// Initializes the component.
    ///
    /// # Errors
    /// Errors of the component.
    pub fn start(&mut self) -> Result<(), Failure> {
        self.started = true;
        self.stage.initializing = true;
        let result = self.call(|component, context| component.initialize(context));
        self.stage.initializing = false;
        result
    }

    /// Executes the component once, with the messages that were delivered since the last execution.
    ///
    /// An execution that fails because a called component is [busy](Bench::set_busy) is skipped, as in a fleet: that is
    /// no error, the transcript says so, and its messages come again with the next execution.
    ///
    /// # Errors
    /// Errors of the component, including panics; or it was not started.
    pub fn execute(&mut self) -> Result<(), Failure> {
        let skipped = self.with_messages(|component, context| component.execute(context));
        if matches!(skipped, Ok(false)) {
            self.stage.beat(self.stage.period);
        }
        self.stage.end_of_execution();
        skipped.map(drop)
    }

    /// Has the component [react](saoms_api::Component::react) to the messages that were delivered since the last
    /// execution or reaction, as it does in a fleet to those of its `trigger`. Time stands still.
    ///
    /// # Errors
    /// As [`execute`](Bench::execute).
    pub fn react(&mut self) -> Result<(), Failure> {
        self.with_messages(|component, context| component.react(context)).map(drop)
    }

    /// Runs code of the component with the messages that were delivered; true if it was skipped.
    fn with_messages(
        &mut self,
        code: impl FnOnce(&mut dyn DynComponent, &mut Context<'_>) -> Result<(), Failure>,
    ) -> Result<bool, Failure> {
        if !self.started {
            return Err(Failure::new("this component was not started: call `start` first"));
        }
        let mut inboxes = vec![Vec::new(); self.stage.subscriptions.len()];
        let messages = std::mem::take(&mut self.waiting);
        for (topic, message) in &messages {
            for (inbox, subscription) in inboxes.iter_mut().zip(&self.stage.subscriptions) {
                let is_near = |region: &Region| message.place().is_none_or(|block| region.contains(block));
                if subscription.name == *topic && subscription.region.as_ref().is_none_or(is_near) {
                    inbox.push(message.clone());
                }
            }
        }
        self.step = self.stage.actions.len();
        let (component, mut context) = (&mut self.component, Context::new(&mut self.stage, &inboxes).with_departed());
        let result = contained(|| code(component.as_mut(), &mut context)).and_then(|result| result);
        self.stage.subscriptions.iter_mut().for_each(|subscription| subscription.departed.clear());
        if let Err(failure) = &result
            && let Some(provider) = failure.busy_provider()
        {
            self.stage.skipped(provider);
            self.waiting = messages;
            return Ok(true);
        }
        result.map(|()| false)
    }

    /// Gives the component a new value of a property that its class declares `live`, as a fleet does between two
    /// executions.
    ///
    /// # Errors
    /// The property cannot change while the component runs, or the component refuses the value.
    pub fn set(&mut self, property: &str, value: &str) -> Result<(), Failure> {
        let declared = self.stage.class_property(property)?;
        let value =
            declared.check(value).map_err(|message| Failure::new(format!("property `{property}`: {message}")))?;
        let mut values = self.values.clone();
        values.retain(|(name, _)| name != property);
        values.push((SmolStr::from(property), PropertyValue::from(value)));
        let component = &mut self.component;
        contained(|| component.update(&values)).and_then(|updated| updated)?;
        self.values = values;
        Ok(())
    }

    /// What the component [kept](Context::keep), by its numbers.
    pub fn kept(&self) -> &BTreeMap<u64, Vec<u8>> {
        &self.stage.kept
    }

    /// Stops the hardware of the component, and of those that it is wired to, with the functions that they
    /// [registered](Context::register_stop), as a fleet does at any time. Executions send their heartbeats.
    ///
    /// # Errors
    /// Hardware may still move.
    pub fn stop_hardware(&self) -> Result<(), Failure> {
        self.stage.stop_hardware()
    }

    /// Executes the component periodically until this time of the run.
    ///
    /// # Errors
    /// Errors of the component.
    pub fn execute_until(&mut self, time: Duration) -> Result<(), Failure> {
        while self.stage.now.as_nanos() < time.as_nanos() as u64 {
            self.execute()?;
        }
        Ok(())
    }

    /// Shuts the component down.
    ///
    /// # Errors
    /// Errors of the component.
    pub fn shutdown(&mut self) -> Result<(), Failure> {
        self.started = false;
        self.call(|component, context| component.shutdown(context))
    }

    fn call(
        &mut self,
        code: impl FnOnce(&mut dyn DynComponent, &mut Context<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        self.step = self.stage.actions.len();
        let (component, mut context) = (&mut *self.component, Context::new(&mut self.stage, &[]));
        contained(|| code(component, &mut context)).and_then(|result| result)
    }

    /// Serves a call at the time of its caller, as in a fleet.
    pub(crate) fn serve(&mut self, service: &str, call: &mut dyn ServiceCall, now: Time) -> Result<(), CallError> {
        self.stage.now = now;
        let mut invocation = Invocation { service, call };
        self.component.serve(&mut invocation, &mut Context::new(&mut self.stage, &[]))
    }

    pub(crate) fn stage(&self) -> &Stage {
        &self.stage
    }

    fn header(&self) -> Header {
        Header { sender: TEST, sent: self.stage.now, cause: Cause::default() }
    }

    /// Delivers a message to the next execution.
    pub fn deliver<M: Message>(&mut self, topic: &Topic<M>, message: M) {
        let message = SharedMessage::new(self.header(), message);
        self.waiting.push((topic.name().to_owned(), message));
    }

    /// Lets the next execution find that a message of a state topic left the [region](Context::set_region) of the
    /// component's subscription: that of the test with this key.
    pub fn depart<M: Message>(&mut self, topic: &Topic<M>, key: u64) {
        let departed = Departed { sender: TEST, key };
        let subscriptions = self.stage.subscriptions.iter_mut();
        let own = subscriptions.filter(|subscription| subscription.name == topic.name());
        own.for_each(|subscription| subscription.departed.push(departed));
    }

    /// Delivers a message that is given as JSON.
    ///
    /// # Errors
    /// Its class does not subscribe to the topic, or the JSON is none of its messages.
    pub fn deliver_json(&mut self, topic: &str, message: &Value) -> Result<(), Failure> {
        let schema = self.stage.schema_heard(topic)?;
        let bytes = schema.encode(message).map_err(|error| Failure::new(error.to_string()))?;
        self.deliver_bytes(topic, bytes);
        Ok(())
    }

    /// Delivers any bytes as a message.
    pub fn deliver_bytes(&mut self, topic: &str, bytes: Vec<u8>) {
        self.waiting.push((topic.to_owned(), SharedMessage::from_bytes(self.header(), None, bytes)));
    }

    /// Messages that the component sent on a topic.
    pub fn sent<M: Message>(&self, topic: &Topic<M>) -> Vec<M> {
        self.messages(topic.name()).filter_map(|message| message.get::<M>().cloned()).collect()
    }

    /// Messages that the component sent on a topic, as JSON.
    pub fn sent_json(&self, topic: &str) -> Vec<Value> {
        let schema = self.stage.schema_said(topic);
        let as_json = |message: &SharedMessage| schema.as_ref()?.decode(message.bytes()).ok();
        self.messages(topic).filter_map(as_json).collect()
    }

    fn messages(&self, topic: &str) -> impl Iterator<Item = &SharedMessage> {
        self.stage.actions[self.step..].iter().filter_map(move |(_, what)| match what {
            Action::Sent(place, message) if self.stage.publishers[*place].name == topic => Some(message),
            _ => None,
        })
    }

    /// Events that the component [raised](Context::raise), with fields as the classes that the test links declare
    /// them. They reach nobody: give a component the event that it takes with [`deliver`](Bench::deliver), as a message
    /// of its topic.
    pub fn raised(&self) -> Vec<&str> {
        self.lines(|what| match what {
            Action::Raised(event) => Some(event),
            _ => None,
        })
    }

    /// Lines that the component wrote to the log.
    pub fn log(&self) -> Vec<&str> {
        self.lines(|what| match what {
            Action::Log(_, line) => Some(line),
            _ => None,
        })
    }

    /// Records of the component in the journal, and changes of entries by its loops.
    pub fn journal(&self) -> Vec<&str> {
        self.lines(|what| match what {
            Action::Journal(line) => Some(line),
            _ => None,
        })
    }

    fn lines<'a>(&'a self, choose: impl Fn(&'a Action) -> Option<&'a String>) -> Vec<&'a str> {
        let step = self.stage.actions[self.step..].iter();
        step.filter_map(|(_, what)| choose(what)).map(String::as_str).collect()
    }

    /// Open work, as the component reported it last, in any step.
    pub fn work(&self) -> Option<Work> {
        self.stage.work
    }

    /// True if the component said, in any step, that work was given up.
    pub fn gave_up(&self) -> bool {
        self.stage.gave_up
    }

    /// What the component [waits for](saoms_api::Component::waits_for) now.
    ///
    /// # Errors
    /// A component of a library failed to say it.
    pub fn waits_for(&self) -> Result<Option<String>, Failure> {
        self.component.waits_for()
    }

    /// The [status](saoms_api::Component::status) of the component now.
    ///
    /// # Errors
    /// A component of a library failed to say it.
    pub fn status(&self) -> Result<Vec<(String, ReportValue)>, Failure> {
        self.component.status()
    }

    /// A value or count of the component in the report.
    pub fn report(&self, path: &str) -> Option<&ReportValue> {
        self.stage.report.iter().rev().find(|(known, _)| known == path).map(|(_, value)| value)
    }

    /// Everything that the component did, a line each with its time, messages as JSON: to read, or to compare with a
    /// file by
    /// [`expect_transcript`](Bench::expect_transcript).
    pub fn transcript(&self) -> String {
        self.stage.transcript()
    }

    /// Topics to which its class subscribes, with the schemas of their messages.
    pub fn hears(&self) -> Vec<(String, Schema)> {
        self.stage.heard().collect()
    }
}

/// Values of properties as hosts have them.
pub(crate) fn given(values: &[(&str, &str)]) -> Vec<(SmolStr, PropertyValue)> {
    values.iter().map(|(name, value)| (SmolStr::from(*name), PropertyValue::from(*value))).collect()
}

/// A loop that the test links.
pub(crate) fn loop_class<L: LoopClass>() -> Result<Arc<RegisteredLoop>, Failure> {
    let mut registry = Registry::new();
    let registration = LoopRegistration::of::<L>();
    registry.add_loop(registration).map_err(|error| Failure::new(error.to_string()))?;
    registry.get_loop(registration.name()).cloned().ok_or_else(|| "it has no name".into())
}

impl std::fmt::Debug for Bench {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.transcript())
    }
}
