//! What components keep: it is committed, and only then the messages leave that may depend on it.

use std::collections::HashSet;
use std::sync::Arc;

use saoms_api::host::{SharedMessage, TopicKind};

use super::memory::{CUT, MUCH, Recollection};
use super::{Engine, RunPhase};
use crate::bus::{Bus, TopicId};
use crate::schedule::component::part::Part;
use crate::schedule::component::stored::{Stored, StoredChange};
use crate::schedule::networks::kept::NOBODY;
use crate::store::{Change, Contents, StoreQueue};

/// When what a component keeps is committed.
#[derive(Debug)]
pub(crate) enum Commits {
    /// At once: it is in memory.
    AtOnce,
    /// After this number of nanoseconds, in memory, as if it were on a disk: in virtual time.
    After(u64),
    /// When it is on the disk.
    InStore(Arc<StoreQueue>),
}

/// What a component kept in one execution, which is not committed yet.
#[derive(Debug)]
pub(crate) struct Uncommitted {
    pub(crate) number: u64,
    /// Changes that take it back.
    before: Vec<StoredChange>,
    /// True if it took what was left to the component: it kept something for the first time since.
    takes_estate: bool,
    /// Messages of that execution, and of later ones that kept nothing.
    pub(super) messages: Vec<(TopicId, SharedMessage)>,
    /// Number of bytes of them, roughly.
    bytes: usize,
    /// Number of messages and of bytes beyond which those of state topics are removed that newer ones replace.
    most: usize,
    most_bytes: usize,
    /// True if the run does not end before the messages are read.
    settles: bool,
}

/// How far a run whose work is done waits for commits. A component may keep something in each of its executions, so
/// that some commit is always on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum LastCommits {
    /// The work is not done, or nothing was on its way when it was.
    #[default]
    None,
    /// Those up to this number, which were on their way then.
    UpTo(u64),
    /// They are over.
    Over,
}

/// Number of messages that wait without a look at which of them are outdated.
const MANY: usize = 1024;

/// Removes messages of state topics that newer ones replace: a full disk may stay full for long.
fn thin_out(messages: &mut Vec<(TopicId, SharedMessage)>, bus: &Bus) {
    let mut newer = HashSet::new();
    let mut kept: Vec<(TopicId, SharedMessage)> = Vec::new();
    for (topic, message) in messages.drain(..).rev() {
        if bus.kind(topic) == TopicKind::Event || newer.insert((topic.number(), message.key())) {
            kept.push((topic, message));
        }
    }
    kept.reverse();
    *messages = kept;
}

impl Engine {
    /// Keeps what an execution has kept, with the events that it sends over a network: all of it, or nothing.
    #[cold]
    pub(super) fn keep(&mut self, part: &mut Part, events: Vec<Change>, now: u64) {
        let Part { to_keep, stored, estate, index, name, .. } = part;
        let index = &*index;
        let change =
            |(key, bytes): &StoredChange| Change { component: Arc::clone(name), key: *key, bytes: bytes.clone() };
        let changes: Vec<Change> = to_keep.iter().map(change).chain(events).collect();
        let before: Vec<StoredChange> = to_keep.drain(..).map(|change| stored.change(change)).collect();
        let takes_estate = !before.is_empty() && !estate.set_taken(true);
        if self.memory.is_over(self.phase) {
            return;
        }
        self.batches += 1;
        let number = self.batches;
        match &self.commits {
            Commits::AtOnce => return,
            Commits::After(_) if self.phase != RunPhase::Running => return,
            Commits::After(delay) => self.injections.commit_at(now.saturating_add(*delay), *index, number),
            Commits::InStore(queue) if queue.has_failed() => {
                // It happened since this execution began. The next one hears of it.
                self.slots[*index as usize].is_cut_off = true;
                return;
            }
            Commits::InStore(_) => {
                let index = *index;
                self.hand_over(index, number, changes, now);
            }
        }
        self.look_at = self.injections.earliest().map_or(self.look_at, |when| when.min(self.look_at));
        let uncommitted = Uncommitted {
            number,
            before,
            takes_estate,
            messages: Vec::new(),
            bytes: 0,
            most: MANY,
            most_bytes: MUCH,
            settles: false,
        };
        self.slots[*index as usize].uncommitted.push_back(uncommitted);
        self.uncommitted += 1;
    }

    /// Lets the messages of an execution wait until what was kept before is committed. Those of a component that has
    /// lost what it kept are never sent.
    #[cold]
    pub(super) fn hold_back(&mut self, part: &mut Part, bytes: usize, settles: bool) {
        let slot = &mut self.slots[part.index as usize];
        match slot.uncommitted.back_mut() {
            Some(last) if !slot.is_cut_off => {
                last.settles |= settles;
                let (before, count) = (last.bytes, part.outbox.len());
                last.bytes += bytes + count * size_of::<(TopicId, SharedMessage)>();
                last.messages.append(&mut part.outbox);
                let count = last.messages.len();
                if count > last.most || last.bytes > last.most_bytes {
                    thin_out(&mut last.messages, &self.bus);
                    let left = last.messages.len();
                    last.bytes = (last.bytes as u128 * left as u128 / count.max(1) as u128) as usize;
                    (last.most, last.most_bytes) = (MANY.max(2 * left), MUCH.max(2 * last.bytes));
                }
                self.memory.note_held_back(before, last.bytes);
            }
            _ => {
                self.unsent += part.outbox.len() as u64;
                part.outbox.clear();
            }
        }
    }

    /// What a component kept up to this batch is committed: the messages leave that waited for it.
    #[cold]
    pub(crate) fn commit(&mut self, index: u32, number: u64, now: u64) {
        let has_events = match index {
            CUT => return self.commit_cut(number, now),
            NOBODY => self.commit_outside(number),
            _ => self.commit_of(index, number, now),
        };
        if matches!(self.last_commits, LastCommits::UpTo(last) if last <= number) {
            self.last_commits = LastCommits::Over;
            if has_events && self.phase == RunPhase::Running {
                // They have to be read before the run ends.
                self.settle(now);
            }
        }
    }

    /// Lets the messages of a component leave. True if some of them are events.
    fn commit_of(&mut self, index: u32, number: u64, now: u64) -> bool {
        let name = Arc::clone(&self.slots[index as usize].name);
        let mut has_events = false;
        while let Some(first) = self.slots[index as usize].uncommitted.pop_front_if(|first| first.number <= number) {
            self.uncommitted -= 1;
            self.memory.note_held_back(first.bytes, 0);
            has_events |= first.messages.iter().any(|(topic, _)| self.bus.kind(*topic) == TopicKind::Event);
            if !first.messages.is_empty() {
                let network = self.slots[index as usize].network;
                self.send_all((index, &name), network, first.messages.into_iter(), first.settles, now);
            }
        }
        has_events
    }

    /// True if a run whose work is done need not wait for commits.
    pub(crate) fn commits_are_over(&mut self) -> bool {
        match self.last_commits {
            LastCommits::None if self.uncommitted > 0 => self.last_commits = LastCommits::UpTo(self.batches),
            LastCommits::UpTo(_) => {}
            LastCommits::None | LastCommits::Over => return true,
        }
        false
    }

    /// In virtual time, a component that fails and does not go on from its memory has lost what was not committed.
    /// Gives the number of messages that are lost with it.
    pub(super) fn take_back_uncommitted(&mut self, part: &mut Part) -> usize {
        let slot = &mut self.slots[part.index as usize];
        if slot.uncommitted.is_empty() || !matches!(self.commits, Commits::After(_)) || part.lasting.will_go_on() {
            return 0;
        }
        let mut messages = 0;
        self.uncommitted -= slot.uncommitted.len();
        for Uncommitted { before, takes_estate, messages: unsent, bytes, .. } in slot.uncommitted.drain(..).rev() {
            self.memory.note_held_back(bytes, 0);
            messages += unsent.len();
            // What it kept before, and what is committed, took it for good.
            if takes_estate {
                part.estate.set_taken(false);
            }
            before.into_iter().rev().for_each(|change| drop(part.stored.change(change)));
        }
        messages
    }

    /// Nothing will be committed any more: what waited for it is lost.
    pub(crate) fn store_failed(&mut self, text: &str, now: u64) {
        for slot in &mut self.slots {
            slot.is_cut_off |= !slot.uncommitted.is_empty();
        }
        self.drop_uncommitted(0);
        self.networks.kept.fail();
        self.unsent += self.fail_memory();
        self.last_commits = LastCommits::Over;
        self.reasons.push(text.to_owned());
        self.end_if_done(now);
    }

    /// Drops what waits for the commit of later batches than this one, which will not be.
    pub(super) fn drop_uncommitted(&mut self, batch: u64) {
        let (mut executions, mut messages) = (0, 0);
        for slot in &mut self.slots {
            while let Some(last) = slot.uncommitted.pop_back_if(|last| last.number > batch) {
                (executions, messages) = (executions + 1, messages + last.messages.len());
                self.memory.note_held_back(last.bytes, 0);
            }
        }
        let outside = self.networks.kept.drop_outside(batch);
        self.uncommitted -= executions + outside;
        self.unsent += (messages + outside) as u64;
    }

    /// Removes what a component keeps that leaves the fleet.
    pub(crate) fn forget_stored(&mut self, index: u32, now: u64) {
        if let Some(mut body) = self.slots[index as usize].body.take() {
            self.forget_stored_of(&mut body.part, now);
            self.slots[index as usize].body = Some(body);
        }
    }

    /// The same, of one whose body is out.
    pub(crate) fn forget_stored_of(&mut self, part: &mut Part, now: u64) {
        self.found.forget(&part.name);
        part.to_keep = part.stored.entries().keys().map(|key| (*key, None)).collect();
        if !part.to_keep.is_empty() {
            self.keep(part, Vec::new(), now);
        }
    }

    /// What a component keeps that joins the fleet.
    pub(crate) fn stored_of(&self, name: &str) -> Stored {
        self.found.of(name).map_or_else(Stored::default, |entries| Stored::new(entries.clone()))
    }

    /// Uses a store from now on: what it holds, and where more goes. Gives what the fleet goes on from, if it does.
    pub(crate) fn use_store(&mut self, found: Contents, queue: Arc<StoreQueue>) -> Option<Recollection> {
        let recollection = self.use_memory(&found, Arc::clone(&queue));
        (self.found, self.commits) = (found, Commits::InStore(queue));
        recollection
    }
}
