//! What the fleet is told of components that failed and lost what they knew, so that others act in their place.

use saoms_api::Time;
use saoms_api::extension::{FailureNotice, Outage};
use serde_json::Map;

use super::{Engine, RunPhase};
use crate::bus::TopicId;
use crate::journal::COMPONENT_FAILED;

impl Engine {
    /// Tells the site of a component that it failed and lost what it knew. One that never executed had nothing.
    #[cold]
    pub(super) fn tell_outage(&mut self, index: u32, restarts: bool, now: u64) {
        if self.phase == RunPhase::Running && self.slots[index as usize].last_due.is_some() {
            self.tell_loss(index, restarts, now);
        }
    }

    /// Tells the site of a component that it lost what it knew.
    pub(super) fn tell_loss(&mut self, index: u32, restarts: bool, now: u64) {
        let slot = &self.slots[index as usize];
        let number = slot.spec.class.declaration().speaker(&slot.spec.values);
        let Some(number) = number.and_then(|number| u32::try_from(number).ok()) else { return };
        let outage = Outage { number, since: Time::from_nanos(now), restarts };
        for notice in FailureNotice::linked() {
            let slot = &self.slots[index as usize];
            let topics = if slot.spec.publishes().any(|topic| topic.name == notice.about.name) {
                self.topics_of_readers(notice.topic.name, &slot.spec.site)
            } else {
                Vec::new()
            };
            if topics.is_empty() {
                continue;
            }
            let name = std::sync::Arc::clone(&slot.name);
            let (bytes, text) = (notice.message)(outage);
            let cause = self.record_notice(now, &name, (COMPONENT_FAILED, text, Map::new()), self.faults.cause(index));
            self.standstill.note_effect(now);
            for topic in topics {
                self.deliver_injection((now, &name), cause, topic, (bytes.clone(), None, None), None);
            }
        }
    }

    /// The topics, as they are called on the bus, that components of a site read under this name.
    fn topics_of_readers(&self, declared: &str, site: &str) -> Vec<TopicId> {
        let mut topics: Vec<TopicId> = Vec::new();
        for (_, spec) in self.members_everywhere().filter(|(_, spec)| spec.site == site) {
            if !spec.subscribes().any(|topic| topic.name == declared) {
                continue;
            }
            if let Some(topic) = self.bus.find(&spec.topic(declared)).filter(|topic| !topics.contains(topic)) {
                topics.push(topic);
            }
        }
        topics
    }
}
