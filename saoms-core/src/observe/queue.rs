use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use saoms_api::{Level, Time};

use super::{FleetSample, Interest, LostEvents, Observers, Occurrence, RunEvent, RunProgress, SentMessage};
use crate::tape::Step;

/// Maximum number of events that wait for the observers.
const CAPACITY: usize = 65_536;
/// Number of waiting events at which the reader takes them at once; so it does with few long lines or samples.
const HURRY: usize = CAPACITY / 4;
/// Time between two batches, in which events gather: a writer wakes the reader once for a batch, and not for each of
/// many thousand events a second. People do not notice this delay.
const PAUSE: Duration = Duration::from_millis(10);
/// Maximum size of the lines and steps among them, in bytes, beside the last one.
const MOST_BYTES: usize = 64 << 20;
/// Maximum number of samples that wait beside these: each is as large as the fleet.
const MOST_SAMPLES: usize = 2;

/// An event or a message on its way to the observers.
pub(crate) enum Notification {
    /// An event of the run.
    Event(RunEvent),
    /// A component sent a message on a topic that the observers of these numbers want.
    Sent(SentMessage, Arc<[u32]>),
    /// The fleet at one moment.
    Sample(Box<FleetSample>),
    /// A step of a component whose tape the observers of these numbers want.
    Step(Arc<str>, Box<Step>, Arc<[u32]>),
}

impl Notification {
    fn time(&self) -> Time {
        match self {
            Notification::Event(event) => event.time,
            Notification::Sent(sent, _) => sent.message.header().sent,
            Notification::Sample(sample) => sample.time,
            Notification::Step(_, step, _) => Time::from_nanos(step.time),
        }
    }

    fn deliver(&self, observers: &Observers) {
        match self {
            Notification::Event(event) => observers.event(event),
            Notification::Sent(sent, who) => observers.message(sent, who),
            Notification::Sample(sample) => observers.sample(sample),
            Notification::Step(component, step, who) => observers.step(component, step, who),
        }
    }
}

impl Notification {
    /// Bytes of its line, if a component wrote one, or of a step.
    fn size(&self) -> usize {
        match self {
            Notification::Event(RunEvent {
                what:
                    Occurrence::Log { text, .. } | Occurrence::Console { text } | Occurrence::Alert { text: Some(text), .. },
                ..
            }) => text.len(),
            Notification::Step(_, step, _) => step.size(),
            _ => 0,
        }
    }
}

impl From<RunEvent> for Notification {
    fn from(event: RunEvent) -> Notification {
        Notification::Event(event)
    }
}

/// A queue of events and messages for the thread that calls the observers. In real time, adding one never blocks.
pub(crate) struct EventQueue {
    waiting: Mutex<Waiting>,
    filled: Condvar,
    emptied: Condvar,
    /// True if a writer waits when the queue is full, as in virtual time.
    blocks_when_full: bool,
    interest: Interest,
}

/// What had no room.
#[derive(Default)]
pub(super) struct Lost {
    events: u64,
    samples: u64,
    /// The alerts among the events, and the messages by the numbers of the observers that want them.
    alerts: u64,
    messages: BTreeMap<u32, u64>,
}

#[derive(Default)]
struct Waiting {
    notifications: VecDeque<Notification>,
    /// Bytes of their lines.
    bytes: usize,
    /// Number of samples among them.
    samples: usize,
    lost: Lost,
    reader_sleeps: bool,
    writers_sleep: bool,
    closed: bool,
}

impl Waiting {
    /// True if the reader takes them at once, so that there is room for what comes.
    fn is_much(&self) -> bool {
        self.notifications.len() >= HURRY || self.bytes >= MOST_BYTES / 4 || self.samples >= MOST_SAMPLES
    }

    /// True if there is no room for one more. Samples have room of their own, and that of the end has it always.
    fn is_full_for(&self, notification: &Notification) -> bool {
        match notification {
            Notification::Sample(sample) => self.samples >= MOST_SAMPLES && !sample.is_last,
            _ => self.notifications.len() - self.samples >= CAPACITY || self.bytes >= MOST_BYTES,
        }
    }
}

impl Lost {
    fn note(&mut self, notification: &Notification) {
        match notification {
            Notification::Sample(_) => self.samples += 1,
            Notification::Event(event) => {
                self.events += 1;
                self.alerts += u64::from(matches!(event.what, Occurrence::Alert { .. }));
            }
            Notification::Sent(_, who) | Notification::Step(_, _, who) => {
                self.events += 1;
                who.iter().for_each(|number| *self.messages.entry(*number).or_default() += 1);
            }
        }
    }

    /// What an observer lacks of it, by its number; `None` if it lacks nothing that it may have to count.
    pub(super) fn of(&self, number: usize) -> Option<LostEvents> {
        let messages = u32::try_from(number).ok().and_then(|number| self.messages.get(&number).copied());
        let lost = LostEvents { alerts: self.alerts, messages: messages.unwrap_or(0) };
        (lost != LostEvents::default()).then_some(lost)
    }

    /// What is told of it.
    fn texts(&self) -> impl Iterator<Item = String> + use<> {
        let Lost { events, samples, .. } = *self;
        let events =
            (events > 0).then(|| format!("{events} events came faster than they could be shown, and were lost"));
        let samples = (samples > 0).then(|| {
            format!("{samples} samples of the fleet came faster than they could be taken in, and were left out")
        });
        events.into_iter().chain(samples)
    }
}

impl EventQueue {
    pub(crate) fn new(interest: Interest, blocks_when_full: bool) -> EventQueue {
        EventQueue {
            waiting: Mutex::default(),
            filled: Condvar::new(),
            emptied: Condvar::new(),
            blocks_when_full,
            interest,
        }
    }

    /// True if an observer wants log lines of this level.
    #[inline]
    pub(crate) fn wants(&self, level: Level) -> bool {
        self.interest.log.is_some_and(|most| level <= most)
    }

    /// True if an observer wants console lines.
    #[inline]
    pub(crate) fn wants_console(&self) -> bool {
        self.interest.console
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn put(&self, notification: impl Into<Notification>) {
        let notification = notification.into();
        let mut waiting = self.lock();
        while waiting.is_full_for(&notification) && !waiting.closed {
            if !self.blocks_when_full {
                waiting.lost.note(&notification);
                return;
            }
            waiting.writers_sleep = true;
            self.filled.notify_one();
            waiting = self.emptied.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
        let was_much = waiting.is_much();
        waiting.bytes += notification.size();
        waiting.samples += usize::from(matches!(notification, Notification::Sample(_)));
        waiting.notifications.push_back(notification);
        if std::mem::take(&mut waiting.reader_sleeps) || !was_much && waiting.is_much() {
            self.filled.notify_one();
        }
    }

    /// True if a writer waits for room.
    pub(crate) fn has_waiting_writers(&self) -> bool {
        self.lock().writers_sleep
    }

    /// Closes the queue: [`deliver`](EventQueue::deliver) returns when it has delivered the waiting events.
    pub(crate) fn close(&self) {
        self.lock().closed = true;
        self.filled.notify_all();
        self.emptied.notify_all();
    }

    /// Delivers events as they come, until the queue is closed and empty.
    pub(crate) fn deliver(&self, observers: &Observers, progress: impl Fn() -> RunProgress) {
        let every = self.interest.progress;
        let mut next_progress = every.map(|every| Instant::now() + every);
        let mut batch = VecDeque::new();
        let mut gathered = Instant::now();
        loop {
            let (lost, closed) = self.next_batch(&mut batch, next_progress, gathered);
            gathered = Instant::now() + PAUSE;
            let mut last = Time::START;
            for notification in batch.drain(..) {
                last = notification.time();
                notification.deliver(observers);
            }
            observers.lost(&lost);
            for text in lost.texts() {
                let what = Occurrence::Note { level: Level::Warning, text };
                observers.event(&RunEvent { time: last, component: None, what });
            }
            if next_progress.is_some_and(|next| closed || Instant::now() >= next) {
                next_progress = every.map(|every| Instant::now() + every);
                observers.progress(&progress());
            }
            if closed {
                return;
            }
        }
    }

    /// Waits for events, lets them gather until a moment, and takes all of them. The flag is true if the queue is
    /// closed.
    fn next_batch(
        &self,
        batch: &mut VecDeque<Notification>,
        until: Option<Instant>,
        gathered: Instant,
    ) -> (Lost, bool) {
        let mut waiting = self.lock();
        while waiting.notifications.is_empty() && !waiting.closed {
            waiting.reader_sleeps = true;
            waiting = match until {
                None => self.filled.wait(waiting).unwrap_or_else(PoisonError::into_inner),
                Some(until) => {
                    let left = until.saturating_duration_since(Instant::now());
                    if left == Duration::ZERO {
                        break;
                    }
                    self.filled.wait_timeout(waiting, left).unwrap_or_else(PoisonError::into_inner).0
                }
            };
        }
        waiting.reader_sleeps = false;
        while !waiting.is_much() && !waiting.writers_sleep && !waiting.closed {
            let left = gathered.saturating_duration_since(Instant::now());
            if left == Duration::ZERO {
                break;
            }
            waiting = self.filled.wait_timeout(waiting, left).unwrap_or_else(PoisonError::into_inner).0;
        }
        std::mem::swap(batch, &mut waiting.notifications);
        (waiting.bytes, waiting.samples) = (0, 0);
        if std::mem::take(&mut waiting.writers_sleep) {
            self.emptied.notify_all();
        }
        (std::mem::take(&mut waiting.lost), waiting.closed)
    }
}
