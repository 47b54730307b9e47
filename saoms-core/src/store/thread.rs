use std::fmt;
use std::io;
use std::mem;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use super::log::{CommitError, Log, LogFile};
use super::{Change, Contents, Store, group};

/// What is committed together.
#[derive(Debug, Default)]
pub(crate) struct Batch {
    /// Whose it is.
    pub(crate) index: u32,
    /// Number of the batch, for whose it is.
    pub(crate) number: u64,
    pub(crate) changes: Vec<Change>,
    /// More changes, which the thread makes, so that nobody else spends time on that.
    pub(crate) later: Option<Box<dyn LaterChanges>>,
}

/// Changes that are made of something when they are about to be written.
pub(crate) trait LaterChanges: fmt::Debug + Send {
    /// Adds those by which it differs from what the store has.
    fn add_to(&self, changes: &mut Vec<Change>, known: &Contents);
}

/// Who hears of the work of the thread.
pub(crate) trait StoreEvents {
    /// These batches are on the disk: the component and the number of each.
    fn committed(&self, batches: &[(u32, u64)]);
    /// The disk has no space left: nothing is committed, or as much as was reserved, as the text says. `None` once it
    /// has space again.
    fn is_full(&self, text: Option<&str>);
    /// Something hinders nothing yet.
    fn complain(&self, text: String);
    /// Nothing will be committed any more.
    fn failed(&self, text: &str);
}

/// Batches on their way to the disk. Whoever hands one over does not wait.
#[derive(Debug, Default)]
pub(crate) struct StoreQueue {
    waiting: Mutex<Waiting>,
    wake: Condvar,
    /// Number of bytes of all that is not on the disk, also of what is being written.
    bytes: AtomicUsize,
    /// The same of what leaves the program once something is.
    outgoing: AtomicUsize,
    /// True while the disk has no space beyond what is reserved.
    lacks_space: AtomicBool,
    failure: OnceLock<String>,
}

#[derive(Debug, Default)]
struct Waiting {
    batches: Vec<Batch>,
    is_closed: bool,
}

/// Most bytes that may wait. The disk is full or too slow beyond them.
const MOST_WAITING: usize = 64 << 20;
const ALMOST_FULL: &str = "the disk of the state folder is almost full: make space, before components that keep something have to wait for it";
const FULL: &str = "the disk of the state folder is full: make space; components that keep something wait for it";
const NO_NEW_WORK: &str =
    "the disk of the state folder is full, so that no new work is accepted: make space, and try again";
/// Time after which the file of a log to which nothing is added is looked at.
const BETWEEN_LOOKS: Duration = Duration::from_secs(5);
/// Pause before a full disk is tried again.
const RETRY: Duration = Duration::from_secs(1);

impl StoreQueue {
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Hands a batch over.
    pub(crate) fn put(&self, batch: Batch) {
        self.bytes.fetch_add(size(&batch), Ordering::Relaxed);
        self.lock().batches.push(batch);
        self.wake.notify_one();
    }

    /// True once nothing will be committed any more.
    pub(crate) fn has_failed(&self) -> bool {
        self.failure.get().is_some()
    }

    /// Why nothing will be committed any more, if that is so.
    pub(crate) fn failure(&self) -> Option<String> {
        self.failure.get().cloned()
    }

    /// Why no new work may be accepted, if that is so: what is at work already needs what is reserved of the disk.
    pub(crate) fn refusal_of_work(&self) -> Option<String> {
        let lacks_space = self.lacks_space.load(Ordering::Relaxed);
        self.refusal().or_else(|| lacks_space.then(|| NO_NEW_WORK.to_owned()))
    }

    /// Counts bytes that will be handed over.
    pub(crate) fn announce(&self, changes: &[Change]) -> usize {
        let bytes = changes.iter().map(size_of_change).sum();
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
        bytes
    }

    /// Takes bytes back that were announced.
    pub(crate) fn withdraw(&self, bytes: usize) {
        self.bytes.fetch_sub(bytes, Ordering::Relaxed);
    }

    /// Notes the number of bytes that leave the program once something is on the disk.
    pub(crate) fn note_outgoing(&self, bytes: usize) {
        self.outgoing.store(bytes, Ordering::Relaxed);
    }

    /// Hands a batch over whose changes were announced.
    pub(crate) fn put_announced(&self, batch: Batch) {
        self.lock().batches.push(batch);
        self.wake.notify_one();
    }

    /// Why nothing more can be kept, if that is so.
    pub(crate) fn refusal(&self) -> Option<String> {
        if let Some(failure) = self.failure.get() {
            return Some(failure.clone());
        }
        let bytes = self.bytes.load(Ordering::Relaxed) + self.outgoing.load(Ordering::Relaxed);
        let is_behind = bytes > MOST_WAITING;
        is_behind.then(|| {
            let most = MOST_WAITING >> 20;
            format!("more than {most} MiB wait to be written to the state folder: its disk is full or too slow")
        })
    }

    /// Nothing is committed from now on.
    pub(crate) fn fail(&self, text: &str, events: &impl StoreEvents) {
        events.failed(self.failure.get_or_init(|| text.to_owned()));
    }

    /// Lets the thread end once all is written.
    pub(crate) fn close(&self) {
        self.lock().is_closed = true;
        self.wake.notify_one();
    }
}

fn size(batch: &Batch) -> usize {
    batch.changes.iter().map(size_of_change).sum()
}

fn size_of_change(change: &Change) -> usize {
    change.bytes.as_ref().map_or(0, |bytes| bytes.len()) + change.component.len() + mem::size_of::<u64>()
}

/// Writes what comes through the queue, until that is closed. All that came while the disk was busy is one group.
pub(crate) fn write(store: Store, queue: &StoreQueue, events: &impl StoreEvents) {
    Writer { log: store.log, queue, events, told: None }.write();
}

pub(super) struct Writer<'a, F, E> {
    pub(super) log: Log<F>,
    pub(super) queue: &'a StoreQueue,
    pub(super) events: &'a E,
    /// What was told of a disk without space.
    pub(super) told: Option<&'static str>,
}

impl<F: LogFile, E: StoreEvents> Writer<'_, F, E> {
    pub(super) fn write(&mut self) {
        if self.look_for_space().is_err() {
            return;
        }
        let mut waiting = self.queue.lock();
        loop {
            if !waiting.batches.is_empty() {
                let batches = take_group(&mut waiting.batches);
                drop(waiting);
                if self.commit(batches).is_err() {
                    return;
                }
                if let Some(error) = self.log.complaint() {
                    self.events
                        .complain(format!("the log of the state folder cannot be written anew, and grows: {error}"));
                }
                if self.look_for_space().is_err() {
                    return;
                }
                waiting = self.queue.lock();
            } else if waiting.is_closed {
                return;
            } else {
                let woken = self.queue.wake.wait_timeout(waiting, BETWEEN_LOOKS);
                let (again, timeout) = woken.unwrap_or_else(PoisonError::into_inner);
                waiting = again;
                if timeout.timed_out()
                    && let Err(error) = self.log.look()
                {
                    drop(waiting);
                    return self.fail(&error);
                }
            }
        }
    }

    /// Commits batches, and waits for a full disk until the queue is closed.
    fn commit(&mut self, mut batches: Vec<Batch>) -> Result<(), ()> {
        let numbers: Vec<(u32, u64)> = batches.iter().map(|batch| (batch.index, batch.number)).collect();
        let bytes: usize = batches.iter().map(size).sum();
        let mut changes: Vec<Change> = Vec::new();
        for batch in &mut batches {
            changes.append(&mut batch.changes);
            if let Some(later) = batch.later.take() {
                later.add_to(&mut changes, self.log.contents());
            }
        }
        let error = loop {
            match self.log.commit(&changes) {
                Ok(()) => {
                    self.queue.bytes.fetch_sub(bytes, Ordering::Relaxed);
                    self.events.committed(&numbers);
                    return Ok(());
                }
                Err(CommitError::Failed(error)) => break error,
                Err(CommitError::Full(error)) => {
                    self.tell(Some(FULL));
                    let waiting = self.queue.lock();
                    if waiting.is_closed {
                        break error;
                    }
                    drop(self.queue.wake.wait_timeout(waiting, RETRY));
                }
            }
        };
        self.fail(&error);
        Err(())
    }

    fn fail(&self, error: &io::Error) {
        let text = format!("the state folder cannot be written: {error}; what is kept from now on would be lost");
        self.queue.fail(&text, self.events);
    }

    fn look_for_space(&mut self) -> Result<(), ()> {
        let has_space = self.log.reserve().map_err(|error| self.fail(&error))?;
        self.tell((!has_space).then_some(ALMOST_FULL));
        Ok(())
    }

    fn tell(&mut self, text: Option<&'static str>) {
        self.queue.lacks_space.store(text.is_some(), Ordering::Relaxed);
        if mem::replace(&mut self.told, text) != text {
            self.events.is_full(text);
        }
    }
}

/// Takes the batches that fit into one group, at least one. Changes that are made by what the store has end the group:
/// they are made before it is written.
fn take_group(batches: &mut Vec<Batch>) -> Vec<Batch> {
    let (mut bytes, mut is_over) = (0, false);
    let fits = |batch: &Batch| {
        bytes += size(batch) + batch.changes.len() * 16;
        let fits = bytes <= group::MOST_BYTES && !is_over;
        is_over |= batch.later.is_some();
        fits
    };
    let count = batches.iter().map(fits).take_while(|fits| *fits).count().max(1);
    batches.drain(..count).collect()
}
