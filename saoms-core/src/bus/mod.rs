//! Topics inside one process: typed, shared not copied, delivered without waiting.
//!
//! Publishing puts a message into its topic once, however many readers there are; a reader collects what is new to it
//! when its own execution starts. A [state topic](saoms_api::host::TopicKind::State) keeps the newest message of each
//! publisher and key, so that a reader that comes later gets the present state, and one that reads rarely gets each key
//! once; a publisher has a bounded number of keys. An [event topic](saoms_api::host::TopicKind::Event) keeps each
//! message until every reader has read it; a reader that falls behind by more than its queue loses the oldest messages,
//! and gets their number.
//!
//! A [`Bus`] has no lock of its own: it belongs to one scheduler, which delivers in batches. It knows neither clock nor
//! components.

mod events;
mod hash;
mod interest;
mod links;
mod marks;
mod regions;
#[cfg(test)]
mod regions_tests;
mod remembered;
mod state;
#[cfg(test)]
mod tests;
mod topic;

use std::collections::HashMap;
use std::fmt;
use std::num::NonZeroU32;
use std::sync::Arc;

use saoms_api::host::{SharedMessage, TopicDeclaration, TopicKind};
use saoms_api::{Departed, Region};

pub use links::Link;
pub use marks::ReaderMark;
pub use regions::{Cell, cell_of};
pub(crate) use state::MOST_KEYS;
use topic::{BusTopic, ReadPosition};

/// All topics of a fleet, by the names that they have after renaming.
#[derive(Default)]
pub struct Bus {
    topics: Vec<BusTopic>,
    /// Number of messages so far, and at the last time that a reader got a link.
    published: u64,
    relinked: u64,
    /// The number of the newest message of each topic, close together in memory: whoever collects looks at all of its
    /// topics, of which most have none.
    newest: Vec<u64>,
    names: HashMap<Arc<str>, TopicId>,
    /// Number of readers so far.
    readers: u32,
    /// Number of times that a topic came into use, or is used by nobody any more.
    changes: u64,
}

/// A topic of a [`Bus`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TopicId(u32);

impl TopicId {
    /// Its number, in the order of the creation of topics.
    pub fn number(self) -> u32 {
        self.0
    }
}

/// One reader's place in a topic. Give it back with [`Bus::unsubscribe`].
#[derive(Debug)]
pub struct TopicReader {
    topic: TopicId,
    /// Its number among the readers of all topics.
    number: u32,
    reader: ReadPosition,
    /// The component that the topic's messages trigger.
    triggers: Option<u32>,
}

/// The place of a reader's news: its topic, and its place among the readers of regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watch {
    /// From 1.
    topic: NonZeroU32,
    place: u32,
}

/// The place of a reader without a region.
const WHOLE: u32 = u32::MAX;

/// A publisher or reader whose type or kind differs from that of the topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mismatch {
    topic: Arc<str>,
    other: Arc<str>,
    found: String,
    expected: String,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Mismatch { topic, other, found, expected } = self;
        write!(
            formatter,
            "topic `{topic}` carries {expected}, as component `{other}` uses it, but here it would carry {found}: \
            rename one of the two with `topicRename`, or use the same message in both"
        )
    }
}

impl Bus {
    /// Registers a publisher of the topic, which is created with its first user. `by` is the component, for messages.
    ///
    /// # Errors
    /// The topic carries other messages, or is of the other kind.
    pub fn publisher(
        &mut self,
        name: &str,
        declared: &TopicDeclaration<'_>,
        by: &Arc<str>,
    ) -> Result<TopicId, Mismatch> {
        self.user(name, declared, by)
    }

    /// The topic of this name, if it has a publisher or a reader.
    pub fn find(&self, name: &str) -> Option<TopicId> {
        self.names.get(name).copied().filter(|id| self.topics[id.0 as usize].users > 0)
    }

    /// The names of the topics in use, in the order of their creation.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.topics.iter().filter(|topic| topic.users > 0).map(|topic| &*topic.name)
    }

    /// The topics in use, in the order of their creation.
    pub fn topics(&self) -> impl Iterator<Item = TopicId> {
        let all = self.topics.iter().enumerate().filter(|(_, topic)| topic.users > 0);
        all.map(|(place, _)| TopicId(place as u32))
    }

    /// Number of changes of the [topics](Bus::topics) in use so far.
    pub fn changes(&self) -> u64 {
        self.changes
    }

    /// Whether a topic is one of events or of states.
    pub fn kind(&self, topic: TopicId) -> TopicKind {
        self.topics[topic.0 as usize].kind()
    }

    /// The name of the topic's messages.
    pub fn message(&self, topic: TopicId) -> &str {
        self.topics[topic.0 as usize].message()
    }

    /// Number of messages that wait for a reader of an event topic, and of those that may wait.
    pub fn waiting(&self, subscription: &TopicReader) -> Option<(u64, u64)> {
        self.topics[self.read_by(subscription)].waiting(&subscription.reader)
    }

    /// The number of the next message of an event topic.
    pub fn event_end(&self, topic: TopicId) -> Option<u64> {
        self.topics[topic.0 as usize].event_end()
    }

    /// The number of the first message of an event topic that a reader has not collected; `None` where it reads a copy
    /// of the topic, or a region.
    pub fn read_up_to(&self, subscription: &TopicReader) -> Option<u64> {
        let main = subscription.topic.0 as usize;
        (self.read_by(subscription) == main).then(|| self.topics[main].read_up_to(&subscription.reader)).flatten()
    }

    /// The schema of the topic's messages, as text.
    pub fn schema(&self, topic: TopicId) -> &str {
        self.topics[topic.0 as usize].schema()
    }

    /// Takes a publisher off the topic. Retained messages stay.
    pub fn unpublish(&mut self, topic: TopicId) {
        let topic = &mut self.topics[topic.0 as usize];
        topic.lose_user();
        self.changes += u64::from(topic.users == 0);
    }

    /// Registers a reader. It gets what a state topic retains, and the messages of an event topic from now on; of the
    /// latter, at most `queue` wait for it; `None` for a number that grows with the users of the topic.
    ///
    /// # Errors
    /// The topic carries other messages, or is of the other kind.
    pub fn subscribe(
        &mut self,
        name: &str,
        declared: &TopicDeclaration<'_>,
        by: &Arc<str>,
        queue: impl Into<Option<usize>>,
    ) -> Result<TopicReader, Mismatch> {
        let id = self.user(name, declared, by)?;
        let topic = &mut self.topics[id.0 as usize];
        let reader = topic.reader(queue.into());
        topic.reading += 1;
        self.readers = self.readers.wrapping_add(1);
        Ok(TopicReader { topic: id, number: self.readers, reader, triggers: None })
    }

    /// Takes a reader off its topic. Returns the number of messages that it lost since it last collected.
    pub fn unsubscribe(&mut self, subscription: TopicReader) -> u64 {
        let topic = &mut self.topics[subscription.topic.0 as usize];
        topic.lose_user();
        topic.reading -= 1;
        self.changes += u64::from(topic.users == 0);
        if let Some(interest) = &mut topic.interest {
            interest.remove(subscription.number);
        }
        let own = self.read_by(&subscription);
        let topic = &mut self.topics[own];
        if let Some(place) = topic.triggers.iter().position(|number| Some(*number) == subscription.triggers) {
            topic.triggers.remove(place);
        }
        let lost = topic.leave(subscription.reader);
        self.forget(&subscription);
        lost
    }

    /// Puts a message into a topic. False if a state topic cannot keep it, since its publisher has too many keys.
    #[inline]
    #[must_use = "a message that is lost is told"]
    pub fn publish(&mut self, topic: TopicId, message: SharedMessage) -> bool {
        self.published += 1;
        let newest = &mut self.newest[topic.0 as usize];
        *newest = (*newest).max(self.published);
        self.topics[topic.0 as usize].publish(message)
    }

    /// Notes that the messages that a reader gets trigger the component with this number.
    pub fn set_trigger(&mut self, subscription: &mut TopicReader, component: u32) {
        if subscription.triggers.replace(component).is_none() {
            let own = self.read_by(subscription);
            self.topics[own].triggers.push(component);
        }
    }

    /// The numbers of the components that the messages of a topic trigger.
    #[inline]
    pub fn triggers(&self, topic: TopicId) -> &[u32] {
        &self.topics[topic.0 as usize].triggers
    }

    /// True if the messages that a reader gets trigger its component.
    #[inline]
    pub fn is_trigger(&self, subscription: &TopicReader) -> bool {
        subscription.triggers.is_some()
    }

    /// Notes that a message of a topic is for one of its readers alone.
    #[cold]
    pub fn note_addressed(&mut self, topic: TopicId) {
        self.topics[topic.0 as usize].is_addressed = true;
    }

    /// True if messages of the reader's topic may be for other readers alone.
    #[inline]
    pub fn is_addressed(&self, subscription: &TopicReader) -> bool {
        self.topics[subscription.topic.0 as usize].is_addressed
    }

    /// The messages that a state topic retains, the oldest first; none of an event topic.
    pub fn retained(&self, topic: TopicId) -> Vec<SharedMessage> {
        self.topics[topic.0 as usize].retained()
    }

    /// True unless events wait on a topic that fill half of the queue of a reader.
    pub fn has_room(&self, topic: TopicId) -> bool {
        self.topics[topic.0 as usize].has_room()
    }

    /// Number of messages so far, of all topics.
    #[inline]
    pub fn published(&self) -> u64 {
        self.published
    }

    /// Number of messages at which a reader got another place the last time, so that a [`Watch`] of before holds no
    /// more.
    #[inline]
    pub fn relinked(&self) -> u64 {
        self.relinked
    }

    /// Where to see whether a reader has news, as long as it keeps its place.
    pub fn watch(&self, subscription: &TopicReader) -> Watch {
        let place = match subscription.reader {
            ReadPosition::Region(place) => place,
            _ => WHOLE,
        };
        Watch { topic: NonZeroU32::MIN.saturating_add(self.read_by(subscription) as u32), place }
    }

    /// True if a reader has no news, since it collected when the bus had had this number of messages.
    #[inline]
    pub fn is_quiet(&self, watch: Watch, published: u64) -> bool {
        let topic = (watch.topic.get() - 1) as usize;
        if watch.place == WHOLE { self.newest[topic] <= published } else { !self.topics[topic].is_stirred(watch.place) }
    }

    /// True if there are messages that a reader has not collected.
    pub fn has_news(&self, subscription: &TopicReader) -> bool {
        self.topics[self.read_by(subscription)].has_news(&subscription.reader)
    }

    /// Appends the messages that are new to a reader, oldest first. Returns the number of messages that it lost since
    /// it last collected.
    #[inline]
    pub fn collect(&mut self, subscription: &mut TopicReader, inbox: &mut Vec<SharedMessage>) -> u64 {
        let own = self.read_by(subscription);
        self.topics[own].collect(&mut subscription.reader, inbox)
    }

    /// The same for a reader that has a region, with the messages that are not in it any more.
    #[cold]
    pub fn collect_in_region(
        &mut self,
        subscription: &TopicReader,
        inbox: &mut Vec<SharedMessage>,
        departed: &mut Vec<Departed>,
    ) -> u64 {
        let own = self.read_by(subscription);
        self.topics[own].collect_in_region(&subscription.reader, inbox, departed)
    }

    /// True if a reader gets the messages of a region alone.
    #[inline]
    pub fn has_region(&self, subscription: &TopicReader) -> bool {
        matches!(subscription.reader, ReadPosition::Region(_))
    }

    /// The region of which a reader gets the messages alone.
    pub fn region(&self, subscription: &TopicReader) -> Option<Region> {
        self.topics[self.read_by(subscription)].region(&subscription.reader)
    }

    /// Lets a reader get the messages of a region alone, of which at most `queue` events wait, or all again.
    pub fn set_region(
        &mut self,
        subscription: &mut TopicReader,
        region: Option<Region>,
        queue: impl Into<Option<usize>>,
    ) {
        let own = self.read_by(subscription);
        let topic = &mut self.topics[own];
        let before = subscription.reader;
        topic.set_region(&mut subscription.reader, region, queue.into());
        if subscription.reader != before {
            topic.readers.moved(subscription.number, subscription.reader);
        }
        self.set_interest(subscription, region.as_ref());
    }

    /// Puts back what the last [`collect`](Bus::collect) put into an inbox. Events stay in the inbox, since their topic
    /// does not keep them; of a state topic the next collection has the newest messages. Returns the number of messages
    /// that left the inbox.
    pub fn put_back(&mut self, subscription: &mut TopicReader, inbox: &mut Vec<SharedMessage>) -> u64 {
        let own = self.read_by(subscription);
        if !self.topics[own].put_back(&mut subscription.reader) {
            return 0;
        }
        let back = inbox.len() as u64;
        inbox.clear();
        back
    }

    /// Resets a reader: on a state topic it gets all retained messages again, on an event topic it has lost none.
    pub fn rewind(&mut self, subscription: &mut TopicReader) {
        let own = self.read_by(subscription);
        self.topics[own].rewind(&mut subscription.reader);
    }

    /// Gives a reader another bound for the events that wait for it.
    pub fn resize(&mut self, subscription: &TopicReader, queue: impl Into<Option<usize>>) {
        let own = self.read_by(subscription);
        self.topics[own].resize(&subscription.reader, queue.into());
    }

    /// The topic that a subscription reads.
    pub fn topic_of(&self, subscription: &TopicReader) -> TopicId {
        subscription.topic
    }

    /// Notes the numbers of observers outside the fleet that want the messages of a topic.
    pub fn observe(&mut self, topic: TopicId, observers: &[u32]) {
        let known = &mut self.topics[topic.0 as usize].observers;
        let more: Vec<u32> =
            observers.iter().copied().filter(|one| known.as_ref().is_none_or(|known| !known.contains(one))).collect();
        if !more.is_empty() {
            *known = Some(known.iter().flat_map(|known| known.iter().copied()).chain(more).collect());
        }
    }

    /// Notes that an observer outside the fleet wants the messages of a topic no more.
    pub fn ignore(&mut self, topic: TopicId, observer: u32) {
        let known = &mut self.topics[topic.0 as usize].observers;
        let others: Vec<u32> =
            known.iter().flat_map(|known| known.iter().copied()).filter(|one| *one != observer).collect();
        *known = (!others.is_empty()).then(|| others.into());
    }

    /// The numbers of the observers outside the fleet that want its messages; `None` if there is none.
    #[inline]
    pub fn observers(&self, topic: TopicId) -> Option<&Arc<[u32]>> {
        self.topics[topic.0 as usize].observers.as_ref()
    }

    /// The name of a topic.
    pub fn name(&self, topic: TopicId) -> &Arc<str> {
        &self.topics[topic.0 as usize].name
    }

    /// A hash of a topic's name, the same on every machine.
    #[inline]
    pub fn name_hash(&self, topic: TopicId) -> u64 {
        self.topics[topic.0 as usize].name_hash
    }

    fn add(&mut self, topic: BusTopic, newest: u64) {
        self.topics.push(topic);
        self.newest.push(newest);
    }

    fn user(&mut self, name: &str, declared: &TopicDeclaration<'_>, by: &Arc<str>) -> Result<TopicId, Mismatch> {
        if let Some(&id) = self.names.get(name) {
            let topic = &mut self.topics[id.0 as usize];
            topic.join(declared, by)?;
            self.changes += u64::from(topic.users == 1);
            return Ok(id);
        }
        let id = TopicId(u32::try_from(self.topics.len()).unwrap_or(u32::MAX));
        let name: Arc<str> = Arc::from(name);
        self.add(BusTopic::new(Arc::clone(&name), declared, by), 0);
        self.names.insert(name, id);
        self.changes += 1;
        Ok(id)
    }
}

impl fmt::Debug for Bus {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.topics.iter().map(|topic| &topic.name)).finish()
    }
}
