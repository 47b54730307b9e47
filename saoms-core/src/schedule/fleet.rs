use std::fmt;
use std::fs::File;
use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use saoms_api::event::EventCall;
use saoms_api::{Level, Time};

use super::change::{self, ChangeError, Changed, StartError, Takeover};
use super::drive;
use super::engine::RunPhase;
use super::engine::lifecycle::Request;
use super::engine::slot::NEVER;
use super::hold::{self, HoldError, Speed};
use super::inject::{self, InjectError, Injection};
use super::members::UnknownComponent;
use super::metrics::{self, TimerSign};
use super::order::{self, Order, OrderError, OrderTicket};
use super::os::clock::Clock;
use super::os::realtime;
use super::settings::{ClockKind, Settings, nanos};
use super::shared::Shared;
use super::takers::{RaiseError, Takers};
use super::topics;
use super::why;
use crate::journal::{ComponentName, LiveJournal};
use crate::observe::{Beginning, Observer, RecordDelivery, RunProgress, deliver_records};
use crate::report::RunReport;
use crate::status::{FleetMetrics, FleetPhase, FleetStatus, TopicStatus};
use saoms_api::host::contain;
use saoms_lang::assembly::{Assembly, ComponentSpec};
use saoms_lang::schema::Schema;

/// A fleet that runs.
///
/// ```
/// use std::time::Duration;
///
/// use saoms_lang::assembly::Assembly;
/// use saoms_core::report::RunStatus;
/// use saoms_core::schedule::{RunningFleet, Settings};
///
/// let settings = Settings { limit: Some(Duration::from_secs(3600)), ..Settings::simulated(7) };
/// let fleet = RunningFleet::start(Assembly::default(), settings, Vec::new())?;
/// let report = fleet.run_to_end();
/// assert_eq!(report.outcome.status, RunStatus::Elapsed);
/// assert_eq!(report.time_s, 3600.0);
/// # Ok::<(), saoms_core::schedule::StartError>(())
/// ```
///
/// In real time the fleet runs from [`start`](RunningFleet::start) on. In virtual time it advances only while a caller
/// waits in [`run_to_end`](RunningFleet::run_to_end) or [`run_until`](RunningFleet::run_until), so that a program can
/// act at exact times. Dropping a fleet ends it.
#[derive(Debug)]
pub struct RunningFleet {
    handle: Handle,
    /// Under `realtime`, the open file that keeps the processors awake.
    _awake: Option<File>,
    /// The thread that delivers events to observers.
    deliverer: Option<JoinHandle<()>>,
    /// The thread that delivers records of the journal to observers.
    journal: Option<JoinHandle<RecordDelivery>>,
}

/// Time for which the answers of components are waited for.
const PATIENCE: Duration = Duration::from_millis(50);
/// Time for which a component may take to carry out an order.
const ORDER_PATIENCE: Duration = Duration::from_millis(500);

/// A remote control of a fleet. It may be cloned and used from any thread; after the end of the run it does nothing.
#[derive(Clone)]
pub struct Handle {
    shared: Arc<Shared>,
}

impl RunningFleet {
    /// Starts a fleet: constructs and initializes every component that runs from the start and every passive one,
    /// providers before those that call them, and then lets time begin.
    ///
    /// # Errors
    /// A component could not be constructed or initialized: then those before it have been shut down, their messages
    /// have reached no reader, and nothing runs. Or the system refuses threads, or real-time scheduling.
    pub fn start(
        assembly: Assembly,
        settings: Settings,
        observers: Vec<Arc<dyn Observer>>,
    ) -> Result<RunningFleet, StartError> {
        RunningFleet::start_with(assembly, settings, observers, |_| ())
    }

    /// The same, with code that gets the remote control before the components initialize, which may take long.
    ///
    /// # Errors
    /// As [`start`](RunningFleet::start).
    pub fn start_with(
        assembly: Assembly,
        settings: Settings,
        observers: Vec<Arc<dyn Observer>>,
        before: impl FnOnce(&Handle),
    ) -> Result<RunningFleet, StartError> {
        contain::install_hook();
        let settings = settings.checked();
        let simulated = settings.clock == ClockKind::Virtual;
        let realtime = settings.realtime && !simulated;
        if realtime {
            realtime::enter().map_err(StartError::Realtime)?;
        }
        let awake = realtime.then(realtime::keep_awake).transpose();
        let clock = if simulated { Clock::simulated() } else { Clock::real() };
        let shared = Arc::new(Shared::new(settings, clock, observers));
        shared.stops.serve(&shared);
        let components: Vec<ComponentName> = assembly.components.iter().map(ComponentName::of).collect();
        let (seed, is_virtual) = (shared.settings.seed, simulated);
        let beginning = Beginning { seed, is_virtual, components: &components };
        shared.observers.begin(&beginning).map_err(StartError::Observer)?;
        let deliverer = Arc::clone(&shared);
        let deliverer = thread::Builder::new()
            .name("saoms-events".to_owned())
            .spawn(move || deliverer.events.deliver(&deliverer.observers, || deliverer.progress()))
            .map_err(StartError::Thread)?;
        // From here on, dropping the fleet ends the run.
        let handle = Handle { shared };
        if let Err(error) = &awake {
            let text =
                format!("processors that sleep will be slow to wake, /dev/cpu_dma_latency cannot be held: {error}");
            handle.shared.note(Level::Warning, text);
        }
        let mut fleet =
            RunningFleet { handle, _awake: awake.unwrap_or_default(), deliverer: Some(deliverer), journal: None };
        fleet.journal = spawn_journal(&fleet.handle.shared).map_err(StartError::Thread)?;
        let shared = &fleet.handle.shared;
        drive::spawn(shared).map_err(StartError::Thread)?;
        before(&fleet.handle);
        change::apply(shared, assembly)?;
        Ok(fleet)
    }

    /// A remote control of this fleet.
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }

    /// Waits until the fleet has reached this time, or has ended. Virtual time advances exactly to it: executions due
    /// at that instant are still to come.
    pub fn run_until(&self, time: Time) {
        let (shared, time) = (&self.handle.shared, time.as_nanos());
        if shared.clock.is_virtual() {
            self.resume(time);
            drive::wait_until(shared, |engine| engine.roles.asleep_until != 0 && shared.clock.now() >= time);
            return;
        }
        let deadline = shared.clock.on_machine(time);
        loop {
            let ticket = shared.end.ticket();
            if shared.lock().phase == RunPhase::Ended || shared.clock.now() >= time {
                return;
            }
            shared.end.wait(ticket, Some(deadline));
        }
    }

    /// Runs the fleet to its end: all voters see no work left, the given time is over, a stop was requested, or no
    /// component is left that can run. Afterwards every component has shut down, or is named in the outcome.
    pub fn run_to_end(mut self) -> RunReport {
        self.wait_for_end();
        self.wait_for_hardware();
        self.finish_journal();
        let shared = &self.handle.shared;
        let report = shared.lock().report(&shared.sections());
        self.finish();
        self.handle.shared.observers.end(&report);
        report
    }

    /// Waits until every component has shut down. What observers still have to show, [`run_to_end`](Self::run_to_end)
    /// waits for.
    pub fn wait_for_end(&self) {
        if self.handle.shared.clock.is_virtual() {
            self.resume(NEVER);
        }
        drive::wait_until(&self.handle.shared, |_| false);
    }

    /// Waits until the functions that stop hardware have returned, as long as components have to end.
    fn wait_for_hardware(&self) {
        let shared = &self.handle.shared;
        for name in shared.stops.wait(shared.settings.grace) {
            let message = "the function that stops it has not returned".to_owned();
            shared.lock().reasons.push(format!("component `{name}` could not stop its hardware: {message}"));
        }
    }

    /// Lets virtual time advance to this time.
    fn resume(&self, time: u64) {
        let shared = &self.handle.shared;
        let mut engine = shared.lock();
        engine.pause = time.max(engine.pause);
        engine.roles.asleep_until = 0;
        shared.release(engine);
        shared.timer.wake();
    }

    /// Waits until the last records are delivered.
    fn finish_journal(&mut self) {
        let Some(journal) = self.journal.take() else { return };
        let shared = &self.handle.shared;
        let (records, end) = {
            let engine = shared.lock();
            (engine.records.clone(), Time::from_nanos(engine.ended.0))
        };
        if let Some(records) = records {
            records.close(end);
        }
        // The panic of an observer was written to standard error.
        let Ok(delivery) = journal.join() else { return };
        let mut engine = shared.lock();
        engine.lost_records = delivery.lost;
        engine.reasons.extend(delivery.failures.iter().map(ToString::to_string));
    }

    /// Waits until the last events are delivered.
    fn finish(&mut self) {
        self.finish_journal();
        self.handle.shared.close_events();
        if let Some(deliverer) = self.deliverer.take() {
            // The panic of an observer was written to standard error.
            let _ = deliverer.join();
        }
    }
}

/// The kind of alerts about a file that cannot be written.
const FILE: &str = "file";

/// Starts the thread that delivers records of the journal, if an observer wants them.
fn spawn_journal(shared: &Arc<Shared>) -> io::Result<Option<JoinHandle<RecordDelivery>>> {
    let Some(records) = shared.lock().records.clone() else { return Ok(None) };
    let shared = Arc::clone(shared);
    let deliver = move || {
        deliver_records(&records, &shared.observers, |failure| shared.alert(FILE, "journal", failure.to_string()))
    };
    thread::Builder::new().name("saoms-journal".to_owned()).spawn(deliver).map(Some)
}

impl Drop for RunningFleet {
    fn drop(&mut self) {
        if self.deliverer.is_none() {
            return;
        }
        let shared = &self.handle.shared;
        let mut engine = shared.lock();
        if engine.phase == RunPhase::Starting {
            engine.phase = RunPhase::Ended;
            shared.release(engine);
            drive::announce_end(shared);
        } else {
            shared.release(engine);
            self.handle.stop();
            self.resume(NEVER);
            drive::wait_until(shared, |_| false);
        }
        self.wait_for_hardware();
        self.finish();
    }
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

    /// Changes the fleet to that of an assembly: components whose paths differ end and start, components that differ
    /// are replaced, and all others continue. Wires lead to components of the assembly.
    ///
    /// All new instances initialize first; then they take part from one instant on, and removed components shut down. A
    /// replaced component [saves](saoms_api::Component::save) the state for its successor; a component of another class
    /// starts without it.
    ///
    /// # Errors
    /// The fleet is unchanged: a component cannot be constructed or initialized, cannot be replaced or ended now, or
    /// the run ends.
    pub fn apply(&self, assembly: &Assembly) -> Result<Changed, ChangeError> {
        change::apply(&self.shared, assembly.clone())
    }

    /// Replaces a component by one of a new build of its class, as [`apply`](Handle::apply) does. The targets of its
    /// wires are the same as at the start; its task settings (period, delay, policies) stay.
    ///
    /// # Errors
    /// As [`apply`](Handle::apply), or there is no such component.
    pub fn replace(&self, spec: ComponentSpec) -> Result<Takeover, ChangeError> {
        change::replace(&self.shared, spec)
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
    /// effect, and components are asked for their status. Gives the time at which the run stands.
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
    /// The fleet has no such topic, the message does not fit its schema, or the run ends.
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

    /// Keeps the run from ending for want of work until the returned value is dropped: more messages may come from
    /// outside.
    pub fn hold(&self) -> Hold {
        self.shared.lock().injections.holds += 1;
        Hold { shared: Arc::clone(&self.shared) }
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
    /// at most ten times a second, and only when somebody wants to know. One that does not answer within 50 ms, because
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
