use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use saoms_api::{Level, Time};

use super::{Interest, Observers, Occurrence, RunEvent, RunProgress, SentMessage};

/// Maximum number of events that wait for the observers.
const CAPACITY: usize = 65_536;

/// An event or a message on its way to the observers.
pub(crate) enum News {
    /// An event of the run.
    Event(RunEvent),
    /// A component sent a message on a topic that the observers of these numbers want.
    Sent(SentMessage, Arc<[u32]>),
}

impl News {
    fn time(&self) -> Time {
        match self {
            News::Event(event) => event.time,
            News::Sent(sent, _) => sent.message.header().sent,
        }
    }

    fn tell(&self, observers: &Observers) {
        match self {
            News::Event(event) => observers.event(event),
            News::Sent(sent, who) => observers.message(sent, who),
        }
    }
}

impl From<RunEvent> for News {
    fn from(event: RunEvent) -> News {
        News::Event(event)
    }
}

/// A queue of events and messages for the thread that calls the observers. In real time, adding one never blocks.
pub(crate) struct EventQueue {
    waiting: Mutex<Waiting>,
    filled: Condvar,
    emptied: Condvar,
    /// True if a writer waits when the queue is full, as in virtual time.
    is_patient: bool,
    interest: Interest,
}

#[derive(Default)]
struct Waiting {
    news: VecDeque<News>,
    lost: u64,
    reader_sleeps: bool,
    writers_sleep: bool,
    closed: bool,
}

impl EventQueue {
    pub(crate) fn new(interest: Interest, is_patient: bool) -> EventQueue {
        EventQueue {
            waiting: Mutex::default(),
            filled: Condvar::new(),
            emptied: Condvar::new(),
            is_patient,
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

    pub(crate) fn put(&self, news: impl Into<News>) {
        let mut waiting = self.lock();
        while waiting.news.len() >= CAPACITY && !waiting.closed {
            if !self.is_patient {
                waiting.lost += 1;
                return;
            }
            waiting.writers_sleep = true;
            waiting = self.emptied.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
        waiting.news.push_back(news.into());
        if std::mem::take(&mut waiting.reader_sleeps) {
            self.filled.notify_one();
        }
    }

    /// True if a writer waits for room.
    pub(crate) fn is_jammed(&self) -> bool {
        self.lock().writers_sleep
    }

    /// Closes the queue: [`tell`](EventQueue::tell) returns when it has delivered the waiting events.
    pub(crate) fn close(&self) {
        self.lock().closed = true;
        self.filled.notify_all();
        self.emptied.notify_all();
    }

    /// Delivers events as they come, until the queue is closed and empty.
    pub(crate) fn tell(&self, observers: &Observers, progress: impl Fn() -> RunProgress) {
        let every = self.interest.progress;
        let mut next_progress = every.map(|every| Instant::now() + every);
        let mut batch = VecDeque::new();
        loop {
            let (lost, closed) = self.next_batch(&mut batch, next_progress);
            let mut last = Time::START;
            for news in batch.drain(..) {
                last = news.time();
                news.tell(observers);
            }
            if lost > 0 {
                let text = format!("{lost} events came faster than they could be shown, and are lost");
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

    /// Waits for events and takes all of them. The flag is true if the queue is closed.
    fn next_batch(&self, batch: &mut VecDeque<News>, until: Option<Instant>) -> (u64, bool) {
        let mut waiting = self.lock();
        while waiting.news.is_empty() && !waiting.closed {
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
        std::mem::swap(batch, &mut waiting.news);
        if std::mem::take(&mut waiting.writers_sleep) {
            self.emptied.notify_all();
        }
        (std::mem::take(&mut waiting.lost), waiting.closed)
    }
}
