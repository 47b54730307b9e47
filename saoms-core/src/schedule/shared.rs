use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};
use std::thread::JoinHandle;
use std::time::Duration;

use saoms_api::Time;

use super::drive::pulse::Pulse;
use super::engine::Engine;
use super::engine::sampling::Sampling;
use super::names::SlotNames;
use super::networks::elsewhere::RemoteNames;
use super::os::clock::Clock;
use super::os::sys::Gate;
use super::settings::Settings;
use super::stop::Stops;
use super::topics::speakers::Speakers;
use super::topics::takers::Takers;
use crate::journal::RecordQueue;
use crate::observe::{EventQueue, Observer, Observers, Occurrence, RunEvent, RunProgress};
use crate::report::Sections;
use crate::status::summaries;
use crate::store::StoreQueue;
use crate::web::WebClient;

/// Everything that the threads of a run share. The lock of the engine is held for bookkeeping alone, never while
/// component code runs or a thread sleeps.
pub(super) struct Shared {
    engine: Mutex<Engine>,
    sections: Mutex<Sections>,
    /// The paths of components by their numbers.
    pub(super) names: SlotNames,
    /// The paths of components of other programs.
    pub(super) remote_names: Arc<RemoteNames>,
    /// Functions that stop hardware.
    pub(super) stops: Arc<Stops>,
    /// Lock of changes of the fleet: one at a time.
    changes: Mutex<()>,
    /// Signals that an awaited body has returned.
    returned: Condvar,
    pub(super) settings: Settings,
    pub(super) clock: Arc<Clock>,
    /// Events and messages on their way to the observers.
    pub(super) events: EventQueue,
    pub(super) observers: Observers,
    /// Gate at which the thread with the timer's work sleeps.
    pub(super) timer: Gate,
    /// Gate at which the spare thread that watches it sleeps.
    pub(super) spare: Gate,
    /// Gate at which the thread that waits for the end sleeps.
    pub(super) end: Gate,
    pub(super) pulse: Pulse,
    /// Who calls services of the web.
    pub(super) web: OnceLock<Arc<dyn WebClient>>,
    /// Where components keep what is to outlive the program, and the thread that writes it.
    pub(super) store: OnceLock<Arc<StoreQueue>>,
    pub(super) store_thread: Mutex<Option<JoinHandle<()>>>,
    /// Signals work for the worker threads, or the end of the run.
    pub(super) work: Condvar,
    /// True if the end was requested, and whether an operator did so.
    pub(super) stop: AtomicBool,
    pub(super) is_down: AtomicBool,
    /// The run has ended.
    pub(super) ended: AtomicBool,
    /// Counter of the journal's records.
    pub(super) records: Arc<AtomicU64>,
    executions: Arc<AtomicU64>,
    /// Number of threads that have unlocked the engine and not yet queued their events.
    delivering: AtomicUsize,
    /// The queue of events is about to be closed.
    closing: AtomicBool,
}

impl Shared {
    pub(super) fn new(settings: Settings, clock: Clock, observers: Vec<Arc<dyn Observer>>) -> Shared {
        let clock = Arc::new(clock);
        let mut engine = Engine::new(&settings, &clock);
        let observers = Observers::new(observers);
        let interest = observers.interest();
        let events = EventQueue::new(interest, clock.is_virtual());
        engine.sampling = Sampling::of(observers.sample_rates());
        if interest.journal {
            engine.records = Some(Arc::new(RecordQueue::new(clock.is_virtual())));
        }
        let records = Arc::clone(&engine.record_ids);
        Shared {
            stops: Arc::clone(&engine.stops),
            executions: Arc::clone(&engine.executions),
            sections: Mutex::new(Sections::with_registered_counts()),
            names: SlotNames::default(),
            remote_names: engine.networks.elsewhere.names(),
            engine: Mutex::new(engine),
            changes: Mutex::default(),
            returned: Condvar::new(),
            settings,
            clock,
            events,
            observers,
            timer: Gate::default(),
            spare: Gate::default(),
            end: Gate::default(),
            pulse: Pulse::default(),
            web: OnceLock::new(),
            store: OnceLock::new(),
            store_thread: Mutex::default(),
            work: Condvar::new(),
            stop: AtomicBool::new(false),
            is_down: AtomicBool::new(false),
            ended: AtomicBool::new(false),
            records,
            delivering: AtomicUsize::new(0),
            closing: AtomicBool::new(false),
        }
    }

    #[inline]
    pub(super) fn lock(&self) -> MutexGuard<'_, Engine> {
        self.engine.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What can be seen of the engine while it is locked.
    pub(super) fn look<T>(&self, see: impl FnOnce(&Engine) -> T) -> T {
        let engine = self.lock();
        let seen = see(&engine);
        self.release(engine);
        seen
    }

    /// Unlocks the engine, then queues its events, and wakes the timer if necessary.
    #[inline]
    pub(super) fn release(&self, mut engine: MutexGuard<'_, Engine>) {
        let wake = std::mem::take(&mut engine.wake);
        if std::mem::take(&mut engine.has_returned) {
            self.returned.notify_all();
        }
        // Left in order, so it is left while the engine is locked.
        let networks = &mut engine.networks;
        let left = if networks.waiting.is_empty() { Vec::new() } else { networks.leave() };
        let notifications = std::mem::take(&mut engine.notifications);
        let is_delivering = !notifications.is_empty();
        if is_delivering {
            self.delivering.fetch_add(1, Ordering::Relaxed);
        }
        drop(engine);
        for event in notifications {
            self.events.put(event);
        }
        // Both are sequentially consistent: either the thread that closes the queue sees the lower count, or it is
        // woken.
        if is_delivering && self.delivering.fetch_sub(1, Ordering::SeqCst) == 1 && self.closing.load(Ordering::SeqCst) {
            self.end.wake();
        }
        if wake {
            self.timer.wake();
        }
        // A real-time thread waits for no locks of a transport, whose threads have a lower priority.
        let may_send = !self.settings.realtime;
        left.iter().for_each(|port| port.send(may_send));
    }

    /// Waits until all threads have queued their events at the end of the run, and closes the queue.
    pub(super) fn close_events(&self) {
        // A thread with events took the lock before the end was visible, so that it is counted by now.
        drop(self.lock());
        self.closing.store(true, Ordering::SeqCst);
        loop {
            let ticket = self.end.ticket();
            if self.delivering.load(Ordering::SeqCst) == 0 {
                break;
            }
            self.end.wait(ticket, None);
        }
        self.events.close();
    }

    /// The components that take events at present.
    pub(super) fn takers(&self) -> Arc<Takers> {
        let (members, changes) = {
            let engine = self.lock();
            if let Some(known) = &engine.takers.0 {
                return Arc::clone(known);
            }
            (engine.members_everywhere().collect::<Vec<_>>(), engine.takers.1)
        };
        let takers = Arc::new(Takers::of(members.into_iter()));
        let mut engine = self.lock();
        if engine.takers.1 == changes {
            engine.takers.0 = Some(Arc::clone(&takers));
        }
        takers
    }

    /// The components that say who they are in messages.
    pub(super) fn speakers(&self) -> Arc<Speakers> {
        let (members, changes) = {
            let engine = self.lock();
            if let Some(known) = &engine.speakers {
                return Arc::clone(known);
            }
            (engine.members_everywhere().map(|(_, spec)| spec).collect::<Vec<_>>(), engine.takers.1)
        };
        let speakers = Arc::new(Speakers::of(members.into_iter()));
        let mut engine = self.lock();
        if engine.takers.1 == changes {
            engine.speakers = Some(Arc::clone(&speakers));
        }
        speakers
    }

    pub(super) fn sections(&self) -> MutexGuard<'_, Sections> {
        self.sections.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Locks out other changes of the fleet.
    pub(super) fn lock_changes(&self) -> MutexGuard<'_, ()> {
        self.changes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Locks out other changes of the fleet; `None` while one is being made.
    pub(super) fn try_lock_changes(&self) -> Option<MutexGuard<'_, ()>> {
        match self.changes.try_lock() {
            Ok(guard) => Some(guard),
            Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// Unlocks the engine until a body returns, or until the time is over.
    pub(super) fn wait_for_return<'a>(
        &self,
        mut engine: MutexGuard<'a, Engine>,
        time: Duration,
    ) -> MutexGuard<'a, Engine> {
        engine.awaited += 1;
        let waited = self.returned.wait_timeout(engine, time).unwrap_or_else(PoisonError::into_inner);
        let mut engine = waited.0;
        engine.awaited -= 1;
        engine
    }

    /// Queues a note about the fleet as a whole.
    pub(super) fn note(&self, level: saoms_api::Level, text: String) {
        let time = Time::from_nanos(self.clock.now());
        self.events.put(RunEvent { time, component: None, what: Occurrence::Note { level, text } });
    }

    /// Queues an alert of the fleet as a whole; without a text, that it is over.
    pub(super) fn alert(&self, kind: &str, subject: &str, text: Option<String>) {
        let time = Time::from_nanos(self.clock.now());
        let what = Occurrence::Alert { kind: kind.into(), subject: subject.into(), text };
        self.events.put(RunEvent { time, component: None, what });
    }

    pub(super) fn progress(&self) -> RunProgress {
        let time = Time::from_nanos(self.clock.now());
        let periods = self.executions.load(Ordering::Relaxed);
        let sections = self.sections();
        RunProgress { time, periods, summaries: summaries(|path| sections.integer(path).unwrap_or(0)) }
    }
}

/// Locks the engine again after a wait.
pub(super) fn relock<'a>(condition: &Condvar, engine: MutexGuard<'a, Engine>) -> MutexGuard<'a, Engine> {
    condition.wait(engine).unwrap_or_else(PoisonError::into_inner)
}
