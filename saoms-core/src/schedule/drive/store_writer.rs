//! The thread that puts on the disk what components keep.

use std::collections::BTreeSet;
use std::io;
use std::panic::{self, AssertUnwindSafe};
use std::sync::{Arc, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::{Level, Time};

use crate::schedule::engine::memory::{Recollection, is_of_memory, recall_report};
use crate::schedule::hold;
use crate::schedule::inject::add_commits;
use crate::schedule::networks::kept::url_of;
use crate::schedule::os::thread::start_thread;
use crate::schedule::shared::Shared;
use crate::store::{Store, StoreEvents, StoreQueue, write};

/// The kind and the subject of alerts about the store.
const ALERT: (&str, &str) = ("file", "state");

/// Time for which the end of a run waits for a disk.
const LAST_COMMITS: Duration = Duration::from_secs(5);

/// Tells the fleet what the thread has done.
struct ToFleet(Arc<Shared>);

impl StoreEvents for ToFleet {
    fn committed(&self, batches: &[(u32, u64)]) {
        add_commits(&self.0, batches);
    }

    fn is_full(&self, text: Option<&str>) {
        self.0.alert(ALERT.0, ALERT.1, text.map(str::to_owned));
    }

    fn complain(&self, text: String) {
        self.0.note(Level::Warning, text);
    }

    fn failed(&self, text: &str) {
        let mut engine = self.0.lock();
        engine.store_failed(text, self.0.clock.now());
        self.0.release(engine);
        self.0.alert(ALERT.0, ALERT.1, Some(text.to_owned()));
    }
}

/// Has components keep in a store what they keep.
///
/// # Errors
/// The system cannot create a thread.
pub(crate) fn use_store(shared: &Arc<Shared>, store: Store) -> io::Result<()> {
    let queue: Arc<StoreQueue> = Arc::default();
    let found = store.contents().clone();
    if let Some(repaired) = store.repaired() {
        shared.note(Level::Warning, repaired.to_owned());
    }
    let (for_thread, events) = (Arc::clone(&queue), ToFleet(Arc::clone(shared)));
    let thread = start_thread("saoms-store", move || {
        if panic::catch_unwind(AssertUnwindSafe(|| write(store, &for_thread, &events))).is_err() {
            // A fault of the store itself: whoever waits for it must not wait for ever.
            for_thread.fail("the thread that writes the state folder panicked", &events);
        }
    })?;
    *shared.store_thread.lock().unwrap_or_else(PoisonError::into_inner) = Some(thread);
    recall_report(&found, &mut shared.sections());
    let recollection = shared.lock().use_store(found, Arc::clone(&queue));
    if let Some(Recollection { time, components, was_done, is_paused }) = recollection {
        shared.clock.begin_at(time);
        let from = Time::from_nanos(time);
        let plural = if components == 1 { "" } else { "s" };
        let mut text = format!("goes on from its state of {from}, with {components} component{plural}");
        if was_done {
            text.push_str(
                ": all work was done then, so that it ends at once unless more comes; to begin anew, name another folder",
            );
        }
        shared.note(Level::Info, text);
        if is_paused {
            hold::still_pause(shared);
            let text = "is still paused, as before the end of the last program: `saoms resume` lets it go on";
            shared.note(Level::Warning, text.to_owned());
        }
    }
    // A fleet has one store: it is set once, before the components initialize.
    let _ = shared.store.set(queue);
    Ok(())
}

/// Tells of what a store has of components and networks that the fleet does not have: it stays there.
pub(crate) fn note_unused(shared: &Shared, remembered: &[String]) {
    let (urls, components): (BTreeSet<String>, Vec<String>) = {
        let engine = shared.lock();
        let is_there = |name: &str| {
            let number = engine.numbers.get(name);
            number.is_some_and(|number| engine.slots[*number as usize].is_member())
        };
        let entries: Vec<&str> = engine.found.components().map(|name| &**name).collect();
        let urls = entries.iter().filter_map(|name| url_of(name)).map(|url| format!("`{url}`"));
        let kept = entries.iter().copied().filter(|name| url_of(name).is_none() && !is_of_memory(name));
        let kept: BTreeSet<&str> =
            kept.chain(remembered.iter().map(String::as_str)).filter(|name| !is_there(name)).collect();
        (urls.collect(), kept.into_iter().map(|name| format!("`{name}`")).collect())
    };
    if !components.is_empty() {
        let text = format!(
            "the state folder has what {} kept, and the fleet has no such component: it stays there",
            components.join(", ")
        );
        shared.note(Level::Warning, text);
    }
    if !urls.is_empty() {
        let urls = urls.into_iter().collect::<Vec<_>>().join(", ");
        let text =
            format!("the state folder has events for {urls}, and the fleet is not on such a network: they stay there");
        shared.note(Level::Warning, text);
    }
}

/// Waits until messages have left that wait for the disk, as long as that has space.
pub(crate) fn wait_for_commits(shared: &Shared) {
    if shared.store.get().is_none() {
        return;
    }
    let since = Instant::now();
    while shared.look(|engine| engine.uncommitted > 0 || engine.memory.has_uncommitted())
        && since.elapsed() < LAST_COMMITS
    {
        sleep(Duration::from_millis(1));
    }
}

/// Waits until all that was kept is on the disk, and closes the store.
pub(crate) fn finish(shared: &Shared) {
    let Some(queue) = shared.store.get() else { return };
    queue.close();
    let thread = shared.store_thread.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(thread) = thread {
        // A panic was written to standard error.
        let _ = thread.join();
    }
}
