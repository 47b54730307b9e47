//! Links: what a reader gets by a way of its own, because faults act on the way. A reader with a link reads a copy of
//! the topic that it has for itself; whoever plays the faults puts messages into it, or does not.

use std::collections::BTreeMap;

use super::topic::{BusTopic, ReadPosition};
use super::{Bus, TopicId, TopicReader};

/// The readers of a topic, and the links of some of them.
#[derive(Default)]
pub(super) struct Readers {
    /// Each reader's component and position, by the number of the reader.
    all: BTreeMap<u32, (u32, ReadPosition)>,
    /// By the number of the reader.
    links: Vec<Link>,
}

/// The link of one reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// The number of the reader.
    number: u32,
    /// The component that reads.
    pub component: u32,
    /// The copy of the topic that it reads.
    pub topic: TopicId,
}

impl Readers {
    #[inline]
    pub(super) fn have_links(&self) -> bool {
        !self.links.is_empty()
    }

    /// The readers: the number, the component and the position of each.
    pub(super) fn positions(&self) -> impl Iterator<Item = (u32, u32, ReadPosition)> {
        self.all.iter().map(|(number, (component, position))| (*number, *component, *position))
    }

    pub(super) fn position(&self, number: u32) -> Option<ReadPosition> {
        self.all.get(&number).map(|(_, position)| *position)
    }

    pub(super) fn link(&self, number: u32) -> Option<TopicId> {
        let place = self.links.binary_search_by_key(&number, |link| link.number).ok()?;
        Some(self.links[place].topic)
    }

    pub(super) fn moved(&mut self, number: u32, position: ReadPosition) {
        if let Some(reader) = self.all.get_mut(&number) {
            reader.1 = position;
        }
    }

    fn remove(&mut self, number: u32) {
        self.all.remove(&number);
        self.links.retain(|link| link.number != number);
    }
}

impl Bus {
    /// Notes the component of a reader, so that the reader can get a link.
    pub fn register(&mut self, subscription: &TopicReader, component: u32) {
        let readers = &mut self.topics[subscription.topic.0 as usize].readers;
        readers.all.insert(subscription.number, (component, subscription.reader));
    }

    /// Gives the readers of a topic for which `is_wanted` holds links of their own, if they have none: with what they
    /// have not read, and all that is retained.
    pub fn link(&mut self, topic: TopicId, is_wanted: impl Fn(u32) -> bool) {
        let readers = &self.topics[topic.0 as usize].readers;
        let is_new = |number: u32, component: u32| is_wanted(component) && readers.link(number).is_none();
        let wanted: Vec<(u32, u32, ReadPosition)> = readers
            .all
            .iter()
            .filter(|(number, (component, _))| is_new(**number, *component))
            .map(|(number, (component, position))| (*number, *component, *position))
            .collect();
        let topic_number = topic.0 as usize;
        for (number, component, position) in wanted {
            let id = TopicId(u32::try_from(self.topics.len()).unwrap_or(u32::MAX));
            let topic = &mut self.topics[topic_number];
            let mut copy = topic.copy_for(&position);
            topic.leave(position);
            if let Some(place) = topic.triggers.iter().position(|triggered| *triggered == component) {
                copy.triggers.push(topic.triggers.remove(place));
            }
            let links = &mut topic.readers.links;
            let place = links.partition_point(|link| link.number < number);
            links.insert(place, Link { number, component, topic: id });
            self.add(copy, self.published + 1);
            self.published += 1;
            self.relinked = self.published;
        }
    }

    /// The components that read a topic, in the order in which they subscribed.
    pub fn readers(&self, topic: TopicId) -> impl Iterator<Item = u32> {
        self.topics[topic.0 as usize].readers.all.values().map(|(component, _)| *component)
    }

    /// The links of a topic's readers, in the order in which they subscribed.
    #[inline]
    pub fn links(&self, topic: TopicId) -> &[Link] {
        &self.topics[topic.0 as usize].readers.links
    }

    /// The topic, or the copy of it, that a reader reads.
    #[inline]
    pub(super) fn read_by(&self, subscription: &TopicReader) -> usize {
        let topic = &self.topics[subscription.topic.0 as usize];
        if !topic.readers.have_links() {
            return subscription.topic.0 as usize;
        }
        topic.readers.link(subscription.number).unwrap_or(subscription.topic).0 as usize
    }

    /// Forgets a reader, and empties the copy that it had.
    pub(super) fn forget(&mut self, subscription: &TopicReader) {
        let (main, own) = (subscription.topic.0 as usize, self.read_by(subscription));
        self.topics[main].readers.remove(subscription.number);
        if own != main {
            self.topics[own].empty();
        }
    }
}

impl BusTopic {
    /// A copy for one reader, with what it has not read.
    fn copy_for(&self, position: &ReadPosition) -> BusTopic {
        let mut copy = self.copied();
        copy.keep_reader(position);
        copy
    }
}
