use std::collections::VecDeque;
use std::panic::{self, AssertUnwindSafe};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use saoms_api::{Level, Time};

use super::{Event, Events, Occurrence, Progress, Sent};

/// How many events may wait for the program.
const CAPACITY: usize = 65_536;

/// What waits to be told.
pub(in crate::schedule) enum News {
    /// Something happened.
    Event(Event),
    /// A component sent a message on a topic that is wanted.
    Sent(Sent),
}

impl News {
    fn time(&self) -> Time {
        match self {
            News::Event(event) => event.time,
            News::Sent(sent) => sent.message.header().sent,
        }
    }

    fn tell(&self, events: &dyn Events) {
        match self {
            News::Event(event) => events.event(event),
            News::Sent(sent) => events.message(sent),
        }
    }
}

impl From<Event> for News {
    fn from(event: Event) -> News {
        News::Event(event)
    }
}

/// Events on their way to the thread that tells them. Putting one in never waits in real time.
pub(in crate::schedule) struct Line {
    waiting: Mutex<Waiting>,
    filled: Condvar,
    emptied: Condvar,
    /// Whether a full line holds up whoever has an event, as in virtual time.
    patient: bool,
    log_level: Option<Level>,
    console: bool,
}

#[derive(Default)]
struct Waiting {
    news: VecDeque<News>,
    lost: u64,
    reader_sleeps: bool,
    writers_sleep: bool,
    closed: bool,
}

impl Line {
    pub(in crate::schedule) fn new(events: &dyn Events, patient: bool) -> Line {
        Line {
            waiting: Mutex::default(),
            filled: Condvar::new(),
            emptied: Condvar::new(),
            patient,
            log_level: events.log_level(),
            console: events.wants_console(),
        }
    }

    /// Whether a log line of this level is wanted.
    #[inline]
    pub(in crate::schedule) fn wants(&self, level: Level) -> bool {
        self.log_level.is_some_and(|most| level <= most)
    }

    /// Whether console lines are wanted.
    #[inline]
    pub(in crate::schedule) fn wants_console(&self) -> bool {
        self.console
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(in crate::schedule) fn put(&self, news: impl Into<News>) {
        let mut waiting = self.lock();
        while waiting.news.len() >= CAPACITY && !waiting.closed {
            if !self.patient {
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

    /// Whether somebody who has an event waits for room.
    pub(in crate::schedule) fn is_jammed(&self) -> bool {
        self.lock().writers_sleep
    }

    /// Nothing more comes: [`tell`](Line::tell) returns when it has told what is there.
    pub(in crate::schedule) fn close(&self) {
        self.lock().closed = true;
        self.filled.notify_all();
        self.emptied.notify_all();
    }

    /// Tells events as they come, until the line is closed and empty.
    pub(in crate::schedule) fn tell(&self, events: &Arc<dyn Events>, progress: impl Fn() -> Progress) {
        let every = events.progress_every();
        let mut next_progress = every.map(|every| Instant::now() + every);
        let mut batch = VecDeque::new();
        loop {
            let (lost, closed) = self.next_batch(&mut batch, next_progress);
            let mut last = Time::START;
            // A program that panics over an event loses that event: the fleet goes on.
            let told = panic::catch_unwind(AssertUnwindSafe(|| {
                while let Some(news) = batch.pop_front() {
                    last = news.time();
                    news.tell(events.as_ref());
                }
                if lost > 0 {
                    let text = format!("{lost} events came faster than they could be shown, and are lost");
                    let what = Occurrence::Note { level: Level::Warning, text };
                    events.event(&Event { time: last, component: None, what });
                }
                if next_progress.is_some_and(|next| Instant::now() >= next) || (closed && every.is_some()) {
                    next_progress = every.map(|every| Instant::now() + every);
                    events.progress(&progress());
                }
            }));
            if told.is_err() {
                next_progress = every.map(|every| Instant::now() + every);
            }
            if closed && batch.is_empty() {
                return;
            }
        }
    }

    /// Waits until there is something to tell, and takes all of it.
    fn next_batch(&self, batch: &mut VecDeque<News>, until: Option<Instant>) -> (u64, bool) {
        let mut waiting = self.lock();
        while batch.is_empty() && waiting.news.is_empty() && !waiting.closed {
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
        if batch.is_empty() {
            std::mem::swap(batch, &mut waiting.news);
        }
        if std::mem::take(&mut waiting.writers_sleep) {
            self.emptied.notify_all();
        }
        // Behind an event over which the program panicked there may be more than the batch.
        let is_last = waiting.closed && waiting.news.is_empty();
        (std::mem::take(&mut waiting.lost), is_last)
    }
}
