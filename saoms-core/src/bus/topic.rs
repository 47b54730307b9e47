use std::sync::Arc;

use saoms_api::host::{SharedMessage, TopicDeclaration, TopicKind};
use saoms_api::{Departed, Region};
use saoms_lang::assembly::TaskProperties;

use super::Mismatch;
use super::events::EventLog;
use super::interest::Interest;
use super::links::Readers;
use super::regions::RegionReaders;
use super::state::StateTable;
use crate::hash::text_hash;

/// A topic of the bus: its type, its users and its stored messages.
pub(super) struct BusTopic {
    pub(super) name: Arc<str>,
    pub(super) name_hash: u64,
    /// Publishers and subscribers together. A topic without any may change its type.
    pub(super) users: usize,
    /// The numbers of the components that its messages trigger.
    pub(super) triggers: Vec<u32>,
    /// True once a message was for one of its readers alone.
    pub(super) is_addressed: bool,
    /// The numbers of the observers outside the fleet that want its messages.
    pub(super) observers: Option<Arc<[u32]>>,
    message: String,
    schema: String,
    first_user: Arc<str>,
    store: Store,
    /// Its readers, and those with links of their own.
    pub(super) readers: Readers,
    /// The readers that have a region, once there was one.
    regions: Option<Box<RegionReaders>>,
    /// Number of readers, and what they want, if that is noted.
    pub(super) reading: usize,
    pub(super) interest: Option<Box<Interest>>,
    /// The numbers of the observers outside the fleet that want all of it.
    pub(super) watching: Vec<u32>,
}

#[derive(Clone)]
enum Store {
    State(StateTable),
    Event(EventLog),
}

/// A reader's place in a topic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ReadPosition {
    /// In a state topic: numbers of the last change that was read, and of that before the last collection.
    State { read: u64, before: u64 },
    /// In an event topic: its place among the readers.
    Event(u32),
    /// Of a region of the topic: its place among such readers.
    Region(u32),
}

impl BusTopic {
    pub(super) fn new(name: Arc<str>, declared: &TopicDeclaration<'_>, by: &Arc<str>) -> BusTopic {
        BusTopic {
            name_hash: text_hash(&name),
            name,
            users: 1,
            triggers: Vec::new(),
            is_addressed: false,
            observers: None,
            message: declared.message.to_owned(),
            schema: declared.schema.to_owned(),
            first_user: Arc::clone(by),
            store: store(declared.kind),
            readers: Readers::default(),
            regions: None,
            reading: 0,
            interest: None,
            watching: Vec::new(),
        }
    }

    /// A copy without users, with what readers have not read.
    pub(super) fn copied(&self) -> BusTopic {
        BusTopic {
            name: Arc::clone(&self.name),
            name_hash: self.name_hash,
            users: 0,
            triggers: Vec::new(),
            is_addressed: self.is_addressed,
            observers: None,
            message: self.message.clone(),
            schema: self.schema.clone(),
            first_user: Arc::clone(&self.first_user),
            store: self.store.clone(),
            readers: Readers::default(),
            regions: self.regions.clone(),
            reading: 0,
            interest: None,
            watching: Vec::new(),
        }
    }

    /// Forgets all readers but one.
    pub(super) fn keep_reader(&mut self, position: &ReadPosition) {
        if let Store::Event(log) = &mut self.store {
            log.keep(match position {
                ReadPosition::Event(place) => Some(*place),
                _ => None,
            });
        }
        match (&mut self.regions, position) {
            (Some(regions), ReadPosition::Region(place)) => regions.keep(*place),
            _ => self.regions = None,
        }
    }

    /// Forgets all messages.
    pub(super) fn empty(&mut self) {
        self.store = store(self.kind());
        self.regions = None;
    }

    pub(super) fn schema(&self) -> &str {
        &self.schema
    }

    /// The name of its messages.
    pub(super) fn message(&self) -> &str {
        &self.message
    }

    /// Number of messages that wait for a reader of an event topic, and of those that may wait.
    pub(super) fn waiting(&self, reader: &ReadPosition) -> Option<(u64, u64)> {
        match (&self.store, reader) {
            (Store::Event(log), ReadPosition::Event(place)) => Some(log.waiting(*place)),
            _ => None,
        }
    }

    pub(super) fn event_end(&self) -> Option<u64> {
        match &self.store {
            Store::Event(log) => Some(log.end()),
            Store::State(_) => None,
        }
    }

    pub(super) fn read_up_to(&self, reader: &ReadPosition) -> Option<u64> {
        match (&self.store, reader) {
            (Store::Event(log), ReadPosition::Event(place)) => Some(log.read_up_to(*place)),
            _ => None,
        }
    }

    pub(super) fn kind(&self) -> TopicKind {
        match self.store {
            Store::State(_) => TopicKind::State,
            Store::Event(_) => TopicKind::Event,
        }
    }

    /// Counts another user, if it declares the same kind and message type.
    pub(super) fn join(&mut self, declared: &TopicDeclaration<'_>, by: &Arc<str>) -> Result<(), Mismatch> {
        let same = self.kind() == declared.kind && agree(&self.schema, declared.schema);
        if !same && self.users > 0 {
            return Err(self.mismatch(declared));
        }
        if self.users == 0 {
            self.first_user = Arc::clone(by);
        }
        if !same {
            self.message = declared.message.to_owned();
            self.schema = declared.schema.to_owned();
            self.observers = None;
            self.store = store(declared.kind);
            self.regions = None;
        }
        self.set_users(self.users + 1);
        Ok(())
    }

    pub(super) fn lose_user(&mut self) {
        self.set_users(self.users - 1);
    }

    fn set_users(&mut self, users: usize) {
        self.users = users;
        if let Store::Event(log) = &mut self.store {
            log.set_users(users);
        }
    }

    fn mismatch(&self, declared: &TopicDeclaration<'_>) -> Mismatch {
        let describe = |message: &str, kind: TopicKind, schema: &str| {
            if self.message == declared.message && !agree(&self.schema, declared.schema) {
                format!("{} messages `{message}` with the fields {}", kind.name(), schema.trim().replace('\n', ", "))
            } else {
                format!("{} messages `{message}`", kind.name())
            }
        };
        Mismatch {
            topic: Arc::clone(&self.name),
            other: Arc::clone(&self.first_user),
            found: describe(declared.message, declared.kind, declared.schema),
            expected: describe(&self.message, self.kind(), &self.schema),
        }
    }

    pub(super) fn reader(&mut self, queue: Option<usize>) -> ReadPosition {
        match &mut self.store {
            Store::State(_) => ReadPosition::State { read: 0, before: 0 },
            Store::Event(log) => ReadPosition::Event(log.join(queue)),
        }
    }

    pub(super) fn resize(&mut self, reader: &ReadPosition, queue: Option<usize>) {
        match (&mut self.store, &mut self.regions, reader) {
            (Store::Event(log), _, ReadPosition::Event(place)) => log.resize(*place, queue),
            (_, Some(regions), ReadPosition::Region(place)) => regions.resize(*place, of_region(queue)),
            _ => {}
        }
    }

    pub(super) fn leave(&mut self, reader: ReadPosition) -> u64 {
        match (&mut self.store, &mut self.regions, reader) {
            (Store::Event(log), _, ReadPosition::Event(place)) => log.leave(place),
            (_, Some(regions), ReadPosition::Region(place)) => regions.leave(place),
            _ => 0,
        }
    }

    /// Number of events that it holds.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        match &self.store {
            Store::State(_) => 0,
            Store::Event(log) => log.messages.len(),
        }
    }

    /// True unless events wait that fill half of the queue of a reader.
    pub(super) fn has_room(&self) -> bool {
        match &self.store {
            Store::State(_) => true,
            Store::Event(log) => log.has_room(),
        }
    }

    /// True if there are messages that a reader has not collected.
    pub(super) fn has_news(&self, reader: &ReadPosition) -> bool {
        match (&self.store, reader) {
            (Store::State(table), ReadPosition::State { read, .. }) => table.has_news(*read),
            (Store::Event(log), ReadPosition::Event(place)) => log.has_news(*place),
            (_, ReadPosition::Region(place)) => self.regions.as_ref().is_some_and(|regions| regions.has_news(*place)),
            _ => false,
        }
    }

    /// True if a reader of a region has news.
    #[inline]
    pub(super) fn is_stirred(&self, place: u32) -> bool {
        self.regions.as_ref().is_some_and(|regions| regions.is_stirred(place))
    }

    /// Takes in a message. False if a state topic cannot keep it.
    #[inline]
    pub(super) fn publish(&mut self, message: SharedMessage) -> bool {
        if self.regions.is_some() {
            return self.publish_in_regions(message);
        }
        match &mut self.store {
            Store::State(table) => table.publish(message).is_some(),
            Store::Event(log) => {
                log.publish(message);
                true
            }
        }
    }

    #[cold]
    fn publish_in_regions(&mut self, message: SharedMessage) -> bool {
        let Some(regions) = &mut self.regions else { return false };
        match &mut self.store {
            Store::State(table) => {
                let place = message.place();
                let Some((entry, before)) = table.publish(message) else { return false };
                regions.changed(entry, before.and_then(|before| before.place()), place);
            }
            Store::Event(log) => {
                regions.event(&message);
                log.publish(message);
            }
        }
        true
    }

    /// The region of a reader.
    pub(super) fn region(&self, reader: &ReadPosition) -> Option<Region> {
        match (reader, &self.regions) {
            (ReadPosition::Region(place), Some(regions)) => Some(regions.region(*place)),
            _ => None,
        }
    }

    /// Lets a reader get the messages of a region alone, or all again.
    pub(super) fn set_region(&mut self, reader: &mut ReadPosition, region: Option<Region>, queue: Option<usize>) {
        let table = self.store.table();
        match (region, &*reader) {
            (Some(region), ReadPosition::Region(place)) => {
                if let Some(regions) = &mut self.regions {
                    regions.move_to(*place, region, table);
                }
            }
            (Some(region), _) => {
                let regions = self.regions.get_or_insert_with(|| Box::new(RegionReaders::of(table)));
                let place = regions.join(region, of_region(queue), table);
                let before = std::mem::replace(reader, ReadPosition::Region(place));
                self.leave(before);
            }
            (None, ReadPosition::Region(_)) => {
                let whole = self.reader(queue);
                let before = std::mem::replace(reader, whole);
                self.leave(before);
            }
            (None, _) => {}
        }
    }

    /// True if events wait for a reader.
    pub(super) fn has_unread(&self) -> bool {
        self.log().is_some_and(EventLog::has_unread)
            || self.regions.as_ref().is_some_and(|regions| regions.has_unread())
    }

    pub(super) fn log(&self) -> Option<&EventLog> {
        match &self.store {
            Store::Event(log) => Some(log),
            Store::State(_) => None,
        }
    }

    pub(super) fn regions(&self) -> Option<&RegionReaders> {
        self.regions.as_deref()
    }

    /// Appends the retained messages that changed after the `since`-th change.
    pub(super) fn changed_states(&self, since: &mut u64, messages: &mut Vec<SharedMessage>) {
        if let Some(table) = self.store.table() {
            table.collect(since, messages);
        }
    }

    /// The retained messages, the oldest first.
    pub(super) fn retained(&self) -> Vec<SharedMessage> {
        let mut messages = Vec::new();
        if let Some(table) = self.store.table() {
            table.collect(&mut 0, &mut messages);
        }
        messages
    }

    pub(super) fn rewind(&mut self, reader: &mut ReadPosition) {
        match (reader, &mut self.regions) {
            (ReadPosition::State { read, .. }, _) => *read = 0,
            (ReadPosition::Region(place), Some(regions)) => regions.rewind(*place, self.store.table()),
            _ => {}
        }
    }

    /// Undoes the last collection, in a state topic.
    pub(super) fn put_back(&mut self, reader: &mut ReadPosition) -> bool {
        match (reader, &mut self.regions) {
            (ReadPosition::State { read, before }, _) => {
                *read = *before;
                true
            }
            (ReadPosition::Region(place), Some(regions)) => regions.put_back(*place, self.store.table().is_some()),
            _ => false,
        }
    }

    pub(super) fn collect_in_region(
        &mut self,
        reader: &ReadPosition,
        inbox: &mut Vec<SharedMessage>,
        departed: &mut Vec<Departed>,
    ) -> u64 {
        match (reader, &mut self.regions) {
            (ReadPosition::Region(place), Some(regions)) => {
                regions.collect(*place, self.store.table(), inbox, departed)
            }
            _ => 0,
        }
    }

    #[inline]
    pub(super) fn collect(&mut self, reader: &mut ReadPosition, inbox: &mut Vec<SharedMessage>) -> u64 {
        match (&mut self.store, reader) {
            (Store::State(table), ReadPosition::State { read, before }) => {
                *before = *read;
                table.collect(read, inbox);
                0
            }
            (Store::Event(log), ReadPosition::Event(place)) => log.collect(*place, inbox),
            // A reader keeps its topic's kind: the kind changes only while the topic is unused.
            _ => 0,
        }
    }
}

impl Store {
    fn table(&self) -> Option<&StateTable> {
        match self {
            Store::State(table) => Some(table),
            Store::Event(_) => None,
        }
    }
}

/// The queue of a reader with a region: what is around it does not grow with the users of the topic.
fn of_region(queue: Option<usize>) -> usize {
    queue.unwrap_or(TaskProperties::default_queue(0))
}

fn store(kind: TopicKind) -> Store {
    match kind {
        TopicKind::State => Store::State(StateTable::default()),
        TopicKind::Event => Store::Event(EventLog::default()),
    }
}

/// True if two schemas are the same. Order and spacing of the members may differ in texts written by hand.
fn agree(one: &str, other: &str) -> bool {
    let value = |text| serde_json::from_str::<serde_json::Value>(text).ok();
    one == other || value(one).is_some_and(|one| Some(one) == value(other))
}
