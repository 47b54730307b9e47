//! When components have executed what the network brought: with a state folder, others hear only then that it was
//! received, so that they still have it if this program is killed before.

use std::collections::HashMap;

use saoms_api::host::TopicKind;

use super::NetworkedFleet;
use crate::bus::TopicId;
use crate::schedule::engine::{Engine, RunPhase};

/// What components have to do until they have executed all that was there at a moment, and it is committed.
#[derive(Debug, Default)]
pub(super) struct Mark {
    /// Of each event topic, where its end was.
    ends: HashMap<TopicId, u64>,
    readers: Vec<Reader>,
}

#[derive(Debug)]
struct Reader {
    index: u32,
    /// Once it has executed: the last batch of what it kept until then, and the cut that has what it did.
    executed: Option<(u64, u64)>,
}

impl Engine {
    /// The present moment, for the components of a network.
    fn mark(&self, network: usize) -> Mark {
        let events = self.bus.topics().filter(|topic| self.bus.kind(*topic) == TopicKind::Event);
        let of_network = |index: &u32| {
            let slot = &self.slots[*index as usize];
            usize::from(slot.network) == network && slot.is_alive()
        };
        let readers = (0..self.slots.len() as u32).filter(of_network);
        Mark {
            ends: events.filter_map(|topic| Some((topic, self.bus.event_end(topic)?))).collect(),
            readers: readers.map(|index| Reader { index, executed: None }).collect(),
        }
    }

    /// Leaves those in a mark that still have something to do.
    fn look_at_mark(&mut self, mark: &mut Mark, now: u64) {
        let Mark { ends, readers } = mark;
        readers.retain_mut(|reader| {
            let slot = &self.slots[reader.index as usize];
            if !slot.is_alive() {
                return false;
            }
            if reader.executed.is_none() && self.has_executed(reader.index, ends) {
                let batch = slot.uncommitted.back().map_or(0, |last| last.number);
                let cut = if self.memory.is_on() { self.want_cut(now) } else { 0 };
                reader.executed = Some((batch, cut));
            }
            let slot = &self.slots[reader.index as usize];
            let is_committed = |(batch, cut): (u64, u64)| {
                slot.uncommitted.front().is_none_or(|first| first.number > batch)
                    && !slot.is_cut_off
                    && self.memory.is_committed(cut)
            };
            !reader.executed.is_some_and(is_committed)
        });
    }

    /// True if a component has executed all that came before these ends.
    fn has_executed(&self, index: u32, ends: &HashMap<TopicId, u64>) -> bool {
        let Some(body) = &self.slots[index as usize].body else { return false };
        let has_read = |subscription| match self.bus.read_up_to(subscription) {
            Some(read) => ends.get(&self.bus.topic_of(subscription)).is_none_or(|end| read >= *end),
            None => {
                self.bus.kind(self.bus.topic_of(subscription)) == TopicKind::State || !self.bus.has_news(subscription)
            }
        };
        let inboxes = body.inboxes.iter().chain(&body.reactions);
        inboxes.into_iter().all(Vec::is_empty) && body.part.subscriptions.iter().all(has_read)
    }
}

impl NetworkedFleet {
    /// Marks the present moment.
    pub(super) fn mark(&self) {
        let mut engine = self.shared.lock();
        let mark = engine.mark(self.network);
        engine.networks.marks.insert(self.network, mark);
        self.shared.release(engine);
    }

    /// True if all that had come before the mark is executed and committed, or never will be.
    pub(super) fn has_passed_mark(&self) -> bool {
        let mut engine = self.shared.lock();
        let mut mark = engine.networks.marks.remove(&self.network).unwrap_or_default();
        let is_over = !matches!(engine.phase, RunPhase::Starting | RunPhase::Running);
        engine.look_at_mark(&mut mark, self.shared.clock.now());
        let has_passed = is_over || mark.readers.is_empty();
        if !has_passed {
            engine.networks.marks.insert(self.network, mark);
        }
        self.shared.release(engine);
        has_passed
    }
}
