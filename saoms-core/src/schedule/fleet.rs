use std::fs::File;
use std::io;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use saoms_api::host::contain;
use saoms_api::{Level, Time};
use saoms_lang::assembly::Assembly;

use super::change::{self, StartError};
use super::component::library::with_library;
use super::drive::{self, store_writer};
use super::engine::RunPhase;
use super::engine::slot::NEVER;
use super::handle::Handle;
use super::os::clock::Clock;
use super::os::realtime;
use super::os::thread::start_thread;
use super::settings::{ClockKind, Settings};
use super::shared::Shared;
use crate::journal::ComponentName;
use crate::observe::{Beginning, Observer, RecordDelivery, deliver_records};
use crate::report::RunReport;

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
        RunningFleet::start_with(assembly, settings, observers, |_| Ok(()))
    }

    /// The same, with code that gets the remote control before the components initialize, which may take long.
    ///
    /// # Errors
    /// As [`start`](RunningFleet::start), or those of that code.
    pub fn start_with(
        assembly: Assembly,
        settings: Settings,
        observers: Vec<Arc<dyn Observer>>,
        before: impl FnOnce(&Handle) -> Result<(), StartError>,
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
        let deliver = move || deliverer.events.deliver(&deliverer.observers, || deliverer.progress());
        let deliverer = start_thread("saoms-events", deliver).map_err(StartError::Thread)?;
        // From here on, dropping the fleet ends the run.
        let handle = Handle { shared };
        if let Err(error) = &awake {
            let text = format!("idle processors may wake up late: /dev/cpu_dma_latency cannot be opened: {error}");
            handle.shared.note(Level::Warning, text);
        }
        let mut fleet =
            RunningFleet { handle, _awake: awake.unwrap_or_default(), deliverer: Some(deliverer), journal: None };
        fleet.journal = spawn_journal(&fleet.handle.shared).map_err(StartError::Thread)?;
        let shared = &fleet.handle.shared;
        drive::spawn(shared).map_err(StartError::Thread)?;
        before(&fleet.handle)?;
        let remembered = shared.look(|engine| {
            let recalled = engine.memory.recalled.as_ref();
            recalled.map(|recalled| recalled.components().map(str::to_owned).collect::<Vec<_>>())
        });
        change::start(shared, assembly)?;
        store_writer::note_unused(shared, &remembered.unwrap_or_default());
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
        store_writer::finish(&self.handle.shared);
        self.finish_journal();
        let shared = &self.handle.shared;
        let mut report = shared.lock().report(&shared.sections());
        if let Some(part) = &mut report.part {
            let passed = Duration::from_nanos(shared.clock.now_without_pause().saturating_sub(shared.clock.origin()));
            let began = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().saturating_sub(passed);
            part.began_us = u64::try_from(began.as_micros()).unwrap_or(u64::MAX);
        }
        self.finish();
        self.handle.shared.observers.end(&mut report);
        report
    }

    /// Waits until every component has shut down. What observers still have to show, [`run_to_end`](Self::run_to_end)
    /// waits for.
    pub fn wait_for_end(&self) {
        if self.handle.shared.clock.is_virtual() {
            self.resume(NEVER);
        }
        drive::wait_until(&self.handle.shared, |_| false);
        store_writer::wait_for_commits(&self.handle.shared);
    }

    /// Waits until the functions that stop hardware have returned, as long as components have to end.
    fn wait_for_hardware(&self) {
        let shared = &self.handle.shared;
        for name in shared.stops.wait(shared.settings.grace) {
            let mut engine = shared.lock();
            let mut message = "the function that stops it has not returned".to_owned();
            if let Some(slot) = engine.slots.iter().find(|slot| slot.name == name) {
                message = with_library(&slot.spec, message);
            }
            engine.reasons.push(format!("component `{name}` could not stop its hardware: {message}"));
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
        deliver_records(&records, &shared.observers, |failure| shared.alert(FILE, "journal", Some(failure.to_string())))
    };
    start_thread("saoms-journal", deliver).map(Some)
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
        store_writer::finish(&self.handle.shared);
        self.finish();
    }
}
