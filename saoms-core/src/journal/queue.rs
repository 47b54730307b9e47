use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use saoms_api::Time;

use super::batch::Batch;
use super::entry::Content;
use super::recorder::{Notice, Recorder};
use super::ring::LoopNames;
use super::{ComponentName, JournalEntry};

/// Maximum number of records that wait for the reader.
const CAPACITY: usize = 65_536;
/// Number of waiting records at which the reader takes them at once.
const HURRY: usize = CAPACITY / 4;
/// Time for which the reader lets records gather. A writer wakes it at most once in this time: for the first record of
/// an empty queue.
const PAUSE: Duration = Duration::from_millis(100);

/// A queue of records for the thread that calls the observers of the journal. In real time, adding a record never
/// blocks.
#[derive(Debug)]
pub(crate) struct RecordQueue {
    waiting: Mutex<Waiting>,
    reader: Mutex<Reader>,
    filled: Condvar,
    emptied: Condvar,
    /// True if those who write wait for room, as in virtual time; otherwise records that find no room are counted and
    /// lost.
    blocks_when_full: bool,
}

#[derive(Debug, Default)]
struct Waiting {
    batch: Batch,
    /// Names of loops, by component and place.
    names: Vec<(u32, u16, String)>,
    /// Components in the order of their numbers; the flag says that they joined a running fleet.
    joined: Vec<(ComponentName, bool)>,
    /// Records of messages from outside.
    outside: Vec<JournalEntry>,
    lost: u64,
    /// True if the reader waits for the first of these.
    reader_sleeps: bool,
    writers_sleep: bool,
    /// End of the run.
    closed: Option<Time>,
}

impl Waiting {
    /// True if there is nothing for the reader; names alone are nothing.
    fn is_empty(&self) -> bool {
        self.batch.len() == 0
            && self.joined.is_empty()
            && self.outside.is_empty()
            && self.lost == 0
            && self.closed.is_none()
    }
}

/// State of the reading thread.
#[derive(Debug, Default)]
struct Reader {
    batch: Batch,
    /// Components and their loops, by their numbers.
    components: Vec<(Arc<str>, LoopNames)>,
}

impl RecordQueue {
    pub(crate) fn new(blocks_when_full: bool) -> RecordQueue {
        RecordQueue {
            waiting: Mutex::default(),
            reader: Mutex::default(),
            filled: Condvar::new(),
            emptied: Condvar::new(),
            blocks_when_full,
        }
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a component, which gets the next number. `later` is true if it joins a running fleet.
    pub(crate) fn join(&self, component: ComponentName, later: bool) {
        let mut waiting = self.lock();
        waiting.joined.push((component, later));
        self.wake_reader(&mut waiting);
    }

    /// Adds a record of a message from outside.
    pub(crate) fn put_outside(&self, entry: JournalEntry) {
        let mut waiting = self.lock();
        waiting.outside.push(entry);
        self.wake_reader(&mut waiting);
    }

    /// Wakes the reader if it waits for the first record.
    fn wake_reader(&self, waiting: &mut Waiting) {
        if std::mem::take(&mut waiting.reader_sleeps) {
            self.filled.notify_one();
        }
    }

    /// Copies the new records of a component.
    pub(crate) fn put(&self, component: u32, recorder: &Recorder) {
        let mut waiting = self.lock();
        for notice in &recorder.notices {
            if let Notice::Name(place, name) = notice {
                waiting.names.push((component, *place, name.clone()));
            }
        }
        if waiting.batch.len() >= CAPACITY && !self.blocks_when_full {
            waiting.lost += recorder.batch.len() as u64;
            return;
        }
        let before = waiting.batch.len();
        waiting.batch.append(&recorder.batch);
        if before < HURRY && waiting.batch.len() >= HURRY {
            self.filled.notify_one();
        }
        self.wake_reader(&mut waiting);
    }

    /// True if writers that wait for room (in virtual time) have to wait.
    pub(crate) fn is_full(&self) -> bool {
        self.blocks_when_full && self.lock().batch.len() >= CAPACITY
    }

    /// Waits until it is not full any more.
    pub(crate) fn wait_for_room(&self) {
        let mut waiting = self.lock();
        while waiting.batch.len() >= CAPACITY && waiting.closed.is_none() {
            waiting.writers_sleep = true;
            waiting = self.emptied.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Closes the queue at the end of the run; its waiting records are still delivered.
    pub(crate) fn close(&self, end: Time) {
        self.lock().closed = Some(end);
        self.filled.notify_all();
        self.emptied.notify_all();
    }

    /// Waits for records and takes all of them. Returns the number of records that were lost for want of room, and the
    /// end of the run if these are the last ones. `joined` gets the components that joined the running fleet.
    pub(crate) fn next(&self, entries: &mut Vec<JournalEntry>, joined: &mut Vec<ComponentName>) -> (u64, Option<Time>) {
        let mut reader = self.reader.lock().unwrap_or_else(PoisonError::into_inner);
        let Reader { batch, components } = &mut *reader;
        batch.clear();
        let mut waiting = self.lock();
        while waiting.is_empty() {
            waiting.reader_sleeps = true;
            waiting = self.filled.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
        if waiting.batch.len() < HURRY && waiting.closed.is_none() {
            waiting = self.filled.wait_timeout(waiting, PAUSE).unwrap_or_else(PoisonError::into_inner).0;
        }
        std::mem::swap(batch, &mut waiting.batch);
        let names = std::mem::take(&mut waiting.names);
        let members = std::mem::take(&mut waiting.joined);
        let outside = std::mem::take(&mut waiting.outside);
        let lost = std::mem::take(&mut waiting.lost);
        let end = waiting.closed;
        if std::mem::take(&mut waiting.writers_sleep) {
            self.emptied.notify_all();
        }
        drop(waiting);
        components.extend(members.iter().map(|(named, _)| (Arc::from(named.name.as_str()), LoopNames::default())));
        joined.clear();
        joined.extend(members.into_iter().filter_map(|(named, later)| later.then_some(named)));
        for (component, place, name) in names {
            components[component as usize].1.set(place, &name);
        }
        entries.clear();
        entries.extend(outside);
        entries.extend(batch.heads().iter().map(|head| {
            let (component, loops) = &components[head.component as usize];
            JournalEntry {
                id: head.id,
                time: head.time(),
                component: Arc::clone(component),
                loop_name: loops.get(head.place),
                phase: head.phase,
                cause: head.cause,
                change: head.change,
                what: Content::Noted(batch.record(head)),
            }
        }));
        (lost, end)
    }
}
