//! Where changes of alerts are delivered: a thread and a bounded queue for each target, so that nobody waits for one.

use std::fmt;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use saoms_api::Level;
use saoms_lang::model::HttpAddress;
use serde_json::json;

use super::{Alert, Change, command, webhook};
use crate::token::Token;

/// Number of changes that may wait for a target.
const WAITING: usize = 256;
/// The pause after the first attempt that fails; each further one is twice as long, up to the longest.
const FIRST_PAUSE: Duration = Duration::from_secs(1);
const LONGEST_PAUSE: Duration = Duration::from_secs(60);
/// Time after a change for which it is tried again: a network may be gone for minutes, and the person is still needed.
const PERSISTENCE: Duration = Duration::from_secs(600);
/// Time after the end for a thread to notice it.
const NOTICE: Duration = Duration::from_millis(500);

/// Where changes of alerts are delivered.
#[derive(Clone, Debug)]
pub enum AlertTarget {
    /// A command of the shell.
    Command {
        /// The command.
        line: String,
        /// The folder in which it runs.
        folder: PathBuf,
    },
    /// An address that takes requests of HTTP.
    Url {
        /// The address.
        address: HttpAddress,
        /// The secret that it asks for.
        token: Option<Token>,
    },
}

impl fmt::Display for AlertTarget {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // Its text may hold what is nobody's business.
            AlertTarget::Command { .. } => formatter.write_str("the command of the composite"),
            AlertTarget::Url { address, .. } => write!(formatter, "`{address}`"),
        }
    }
}

/// A change on its way.
#[derive(Debug)]
pub(super) struct Delivery {
    pub(super) fleet: Arc<str>,
    /// Start of the run in seconds since 1970: numbers of alerts are those of a run.
    pub(super) started: u64,
    pub(super) event: &'static str,
    pub(super) alert: Alert,
    queued: Instant,
}

impl Delivery {
    /// The change as JSON.
    pub(super) fn json(&self) -> String {
        let Delivery { fleet, started, event, alert, .. } = self;
        json!({"fleet": &**fleet, "started": started, "event": event, "alert": alert}).to_string()
    }
}

/// Why an attempt failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Failed {
    /// Another attempt may succeed.
    ForNow(String),
    /// The target refuses this change: no other attempt will succeed.
    ForGood(String),
}

/// When the run ends, if it does.
#[derive(Debug, Default)]
pub(super) struct End {
    deadline: Mutex<Option<Instant>>,
    set: Condvar,
}

impl End {
    fn set(&self, deadline: Instant) {
        *self.deadline.lock().unwrap_or_else(PoisonError::into_inner) = Some(deadline);
        self.set.notify_all();
    }

    /// The time by which all has to be over.
    pub(super) fn deadline(&self) -> Option<Instant> {
        *self.deadline.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for so long; false if the run ends.
    fn pause(&self, time: Duration) -> bool {
        let deadline = self.deadline.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.set.wait_timeout_while(deadline, time, |deadline| deadline.is_none());
        waited.unwrap_or_else(PoisonError::into_inner).0.is_none()
    }
}

/// The targets of a fleet.
#[derive(Debug, Default)]
pub(super) struct Targets {
    fleet: Arc<str>,
    started: u64,
    all: Vec<(SyncSender<Arc<Delivery>>, JoinHandle<()>)>,
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    /// Changes that wait for a target, once for each.
    waiting: AtomicU64,
    undelivered: AtomicU64,
    end: End,
}

impl Targets {
    /// Starts a thread for each target. `note` writes to the log of the fleet.
    pub(super) fn start<N>(&mut self, fleet: &str, started: u64, targets: Vec<AlertTarget>, note: &N)
    where
        N: Fn(Level, String) + Clone + Send + 'static,
    {
        (self.fleet, self.started) = (fleet.into(), started);
        for target in targets {
            let (sender, receiver) = sync_channel(WAITING);
            let (shared, own) = (Arc::clone(&self.shared), note.clone());
            let work = move || run(&target, &receiver, &shared, own);
            match thread::Builder::new().name("saoms-alerts".to_owned()).spawn(work) {
                Ok(thread) => self.all.push((sender, thread)),
                Err(error) => {
                    let text = format!("alerts are not delivered: the system cannot create a thread: {error}");
                    note(Level::Error, text);
                }
            }
        }
    }

    /// Queues a change for each target; never waits.
    pub(super) fn put(&self, change: Change, alert: &Alert) {
        if self.all.is_empty() {
            return;
        }
        let (fleet, started, event) = (Arc::clone(&self.fleet), self.started, change.name());
        let delivery = Arc::new(Delivery { fleet, started, event, alert: alert.clone(), queued: Instant::now() });
        for (sender, _) in &self.all {
            self.shared.waiting.fetch_add(1, Ordering::Relaxed);
            if sender.try_send(Arc::clone(&delivery)).is_err() {
                self.shared.waiting.fetch_sub(1, Ordering::Relaxed);
                self.shared.undelivered.fetch_add(1, Ordering::Relaxed);
            }
        }
    }

    /// Changes that were not delivered, once for each target.
    pub(super) fn undelivered(&self) -> u64 {
        self.shared.undelivered.load(Ordering::Relaxed)
    }

    /// Ends the threads: each change that waits is tried once, as long as the time lasts. Gives the number of changes
    /// that were not delivered in the whole run.
    pub(super) fn finish(self, patience: Duration) -> u64 {
        let Targets { all, shared, .. } = self;
        let deadline = Instant::now() + patience;
        shared.end.set(deadline);
        // Without senders, the threads end after what waits.
        let threads: Vec<JoinHandle<()>> = all.into_iter().map(|(_, thread)| thread).collect();
        // One that looks up a name cannot be told to stop: what waits for it is lost, and the process ends.
        while threads.iter().any(|thread| !thread.is_finished()) && Instant::now() < deadline + NOTICE {
            thread::sleep(Duration::from_millis(5));
        }
        shared.undelivered.load(Ordering::Relaxed) + shared.waiting.load(Ordering::Relaxed)
    }
}

fn run(target: &AlertTarget, receiver: &Receiver<Arc<Delivery>>, shared: &Shared, note: impl Fn(Level, String)) {
    // What fails in a row is told once.
    let mut fails = false;
    for delivery in receiver {
        let id = delivery.alert.id;
        let told = |error: &str, then: &str| {
            note(Level::Error, format!("alert {id} cannot be delivered to {target}: {error}{then}"));
        };
        let outcome = deliver(
            &shared.end,
            delivery.queued,
            || attempt(target, &delivery, &shared.end),
            |error| {
                if !std::mem::replace(&mut fails, true) {
                    told(error, "; it is tried again, and later ones wait");
                }
            },
        );
        shared.waiting.fetch_sub(1, Ordering::Relaxed);
        match outcome {
            Ok(()) if std::mem::take(&mut fails) => {
                note(Level::Info, format!("alerts are delivered to {target} again"));
            }
            Ok(()) => {}
            Err(error) => {
                shared.undelivered.fetch_add(1, Ordering::Relaxed);
                if !std::mem::replace(&mut fails, true) {
                    told(&error, "");
                }
            }
        }
    }
}

fn attempt(target: &AlertTarget, delivery: &Delivery, end: &End) -> Result<(), Failed> {
    match target {
        AlertTarget::Command { line, folder } => command::run(line, folder, delivery, end),
        AlertTarget::Url { address, token } => webhook::post(address, token.as_ref(), &delivery.json(), end),
    }
}

/// Makes attempts until one succeeds, none can, or the run ends. `again` is told of each that is followed by another.
fn deliver(
    end: &End,
    queued: Instant,
    attempt: impl Fn() -> Result<(), Failed>,
    mut again: impl FnMut(&str),
) -> Result<(), String> {
    let mut pause = FIRST_PAUSE;
    loop {
        if end.deadline().is_some_and(|deadline| Instant::now() >= deadline) {
            return Err("the run ends".to_owned());
        }
        match attempt() {
            Ok(()) => return Ok(()),
            Err(Failed::ForGood(error)) => return Err(error),
            Err(Failed::ForNow(error)) => {
                if queued.elapsed() >= PERSISTENCE || end.deadline().is_some() {
                    return Err(error);
                }
                again(&error);
                // The last attempt comes when the run ends.
                let _ = end.pause(pause);
                pause = (2 * pause).min(LONGEST_PAUSE);
            }
        }
    }
}
