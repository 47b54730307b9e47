//! The contract with hosts of components: the scheduler, the checker, the testkit, the code that the macros generate.
//! Not for authors of components.

mod calendar;
pub mod cdr;
pub mod contain;
pub mod declaration;
mod prefetch;
pub mod present;
mod visible;
mod xml;

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

pub use crate::adaptation::{
    Decided, DynEntries, DynLoop, EntryDeclaration, KnowledgeClass, LoopRegistration, NamedLoops, Phase, ShortText,
    Snapshot, Subject,
};
pub use crate::bounded::Measured;
pub use crate::component::derived::{Derived, DerivedLoop, Fields};
pub use crate::component::dyn_component::DynComponent;
pub use crate::component::registration::Registration;
pub use crate::field::Arguments;
pub use crate::message::topic::{TopicDeclaration, TopicKind};
pub use crate::message::{FIRST_ELSEWHERE, SharedMessage};
pub use crate::property::{PropertyValue, RESERVED, WriteProperties};
pub use crate::rule::nearest::{nearest_equal, nearest_few};
pub use crate::service::{Interface, Invocation, Operation, Reference, ReferenceField, ServiceCall, TypedCall};
pub use crate::time::{format_duration, meant_duration, parse_duration};

/// The text of a property, or its name: a short or shared one is copied without a copy of its letters.
pub use calendar::calendar_date;
pub use prefetch::prefetch;
pub use saoms_derive::WriteProperties;
pub use smol_str::SmolStr;
pub use visible::{Visible, is_invisible, one_line, shorten, shown};
pub use xml::escaped;

use crate::{
    CallError, Cause, Chance, Departed, Failure, KeptByOther, KnownPublisher, Level, Record, Region, ReportValue,
    StopFunction, Time, Value, Work,
};

/// The lowest bit of the number of a target in the handle of a reference; the bits below are the place of the reference
/// in its class.
pub const TARGET_SHIFT: u32 = 16;

/// A function that sees the loops of a component: name, class and values of each.
pub type LoopVisit<'a> = dyn FnMut(&str, &str, &[(SmolStr, PropertyValue)]) + 'a;

/// The world of a component behind its context: the scheduler in a run, a stand-in in a test, a table of functions
/// behind the boundary to a plugin. Component authors use [`Context`](crate::Context).
pub trait Host {
    /// See [`Context::name`](crate::Context::name).
    fn name(&self) -> &str;
    /// The index of this component in [`Header::sender`](crate::Header::sender).
    fn sender(&self) -> u32;
    /// The name of the component with an index in [`Header::sender`](crate::Header::sender).
    fn name_of(&self, sender: u32) -> Option<&str> {
        let _ = sender;
        None
    }
    /// See [`Context::now`](crate::Context::now).
    fn now(&self) -> Time;
    /// See [`Context::date`](crate::Context::date).
    fn date(&self) -> Option<Duration>;
    /// See [`Context::due`](crate::Context::due).
    fn due(&self) -> Time;
    /// See [`Context::execution`](crate::Context::execution).
    fn execution(&self) -> u64;
    /// See [`Context::period`](crate::Context::period).
    fn period(&self) -> Duration;
    /// See [`Context::cancelled`](crate::Context::cancelled).
    fn cancelled(&self) -> bool;
    /// See [`Context::chance`](crate::Context::chance).
    fn chance(&mut self) -> &mut Chance;
    /// See [`Context::publish`](crate::Context::publish).
    ///
    /// # Errors
    /// As there.
    fn publish(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure>;
    /// See [`Context::subscribe`](crate::Context::subscribe). The index is the place of the subscription's inbox in the
    /// context.
    ///
    /// # Errors
    /// As there.
    fn subscribe(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure>;
    /// See [`Context::send`](crate::Context::send).
    ///
    /// # Errors
    /// As there.
    fn send(&mut self, publisher: u32, message: SharedMessage) -> Result<(), Failure>;
    /// See [`Context::raise`](crate::Context::raise).
    ///
    /// # Errors
    /// As there; this host takes no events.
    fn raise(&mut self, event: &str) -> Result<(), Failure> {
        Err(Failure::new(format!("the event `{event}` has no receiver: this host does not support events")))
    }
    /// See [`Context::reference`](crate::Context::reference).
    ///
    /// # Errors
    /// As there.
    fn reference(&mut self, name: &str, interface: &str) -> Result<u32, Failure>;
    /// See [`Context::is_wired`](crate::Context::is_wired).
    fn is_wired(&self, reference: u32) -> bool;
    /// Number of targets of a reference. The handle of one of them is that of the reference with the number of the
    /// target, from 0, in the bits from [`TARGET_SHIFT`] on.
    fn targets(&self, reference: u32) -> u32 {
        u32::from(self.is_wired(reference))
    }
    /// Calls through a reference.
    ///
    /// # Errors
    /// See [`CallError`].
    fn call(&mut self, reference: u32, call: &mut dyn ServiceCall) -> Result<(), CallError>;
    /// See [`Context::set_region`](crate::Context::set_region).
    ///
    /// # Errors
    /// As there.
    fn set_region(&mut self, subscription: u32, region: Option<Region>) -> Result<(), Failure>;
    /// See [`Context::publishers`](crate::Context::publishers). The name of the topic is that in the declarations.
    fn publishers(&self, topic: &str) -> Vec<KnownPublisher> {
        let _ = topic;
        Vec::new()
    }
    /// See [`Context::speaker`](crate::Context::speaker). The name of the topic is that in the declarations.
    fn speaker(&self, topic: &str, number: u32) -> Option<u32> {
        let mut publishers = self.publishers(topic).into_iter();
        publishers.find(|one| one.number == Some(number)).map(|one| one.sender)
    }
    /// See [`Context::departed`](crate::Context::departed).
    fn departed(&self, subscription: u32) -> &[Departed];
    /// See [`Context::keep`](crate::Context::keep).
    ///
    /// # Errors
    /// As there.
    fn keep(&mut self, key: u64, bytes: &[u8]) -> Result<(), Failure>;
    /// See [`Context::kept`](crate::Context::kept).
    fn kept(&self) -> BTreeMap<u64, &[u8]>;
    /// See [`Context::goes_on_from_earlier_program`](crate::Context::goes_on_from_earlier_program).
    fn goes_on_from_earlier_program(&self) -> bool {
        false
    }

    /// See [`Context::kept_by_earlier_program`](crate::Context::kept_by_earlier_program).
    fn kept_by_earlier_program(&self) -> bool {
        false
    }
    /// See [`Context::kept_by_others`](crate::Context::kept_by_others).
    fn kept_by_others(&self) -> Vec<KeptByOther<'_>> {
        Vec::new()
    }
    /// See [`Context::goes_on`](crate::Context::goes_on).
    fn goes_on(&self) -> bool {
        false
    }
    /// See [`Context::register_stop`](crate::Context::register_stop).
    ///
    /// # Errors
    /// As there.
    fn register_stop(&mut self, stop: StopFunction) -> Result<(), Failure>;
    /// Constructs the component's loops. See [`Context::loops`](crate::Context::loops).
    ///
    /// # Errors
    /// As there.
    fn loops(&mut self) -> Result<NamedLoops, Failure>;
    /// The journal calls the loop at this place by this name.
    fn name_loop(&mut self, place: u32, name: &str) {
        let _ = (place, name);
    }
    /// For a host across a boundary, which constructs loops itself: name, class and values of each of the component's
    /// loops.
    fn chosen_loops(&mut self, visit: &mut LoopVisit<'_>) {
        let _ = visit;
    }
    /// Constructs the loop at this place of [`chosen_loops`](Host::chosen_loops).
    ///
    /// # Errors
    /// It refuses its properties, or there is none.
    fn chosen_loop(&mut self, place: u32) -> Result<Box<dyn DynLoop>, Failure> {
        Err(Failure::new(format!("there is no loop {place}")))
    }
    /// The loop at this place acts from now on, or none.
    fn enter_loop(&mut self, place: Option<u32>);
    /// See [`Context::because`](crate::Context::because).
    fn because(&mut self, cause: Cause);
    /// See [`Context::cause`](crate::Context::cause).
    fn cause(&self) -> Cause;
    /// Writes to the journal what the present loop saw, decided or did.
    fn journal(&mut self, phase: Phase, record: &Record);
    /// Writes to the journal that the present loop changed an entry of the knowledge.
    fn changed(&mut self, entry: &'static str, before: Value, after: Value) {
        let _ = (entry, before, after);
    }
    /// True if an observer wants the log at this level, or, for `None`, the classic console.
    fn listens(&self, level: Option<Level>) -> bool;
    /// See [`Context::log`](crate::Context::log).
    fn log(&mut self, level: Level, line: fmt::Arguments<'_>);
    /// See [`Context::alert`](crate::Context::alert); without a line
    /// [`Context::alert_over`](crate::Context::alert_over). A host that keeps no alerts writes the line to its log.
    fn alert(&mut self, kind: &str, subject: &str, line: Option<fmt::Arguments<'_>>) {
        let _ = (kind, subject);
        if let Some(line) = line {
            self.log(Level::Error, line);
        }
    }
    /// See [`Context::console`](crate::Context::console).
    fn console(&mut self, line: fmt::Arguments<'_>);
    /// See [`Context::report`](crate::Context::report).
    fn report(&mut self, path: &str, value: ReportValue);
    /// See [`Context::count`](crate::Context::count).
    fn count(&mut self, path: &str, more: i64);
    /// See [`Context::vote`](crate::Context::vote).
    fn vote(&mut self, work: Work);
}
