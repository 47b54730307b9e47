mod commit;
mod web;

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use saoms_api::event::EventCall;
use saoms_api::event::fault::FaultCall;
use saoms_api::{Cause, Level, Time};
use saoms_lang::assembly::{Assembly, ComponentSpec};
use saoms_lang::schema::Schema;

pub use self::commit::{NotCommitted, Together};
pub use self::web::OfferedService;
use super::change::{self, ChangeError, ChangeOptions, Changed, PlannedChanges, StartError, Takeover};
use super::drive::store_writer;
use super::engine::RunPhase;
use super::engine::lifecycle::Request;
use super::engine::memory::SharedText;
use super::engine::slot::NEVER;
use super::hold::{self, HoldError, Speed};
use super::inject::{self, InjectError, Injection};
use super::members::UnknownComponent;
use super::metrics::{self, TimerSign};
use super::order::{self, Order, OrderError, OrderTicket};
use super::settings::nanos;
use super::shared::Shared;
use super::topics;
use super::topics::takers::{RaiseError, Takers};
use super::why;
use crate::journal::{JournalEntry, LiveJournal};
use crate::observe::{Observer, RunProgress, SentMessage};
use crate::status::{FleetMetrics, FleetPhase, FleetStatus, TopicStatus};
use crate::store::Store;

/// Time for which the answers of components are waited for.
const PATIENCE: Duration = Duration::from_millis(50);
/// Time for which a component may take to carry out an order.
const ORDER_PATIENCE: Duration = Duration::from_millis(500);

/// A remote control of a fleet. It may be cloned and used from any thread; after the end of the run it does nothing.
#[derive(Clone)]
pub struct Handle {
    pub(super) shared: Arc<Shared>,
}

impl Handle {
    /// Asks the fleet to end, as Ctrl-C does. Returns at once. It takes no lock, so that a thread that handles signals
    /// may call it, and so may a signal handler.
    pub fn stop(&self) {
        self.shared.stop.store(true, Ordering::SeqCst);
        self.shared.timer.wake();
        self.shared.end.wake();
    }

    /// Ends the fleet as [`stop`](Handle::stop) does, because an operator wants that: the run is
    /// [`Stopped`](crate::report::RunStatus::Stopped) then, unless it was asked to stop before.
    pub fn down(&self) {
        if !self.shared.stop.load(Ordering::SeqCst) {
            self.shared.is_down.store(true, Ordering::SeqCst);
        }
        self.stop();
    }

    /// Schedules a periodic component. Returns at once; the component initializes as soon as no code runs, and begins
    /// after its delay.
    ///
    /// # Errors
    /// There is no such component, or it is passive.
    pub fn schedule(&self, component: &str) -> Result<(), UnknownComponent> {
        self.request(component, Request::Schedule { lasting: NEVER })
    }

    /// The same for a limited time, counted from now.
    ///
    /// # Errors
    /// As [`schedule`](Handle::schedule).
    pub fn schedule_for(&self, component: &str, duration: Duration) -> Result<(), UnknownComponent> {
        self.request(component, Request::Schedule { lasting: nanos(duration) })
    }

    /// Unschedules a periodic component. Returns at once; the component shuts down as soon as its present execution has
    /// ended, which ends early only with `mayInterruptIfRunning`.
    ///
    /// # Errors
    /// As [`schedule`](Handle::schedule).
    pub fn unschedule(&self, component: &str) -> Result<(), UnknownComponent> {
        self.request(component, Request::Unschedule)
    }

    /// True if a periodic component is scheduled, or is about to be.
    ///
    /// # Errors
    /// As [`schedule`](Handle::schedule).
    pub fn is_running(&self, component: &str) -> Result<bool, UnknownComponent> {
        let engine = self.shared.lock();
        let index = engine.periodic(component)?;
        Ok(engine.slots[index as usize].is_scheduled())
    }

    /// What [`apply`](Handle::apply) would do. It compares with what the fleet has now, with the values that operators
    /// have [set](Handle::set), and changes nothing.
    pub fn plan(&self, assembly: &Assembly) -> PlannedChanges {
        change::plan(&self.shared, assembly)
    }

    /// Changes the fleet to that of an assembly: components whose paths differ end and start, components that differ
    /// are replaced, and all others continue. Those that differ in live properties alone take their values and
    /// continue, too. Wires lead to components of the assembly.
    ///
    /// All new instances initialize first; then they take part from one instant on, and removed components shut down. A
    /// replaced component [saves](saoms_api::Component::save) the state for its successor; a component of another class
    /// starts without it, which the options have to allow.
    ///
    /// # Errors
    /// The fleet is unchanged: a component cannot be constructed or initialized, refuses a value, would lose its state,
    /// cannot be replaced or ended now, another change is being made, somebody changed the fleet while this one waited
    /// for components that leave, whoever asked for it took it back, or the run ends.
    pub fn apply(&self, assembly: &Assembly, options: ChangeOptions) -> Result<Changed, ChangeError> {
        change::apply(&self.shared, assembly, options)
    }

    /// Replaces a component by one of a new build of its class, as [`apply`](Handle::apply) does. The targets of its
    /// wires are the same as at the start; its task settings (period, delay, policies) stay. `by` is who wants it, for
    /// the journal.
    ///
    /// # Errors
    /// As [`apply`](Handle::apply), or there is no such component.
    pub fn replace(&self, spec: ComponentSpec, by: Option<&str>) -> Result<Takeover, ChangeError> {
        change::replace(&self.shared, spec, by)
    }

    /// Gives a component a new value of a property that its class declares `live`, as text: it takes the value between
    /// two executions. Instances that a restart makes have it, too, and the journal says so.
    ///
    /// # Errors
    /// The component keeps the value that it has: there is no such component or property, the property cannot change
    /// while it runs, the value is wrong, or the component refuses it, or does not take it within 500 ms.
    pub fn set(&self, component: &str, property: &str, value: &str) -> Result<(), OrderError> {
        let (component, property, value) = (component.to_owned(), property.to_owned(), value.to_owned());
        self.order(Order::Set { component, property, value }, None)?.wait(ORDER_PATIENCE).map(drop)
    }

    /// The records of the journal that explain what a component did last, up to this time or at all. The component is
    /// given by its path, its ID, or an ending of its path. The run waits for no more than a piece of them at a time.
    ///
    /// # Errors
    /// There is no such component, or there are several; the text says what there is.
    pub fn why(&self, component: &str, at: Option<Time>) -> Result<LiveJournal, String> {
        why::why(&self.shared, component, at)
    }

    /// The newest records of the journal that a component wrote after this one, oldest first, at most so many. The
    /// component is given as for [`why`](Handle::why). The run waits for no more than a piece of them at a time.
    ///
    /// # Errors
    /// As [`why`](Handle::why).
    pub fn records(&self, component: &str, after: Cause, most: usize) -> Result<Vec<JournalEntry>, String> {
        why::records(&self.shared, component, after, most)
    }

    /// Gives an order of an operator, which takes effect at the next instant, or at its time, before the executions
    /// that are due then, and is in the journal. Given again at the times that the journal says, in virtual time, the
    /// same orders have the same effects.
    ///
    /// # Errors
    /// It is refused: there is no such component, property, operation or topic, a value is wrong, or the run ends. The
    /// ticket tells what is found out later.
    pub fn order(&self, order: Order, at: Option<Time>) -> Result<OrderTicket, OrderError> {
        order::accept(&self.shared, order, at)
    }

    /// Pauses the run before the executions that are due next: no component executes, no time of the run passes, and
    /// nothing is missed. Hardware hears no heartbeat, and stops by itself. Orders and messages from outside still take
    /// effect, and components are asked for their status. With a [store](Handle::use_store), a later program pauses,
    /// too, until it is resumed. Gives the time at which the run stands.
    ///
    /// # Errors
    /// The run ends.
    pub fn pause(&self) -> Result<Time, HoldError> {
        hold::pause(&self.shared)
    }

    /// Lets a paused run go on.
    ///
    /// # Errors
    /// The run ends.
    pub fn resume(&self) -> Result<(), HoldError> {
        hold::resume(&self.shared)
    }

    /// Lets virtual time advance by a time, or through the next instant at which something is due, and pauses there.
    /// Gives the time at which the run will stand.
    ///
    /// # Errors
    /// The fleet runs in real time, or the run ends.
    pub fn step(&self, time: Option<Duration>) -> Result<Time, HoldError> {
        hold::step(&self.shared, time)
    }

    /// Sets how fast virtual time passes.
    ///
    /// # Errors
    /// The fleet runs in real time, or the run ends.
    pub fn set_speed(&self, speed: Speed) -> Result<(), HoldError> {
        hold::set_speed(&self.shared, speed)
    }

    /// Sends a message from outside on a topic of the fleet. It is checked against the schema of the topic, takes
    /// effect at the next instant, or at its time, before components that are due then, and is part of the journal and
    /// of the trace.
    ///
    /// # Errors
    /// The fleet has no such topic, the message does not fit its schema, it speaks in the name of a component of the
    /// fleet, or the run ends.
    pub fn inject(&self, injection: Injection) -> Result<(), InjectError> {
        inject::inject(&self.shared, injection)
    }

    /// The components that take events at present.
    pub fn takers(&self) -> Arc<Takers> {
        self.shared.takers()
    }

    /// Lets an event of a class happen, which reaches components of a site: at its time, as an [injected
    /// message](Handle::inject). `text` describes it in the journal.
    ///
    /// # Errors
    /// The event is wrong, as [`Takers::messages`] says, or the run ends.
    pub fn raise(&self, site: &str, call: &EventCall, at: Option<Time>, text: String) -> Result<(), RaiseError> {
        let messages = self.takers().messages(site, call).map_err(RaiseError::Wrong)?;
        if inject::raise(&self.shared, messages, at, text) { Ok(()) } else { Err(RaiseError::Ending) }
    }

    /// Puts a fault into the run at its time: of components of a site, or of all. `text` describes it in the journal.
    ///
    /// # Errors
    /// It names what the fleet does not have, or the run ends.
    pub fn disturb(&self, site: &str, call: &FaultCall, at: Option<Time>, text: String) -> Result<(), RaiseError> {
        inject::add_fault(&self.shared, (site, call), at, text)
    }

    /// Keeps the run from ending for want of work until the returned value is dropped: more messages may come from
    /// outside.
    pub fn hold(&self) -> Hold {
        self.shared.lock().injections.holds += 1;
        Hold { shared: Arc::clone(&self.shared) }
    }

    /// Has components keep in a store what they [keep](saoms_api::Context::keep), so that it outlives the program: in
    /// the code that gets the control [before they initialize](super::RunningFleet::start_with), and once. It is closed
    /// when the run has ended.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub fn use_store(&self, store: Store) -> Result<(), StartError> {
        store_writer::use_store(&self.shared, store).map_err(StartError::Thread)
    }

    /// Waits until all that has happened so far is committed, so that it outlives the program; at once where there is
    /// no state folder. Whoever answers that something is accepted waits for this first.
    ///
    /// # Errors
    /// It is not committed within this time, or never will be.
    pub fn commit(&self, patience: Duration) -> Result<(), NotCommitted> {
        commit::wait(&self.shared, patience)
    }

    /// Why no new work is accepted, if that is so: the disk of the state folder is full.
    pub fn refusal_of_work(&self) -> Option<String> {
        self.shared.store.get().and_then(|queue| queue.refusal_of_work())
    }

    /// Lets changes that belong together be in the memory together: until the returned value is dropped, there is no
    /// state of the fleet that a later program could go on from. It is for a moment. A run that ends meanwhile takes
    /// still what comes from outside, and waits for [`Settings::together`](super::Settings::together) at most before it
    /// makes its last state; beyond that there is none, and a later program goes on from the one before.
    pub fn together(&self) -> Together {
        commit::together(&self.shared)
    }

    /// The time of the run from which this program goes on, if it does so from a state folder.
    pub fn recalled(&self) -> Option<Time> {
        Some(self.shared.clock.origin()).filter(|origin| *origin > 0).map(Time::from_nanos)
    }

    /// A number that outlives the program, under a name: 0 at first.
    pub fn counter(&self, name: &str) -> u64 {
        self.shared.look(|engine| engine.counter(name))
    }

    /// Sets a [`counter`](Handle::counter).
    pub fn set_counter(&self, name: &str, value: u64) {
        let mut engine = self.shared.lock();
        engine.set_counter(name, value);
        self.shared.release(engine);
    }

    /// Has a number that others count on outlive the program, under a name: it counts on from where it was.
    pub fn share_counter(&self, name: &str, counter: &Arc<AtomicU32>) {
        let mut engine = self.shared.lock();
        if let Some(before) = engine.share_counter(name, Arc::clone(counter)) {
            counter.store(u32::try_from(before).unwrap_or(u32::MAX), Ordering::Relaxed);
        }
        self.shared.release(engine);
    }

    /// Has a text that others change outlive the program, under a name; gives what an earlier program left.
    pub fn share_text(&self, name: &str, text: &SharedText) -> Option<String> {
        let mut engine = self.shared.lock();
        let before = engine.share_text(name, Arc::clone(text));
        self.shared.release(engine);
        before
    }

    /// Adds to a count of the report.
    pub fn count(&self, path: &str, more: i64) {
        self.shared.sections().add(path, more);
    }

    /// Queues a note about the fleet as a whole for the observers.
    pub fn note(&self, level: Level, text: String) {
        self.shared.note(level, text);
    }

    /// A snapshot of the fleet with what each component says of itself. Components are asked between their executions,
    /// at most ten times a second, and only when somebody wants to know; for observers of samples as often as they
    /// want. One that does not answer within 50 ms, because
    /// its code runs, is shown with what it said before.
    pub fn status(&self) -> FleetStatus {
        let shared = &self.shared;
        let mut engine = shared.lock();
        if engine.phase == RunPhase::Running && engine.are_outdated() {
            engine.ask_all();
            shared.release(engine);
            engine = shared.lock();
        }
        let until = Instant::now() + PATIENCE;
        while !engine.are_answered() && Instant::now() < until {
            engine = shared.wait_for_return(engine, until.saturating_duration_since(Instant::now()));
        }
        let status = engine.status(&shared.sections(), shared.clock.now());
        shared.release(engine);
        status
    }

    /// A sign of life of the thread with the timer's work. It waits for no lock.
    pub fn timer_sign(&self) -> TimerSign {
        metrics::timer_sign(&self.shared)
    }

    /// What the fleet does.
    pub fn phase(&self) -> FleetPhase {
        self.shared.lock().phase.shown()
    }

    /// What can be counted in the fleet. Components are asked as for [`status`](Handle::status).
    pub fn metrics(&self) -> FleetMetrics {
        metrics::metrics(self.status(), &self.shared)
    }

    /// The topics of the fleet, with who publishes and reads each, and how many events wait for whom.
    pub fn topics(&self) -> Vec<TopicStatus> {
        topics::topics(&self.shared)
    }

    /// Lets an observer of this fleet get the messages of a topic from now on, or no more. Gives the schema of the
    /// messages.
    ///
    /// # Errors
    /// The fleet has no such topic.
    pub fn watch(&self, topic: &str, observer: &Arc<dyn Observer>, wanted: bool) -> Result<Schema, InjectError> {
        topics::watch(&self.shared, topic, observer, wanted)
    }

    /// The messages that a state topic retains, the oldest first; none of an event topic.
    ///
    /// # Errors
    /// The fleet has no such topic.
    pub fn retained(&self, topic: &str) -> Result<Vec<SentMessage>, InjectError> {
        topics::retained(&self.shared, topic)
    }

    /// Progress of the run.
    pub fn progress(&self) -> RunProgress {
        self.shared.progress()
    }

    fn request(&self, component: &str, request: Request) -> Result<(), UnknownComponent> {
        let mut engine = self.shared.lock();
        let index = engine.periodic(component)?;
        engine.request(index, request, self.shared.clock.now());
        self.shared.release(engine);
        Ok(())
    }
}

impl fmt::Debug for Handle {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Handle").field("components", &self.shared.lock().slots.len()).finish()
    }
}

/// A guard from [`Handle::hold`]: while it lives, a run does not end for want of work.
#[must_use = "the run may end as soon as it is dropped"]
pub struct Hold {
    shared: Arc<Shared>,
}

impl Drop for Hold {
    fn drop(&mut self) {
        let mut engine = self.shared.lock();
        engine.injections.holds -= 1;
        engine.end_if_done(self.shared.clock.now());
        self.shared.release(engine);
    }
}

impl fmt::Debug for Hold {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Hold")
    }
}
