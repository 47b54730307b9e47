//! The view that a component has of the fleet.

mod journal;
mod kept;
mod log;

use std::collections::BTreeMap;
use std::time::Duration;

use crate::host::{Host, TARGET_SHIFT};
use crate::host::{Reference, ServiceCall, SharedMessage};
use crate::{
    CallError, Chance, Departed, Failure, Header, KnownPublisher, Loops, Message, Messages, Publisher, Region,
    StopFunction, Subscription, Time, Topic,
};

pub use kept::KeptByOther;
pub use log::Level;

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

    /// The component that says by this number [who speaks](Message#who-speaks) in messages of a topic, as the fleet is
    /// now: its index in the running fleet, as in [`Header::sender`]. `None` if no component of the fleet does; of
    /// several with one number the first. It may be this component, one of another node, or one that is not scheduled.
    /// The time that this takes does not depend on the number of components.
    ///
    /// ```
    /// use saoms_api::{Class, Component, Context, Failure, Message, Subscription, Topic};
    ///
    /// #[derive(Clone, Debug, Message)]
    /// #[message(speaker("guest"))]
    /// struct Order {
    ///     guest: u32,
    /// }
    ///
    /// const ORDER: Topic<Order> = Topic::event("ORDER");
    ///
    /// /// Takes the orders of guests, and from nobody else in their name.
    /// #[derive(Class)]
    /// #[class(name = "example.Waiter", periodic)]
    /// struct Waiter {
    ///     #[subscribes(ORDER)]
    ///     orders: Subscription<Order>,
    /// }
    ///
    /// impl Component for Waiter {
    ///     type Properties = ();
    ///
    ///     fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
    ///         let orders = context.receive(&self.orders).with_headers();
    ///         let own = orders.filter(|(header, order)| context.speaker(&ORDER, order.guest) == Some(header.sender));
    ///         let taken = own.count();
    ///         context.count("orders", i64::try_from(taken).unwrap_or(i64::MAX));
    ///         Ok(())
    ///     }
    /// }
    /// ```
    pub fn speaker<M: Message>(&self, topic: &Topic<M>, number: u32) -> Option<u32> {
        self.host.speaker(topic.name(), number)
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

    /// What other components of its class and site have [kept](Context::keep) that ended, or got new instances, in the
    /// change of the fleet with which this instance began: whoever takes over a part of their work goes on from that.
    /// None of them has executed since, and if the change is taken back, they go on as they were.
    ///
    /// It is left on until it is taken: what an earlier change left to a component that has kept nothing since is
    /// there, too, after what is newer, also if this component itself kept that. At the start of a run that goes on
    /// from a state folder, it is what all others of the class and site left there. A component of a library gets
    /// nothing.
    pub fn kept_by_others(&self) -> Vec<KeptByOther<'_>> {
        self.host.kept_by_others()
    }

    /// True in the `initialize` of a component that takes the place of another one and goes on from what that
    /// [saved](crate::Component::save): [`restore`](crate::Component::restore) comes next. What the earlier one had
    /// begun goes on, so that nothing is to be begun or announced anew, as a first position would be.
    pub fn goes_on(&self) -> bool {
        self.host.goes_on()
    }

    /// True where [`goes_on`](Context::goes_on) is, if an earlier program saved that: what the component drives outside
    /// of the program may have gone on meanwhile, or forgotten what it did.
    pub fn goes_on_from_earlier_program(&self) -> bool {
        self.host.goes_on_from_earlier_program()
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

    /// The name of the component that sent a message; `None` where the host does not know it.
    pub fn sender_name(&self, header: Header) -> Option<&str> {
        self.host.name_of(header.sender)
    }
}
