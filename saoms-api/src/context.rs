use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use crate::host::{Host, TARGET_SHIFT};
use crate::host::{Phase, Reference, ServiceCall, SharedMessage};
use crate::{
    CallError, Cause, Chance, Departed, Failure, Header, KnownPublisher, Loops, Message, Messages, Publisher, Record,
    Region, ReportValue, StopFunction, Subscription, Time, Topic, Value, Work,
};

/// Severity of a log line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Something that the operator has to look at.
    Error,
    /// Something unexpected that the component could handle.
    Warning,
    /// Normal events, for an operator.
    Info,
    /// Details, for finding faults.
    Debug,
}

/// Everything that reaches a component from outside: its messages, time, chance, the log, other components.
///
/// A context lives for one call of the component. Handles ([`Publisher`], [`Subscription`], [`Reference`]) come from
/// `initialize` and stay valid until `shutdown`.
pub struct Context<'a> {
    host: &'a mut dyn Host,
    inboxes: &'a [Vec<SharedMessage>],
    /// True if messages left the region of a subscription.
    has_departed: bool,
    /// The inboxes that may have messages: a bit for each of the first 64.
    filled: u64,
}

impl<'a> Context<'a> {
    /// For hosts: a context over the messages of this period, one list per subscription in the order of subscribing.
    pub fn new(host: &'a mut dyn Host, inboxes: &'a [Vec<SharedMessage>]) -> Context<'a> {
        Context { host, inboxes, has_departed: false, filled: u64::MAX }
    }

    /// For hosts: the same where messages left the [region](Context::set_region) of a subscription.
    #[must_use]
    pub fn with_departed(self) -> Context<'a> {
        Context { has_departed: true, ..self }
    }

    /// For hosts: the same where some inboxes are known to be empty: a bit is set for each of the first 64 that may
    /// have messages. Code that looks for messages then need not touch the others.
    #[must_use]
    pub fn with_filled(self, filled: u64) -> Context<'a> {
        Context { filled, ..self }
    }

    /// True if messages left the region of a subscription.
    pub(crate) fn has_departed(&self) -> bool {
        self.has_departed
    }

    /// The parts that the boundary to plugins passes on.
    pub(crate) fn parts(&mut self) -> (&mut (dyn Host + 'a), &'a [Vec<SharedMessage>]) {
        (&mut *self.host, self.inboxes)
    }

    /// The component's name: its path in the composite.
    pub fn name(&self) -> &str {
        self.host.name()
    }

    /// The component's index in the running fleet, as in the headers of its messages.
    pub fn sender(&self) -> u32 {
        self.host.sender()
    }

    /// The present time. In virtual time it stands still during an execution.
    pub fn now(&self) -> Time {
        self.host.now()
    }

    /// The present local date and time of day, as the time since 1970-01-01 00:00. `None` in virtual time, which has no
    /// date.
    pub fn date(&self) -> Option<Duration> {
        self.host.date()
    }

    /// Due time of the present execution.
    pub fn due(&self) -> Time {
        self.host.due()
    }

    /// The number of the present execution, from 0.
    pub fn execution(&self) -> u64 {
        self.host.execution()
    }

    /// The component's period, [`Duration::ZERO`] for a passive one.
    pub fn period(&self) -> Duration {
        self.host.period()
    }

    /// True if a long execution should end early: the task was unscheduled with `mayInterruptIfRunning`, or the run
    /// ends.
    pub fn cancelled(&self) -> bool {
        self.host.cancelled()
    }

    /// The component's own source of chance: the same seed gives the same numbers, whatever the other components do.
    pub fn chance(&mut self) -> &mut Chance {
        self.host.chance()
    }

    /// Becomes a publisher of the topic. Only in `initialize`.
    ///
    /// # Errors
    /// `useJMS` is false, the topic carries other messages, or `initialize` is over.
    pub fn publish<M: Message>(&mut self, topic: &Topic<M>) -> Result<Publisher<M>, Failure> {
        self.host.publish(&topic.declaration()).map(Publisher::new)
    }

    /// Becomes a subscriber of the topic. Only in `initialize`.
    ///
    /// # Errors
    /// `useJMS` is false, the topic carries other messages, or `initialize` is over.
    pub fn subscribe<M: Message>(&mut self, topic: &Topic<M>) -> Result<Subscription<M>, Failure> {
        self.host.subscribe(&topic.declaration()).map(Subscription::new)
    }

    /// Sends a message; it leaves at the end of the present execution. What `initialize` sends leaves when the whole
    /// fleet starts.
    ///
    /// # Errors
    /// The publisher belongs to no topic.
    pub fn send<M: Message>(&mut self, publisher: &Publisher<M>, message: M) -> Result<(), Failure> {
        let header = Header { sender: self.host.sender(), sent: self.host.due(), cause: self.host.cause() };
        self.host.send(publisher.index(), SharedMessage::new(header, message))
    }

    /// Lets an event happen that components of the same site take: `fire at=(3,4) size=2 to Hall1` (see [`event`]). It
    /// reaches them as a message at the end of the present execution. One that nobody takes is logged.
    ///
    /// # Errors
    /// The text is no event that a class of the fleet takes, or `to` names a component that does not take it.
    ///
    /// [`event`]: crate::event
    pub fn raise(&mut self, event: &str) -> Result<(), Failure> {
        self.host.raise(event)
    }

    /// Unschedules this component after its present execution, as [`TaskInterface::unschedule`] and `saoms stop` do: it
    /// shuts down, and starts anew when it is scheduled again. A passive component goes on.
    ///
    /// # Errors
    /// The host unschedules nothing.
    ///
    /// [`TaskInterface::unschedule`]: crate::TaskInterface::unschedule
    pub fn unschedule(&mut self) -> Result<(), Failure> {
        // The name of an order is that of no event.
        self.host.raise(crate::event::STOP)
    }

    /// All messages that arrived for this period, oldest first. Asking twice gives the same messages.
    pub fn receive<M: Message>(&self, subscription: &Subscription<M>) -> Messages<'a, M> {
        Messages::new(self.inbox(subscription.index()))
    }

    /// The newest message that arrived for this period.
    pub fn receive_last<M: Message>(&self, subscription: &Subscription<M>) -> Option<&'a M> {
        self.receive(subscription).next_back()
    }

    fn inbox(&self, index: u32) -> &'a [SharedMessage] {
        if self.filled.checked_shr(index).is_some_and(|filled| filled & 1 == 0) {
            return &[];
        }
        let inboxes = self.inboxes;
        inboxes.get(index as usize).map_or(&[], Vec::as_slice)
    }

    /// A reference that the class declares, for calls. Only in `initialize`.
    ///
    /// # Errors
    /// The class declares no reference of this name and interface. A reference without a target is no error here, but
    /// every call is.
    pub fn reference<R: Reference>(&mut self, name: &str) -> Result<R, Failure> {
        self.host.reference(name, R::INTERFACE).map(R::from_index)
    }

    /// A handle for each target of a reference that the class declares as `many`, in the order of the composite; none
    /// where it has none. Only in `initialize`: a field `#[reference] lights: Vec<LightReference>` has them by itself.
    ///
    /// # Errors
    /// The class declares no reference of this name and interface.
    pub fn references<R: Reference>(&mut self, name: &str) -> Result<Vec<R>, Failure> {
        let first = self.host.reference(name, R::INTERFACE)?;
        let targets = self.host.targets(first);
        Ok((0..targets).map(|target| R::from_index(first | target << TARGET_SHIFT)).collect())
    }

    /// Lets a subscription receive the messages of a region alone, or again all with `None`. Their type declares a
    /// [`place`](Message#). It may change at any time; what arrived for this execution stays.
    ///
    /// Of a state topic the newest message of each key that is in the region comes with the next execution, also where
    /// it was sent long ago: its block entered the region, or the region came to it. [`departed`](Context::departed)
    /// says what is not in the region any more. Of an event topic comes what is sent in the region from now on. The
    /// cost of a message depends on the subscriptions around its block, and not on how many there are.
    ///
    /// ```
    /// use saoms_api::{Class, Component, Context, Failure, Field, Message, Region, Subscription, Topic};
    ///
    /// #[derive(Clone, Copy, Debug, Field)]
    /// #[field(pair)]
    /// struct Block {
    ///     x: i32,
    ///     y: i32,
    /// }
    ///
    /// #[derive(Clone, Debug, Message)]
    /// #[message(place = "block")]
    /// struct Seen {
    ///     block: Block,
    /// }
    ///
    /// const SEEN: Topic<Seen> = Topic::state("SEEN");
    ///
    /// /// Watches the blocks around (5,5).
    /// #[derive(Class)]
    /// #[class(name = "example.Watch", periodic)]
    /// struct Watch {
    ///     #[subscribes(SEEN)]
    ///     seen: Subscription<Seen>,
    /// }
    ///
    /// impl Component for Watch {
    ///     type Properties = ();
    ///
    ///     fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
    ///         context.set_region(&self.seen, Some(Region::around((5, 5), 3)))
    ///     }
    ///
    ///     fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
    ///         let came = context.receive(&self.seen).count();
    ///         let went = context.departed(&self.seen).len();
    ///         context.info(format!("{came} came or moved, {went} went"));
    ///         Ok(())
    ///     }
    /// }
    /// ```
    ///
    /// # Errors
    /// The messages have no place, or the subscription belongs to no topic.
    pub fn set_region<M: Message>(
        &mut self,
        subscription: &Subscription<M>,
        region: Option<Region>,
    ) -> Result<(), Failure> {
        if !M::HAS_PLACE {
            let name = M::NAME;
            return Err(Failure::new(format!(
                "messages `{name}` have no place, and no region: say which field is their block, `#[message(place = \"...\")]`"
            )));
        }
        self.host.set_region(subscription.index(), region)
    }

    /// The messages of a state topic that left the [region](Context::set_region) of a subscription since the execution
    /// before.
    pub fn departed<M: Message>(&self, subscription: &Subscription<M>) -> &[Departed] {
        self.host.departed(subscription.index())
    }

    /// The other components of the fleet that may publish on a topic, as their classes and loops declare it, with the
    /// name that the topic has for this component. A component that has to hear from each of them knows by that when
    /// one is missing.
    ///
    /// ```
    /// use saoms_api::{Class, Component, Context, Failure, Message, Topic};
    ///
    /// #[derive(Clone, Debug, Message)]
    /// struct Grant {
    ///     block: u32,
    /// }
    ///
    /// const GRANT: Topic<Grant> = Topic::state("GRANT");
    ///
    /// /// Waits for a grant where somebody gives grants.
    /// #[derive(Class)]
    /// #[class(name = "example.Guest", periodic, subscribes(GRANT))]
    /// struct Guest {
    ///     waits: bool,
    /// }
    ///
    /// impl Component for Guest {
    ///     type Properties = ();
    ///
    ///     fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
    ///         self.waits = !context.publishers(&GRANT).is_empty();
    ///         Ok(())
    ///     }
    /// }
    /// ```
    pub fn publishers<M: Message>(&self, topic: &Topic<M>) -> Vec<KnownPublisher> {
        self.host.publishers(topic.name())
    }

    /// Keeps these bytes under a number that the component chooses, beyond its crash: [`kept`](Context::kept) gives
    /// them back. No bytes remove what is kept under that number. They are lost if this execution fails.
    ///
    /// What an execution keeps is committed as a whole. **Messages of this and of later executions leave once it is**,
    /// in their order, so that no component receives a message about a state that could be lost. With `--state` that is
    /// when it is on the disk, in virtual time after a delay, else at once. Calls of services do not wait for it.
    ///
    /// # Errors
    /// All that is kept is more than 64 MiB, or the disk does not take it.
    pub fn keep(&mut self, key: u64, bytes: &[u8]) -> Result<(), Failure> {
        self.host.keep(key, bytes)
    }

    /// What the component, or the one before it, [kept](Context::keep) up to its last execution, by its numbers.
    ///
    /// ```
    /// use saoms_api::{Class, Component, Context, Failure};
    ///
    /// /// Counts its executions, through failures.
    /// #[derive(Class)]
    /// #[class(name = "example.Counter", periodic)]
    /// struct Counter {
    ///     count: u8,
    /// }
    ///
    /// impl Component for Counter {
    ///     type Properties = ();
    ///
    ///     fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
    ///         self.count = context.kept().get(&1).map_or(0, |bytes| bytes[0]);
    ///         Ok(())
    ///     }
    ///
    ///     fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
    ///         self.count = self.count.checked_add(1).ok_or("it cannot count further")?;
    ///         context.keep(1, &[self.count])
    ///     }
    /// }
    /// ```
    pub fn kept(&self) -> BTreeMap<u64, &[u8]> {
        self.host.kept()
    }

    /// True if an earlier program left what is [kept](Context::kept), and the component has kept nothing since: whoever
    /// runs beside it may have lost its memory then.
    pub fn kept_by_earlier_program(&self) -> bool {
        self.host.kept_by_earlier_program()
    }

    /// True in the `initialize` of a component that takes the place of another one and goes on from what that
    /// [saved](crate::Component::save): [`restore`](crate::Component::restore) comes next. What the earlier one had
    /// begun goes on, so that nothing is to be begun or announced anew, as a first position would be.
    pub fn goes_on(&self) -> bool {
        self.host.goes_on()
    }

    /// Registers a function that stops the component's hardware from any thread; the class declares `stops`. Only in
    /// `initialize`; each call adds one.
    ///
    /// # Errors
    /// The class does not say `stops`, or `initialize` is over.
    pub fn register_stop(&mut self, stop: StopFunction) -> Result<(), Failure> {
        self.host.register_stop(stop)
    }

    /// True if the reference leads to a service.
    pub fn is_wired<R: Reference>(&self, reference: &R) -> bool {
        self.host.is_wired(reference.index())
    }

    /// For generated code: calls through the reference of this index.
    ///
    /// # Errors
    /// See [`CallError`].
    #[doc(hidden)]
    pub fn call(&mut self, reference: u32, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        self.host.call(reference, call)
    }

    /// The loops that the class declares and the composite changes, in their order. Only in `initialize`.
    ///
    /// # Errors
    /// A loop refuses its properties, or `initialize` is over.
    pub fn loops(&mut self) -> Result<Loops, Failure> {
        self.host.loops().map(Loops::of)
    }

    /// Tells what follows from what: the next symptom of the present loop comes from this, such as from the
    /// [cause](Header::cause) of a message. In a component without loops, all that it writes and sends from here on
    /// does, until the next `because` or the end of the execution.
    pub fn because(&mut self, cause: Cause) {
        self.host.because(cause);
    }

    /// The cause that a message sent now would carry: the newest record of the present loop in this execution. If there
    /// is none yet, the cause set by [`because`](Context::because), so that a component that only passes a message on
    /// keeps the chain of causes.
    pub fn cause(&self) -> Cause {
        self.host.cause()
    }

    /// Writes to the journal what a component without loops saw: the beginning of a chain, such as an event that no
    /// other component caused, or what it makes of a message that it named with [`because`](Context::because). The
    /// findings of loops are written automatically.
    ///
    /// Each call is a record: write changes, and not the state in each execution.
    pub fn symptom(&mut self, record: Record) {
        self.host.journal(Phase::Symptom, &record);
    }

    /// Writes to the journal what a component without loops decided, because of its last [`symptom`](Context::symptom).
    /// The decisions of loops are written by themselves.
    pub fn decision(&mut self, record: Record) {
        self.host.journal(Phase::Decision, &record);
    }

    /// Writes to the journal what the present loop, or a component without loops, did, beyond the entries of the
    /// knowledge that it changed: those are written by themselves.
    pub fn effect(&mut self, record: Record) {
        self.host.journal(Phase::Effect, &record);
    }

    pub(crate) fn journal(&mut self, phase: Phase, record: &Record) {
        self.host.journal(phase, record);
    }

    /// Writes to the journal that an entry of the knowledge changed by itself, such as a measured level. What a loop
    /// changes in its plan and execution is written by itself.
    pub fn changed(&mut self, entry: &'static str, before: impl Into<Value>, after: impl Into<Value>) {
        self.host.changed(entry, before.into(), after.into());
    }

    pub(crate) fn enter_loop(&mut self, place: u32) {
        self.host.enter_loop(Some(place));
    }

    pub(crate) fn name_loop(&mut self, place: u32, name: &str) {
        self.host.name_loop(place, name);
    }

    pub(crate) fn leave_loops(&mut self) {
        self.host.enter_loop(None);
    }

    /// The name of the component that sent a message; `None` where the host does not know it.
    pub fn sender_name(&self, header: Header) -> Option<&str> {
        self.host.name_of(header.sender)
    }

    /// Writes a line to the log, with the time and the component's name. Formatted only if an observer wants it:
    /// [`info!`](crate::info) and [`warn!`](crate::warn) take a text with values in it.
    pub fn log(&mut self, level: Level, line: impl fmt::Display) {
        self.host.log(level, format_args!("{line}"));
    }

    /// [`log`](Context::log) at [`Level::Info`].
    pub fn info(&mut self, line: impl fmt::Display) {
        self.log(Level::Info, line);
    }

    /// [`log`](Context::log) at [`Level::Warning`].
    pub fn warn(&mut self, line: impl fmt::Display) {
        self.log(Level::Warning, line);
    }

    /// Says that a person is needed: in the log, at [`Level::Error`], and in the alerts of the fleet, which operators
    /// acknowledge. `kind` is a word that stands in metrics, such as `assistance`; `subject` says what it is about,
    /// where a component may have several alerts of a kind. It lasts until [`alert_over`](Context::alert_over) or until
    /// the component starts anew; the same kind and subject again give it another line.
    pub fn alert(&mut self, kind: &str, subject: impl fmt::Display, line: impl fmt::Display) {
        self.host.alert(kind, &subject.to_string(), Some(format_args!("{line}")));
    }

    /// Says that the [`alert`](Context::alert) of this kind and subject is over; if there is none, nothing happens.
    pub fn alert_over(&mut self, kind: &str, subject: impl fmt::Display) {
        self.host.alert(kind, &subject.to_string(), None);
    }

    /// Writes a line to the classic console (`--console classic`). Formatted only if an observer wants it.
    pub fn console(&mut self, line: impl fmt::Display) {
        self.host.console(format_args!("{line}"));
    }

    /// Sets a value of the run's report, such as `map.blocks`; dots lead into nested objects. The last value counts.
    pub fn report(&mut self, path: &str, value: impl Into<ReportValue>) {
        self.host.report(path, value.into());
    }

    /// Adds to a number of the run's report, such as `luggage.delivered`, which several components may share.
    pub fn count(&mut self, path: &str, more: i64) {
        self.host.count(path, more);
    }

    /// Says whether this component has work left. The run ends by itself when at least one component voted and all that
    /// voted `Open` or `Done` are [`Work::Done`]. If the component publishes events in the same execution, the run
    /// continues for three of its longest periods, so that these are read.
    pub fn vote(&mut self, work: Work) {
        self.host.vote(work);
    }
}

/// Writes a line to the log with values in it, as `format!` takes them; [`Context::info`] takes a text alone.
///
/// ```
/// use saoms_api::{Context, info};
///
/// fn tell(context: &mut Context<'_>, pieces: u32) {
///     info!(context, "has {pieces} pieces");
/// }
/// ```
#[macro_export]
macro_rules! info {
    ($context:expr, $($line:tt)+) => { $crate::info!(@ $crate::Level::Info, $context, $($line)+) };
    (@ $level:expr, $context:expr, $($line:tt)+) => { $context.log($level, ::core::format_args!($($line)+)) };
}

/// [`info!`](crate::info) at [`Level::Warning`].
#[macro_export]
macro_rules! warn {
    ($context:expr, $($line:tt)+) => { $crate::info!(@ $crate::Level::Warning, $context, $($line)+) };
}
