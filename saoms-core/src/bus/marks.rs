//! Readers that are taken off their topics by others than their owners, who may never give them back.

use super::{Bus, TopicId, TopicReader};

/// A reader, for whoever takes it off its topic in place of its owner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReaderMark {
    topic: TopicId,
    number: u32,
    triggers: Option<u32>,
}

impl ReaderMark {
    /// The topic that it reads.
    pub fn topic(&self) -> TopicId {
        self.topic
    }
}

impl TopicReader {
    /// Names this reader, as it is now: what it triggers may not change any more.
    pub fn mark(&self) -> ReaderMark {
        ReaderMark { topic: self.topic, number: self.number, triggers: self.triggers }
    }
}

impl Bus {
    /// Takes a [registered](Bus::register) reader off its topic, if it is there still. Its owner must not use it any
    /// more.
    pub fn take_off(&mut self, mark: ReaderMark) {
        let ReaderMark { topic, number, triggers } = mark;
        if let Some(reader) = self.topics[topic.0 as usize].readers.position(number) {
            self.unsubscribe(TopicReader { topic, number, reader, triggers });
        }
    }
}
