//! What the fleet is told of components that failed and lost what they knew, so that others act in their place.

use std::sync::Arc;

use saoms_api::extension::{FailureNotice, Outage};
use saoms_api::{Cause, Time};
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
            if slot.spec.publishes().any(|topic| topic.name == notice.about.name) {
                let (name, site) = (Arc::clone(&slot.name), slot.spec.site.to_string());
                self.send_notice(notice, (&name, &site), outage, self.faults.cause(index), now);
            }
        }
    }

    /// Tells the site of a component that it is no part of the fleet any more, although it had not left in an earlier
    /// program: what it had begun is left to others. `said` has the topics on which it published states last, with the
    /// messages. False if nobody wants to know.
    pub(super) fn tell_absence(&mut self, name: &Arc<str>, site: &str, said: &[(&str, &[u8])], now: u64) -> bool {
        let mut is_told = false;
        for notice in FailureNotice::linked() {
            let about = self.names_of(notice.about.name, site);
            let Some((topic, bytes)) = said.iter().find(|(topic, _)| about.iter().any(|name| name == topic)) else {
                continue;
            };
            // Its key is the number by which the component speaks.
            let schema = self.bus.find(topic).and_then(|topic| self.schema_of(topic).1.clone());
            let key = schema.filter(|schema| schema.check(bytes).is_ok()).and_then(|schema| schema.key(bytes));
            let Some(number) = key.and_then(|key| u32::try_from(key).ok()) else { continue };
            let outage = Outage { number, since: Time::from_nanos(now), restarts: false };
            is_told |= self.send_notice(notice, (name, site), outage, Cause::default(), now);
        }
        is_told
    }

    /// Sends a notice to its readers in a site. False if there are none.
    fn send_notice(
        &mut self,
        notice: &FailureNotice,
        (name, site): (&Arc<str>, &str),
        outage: Outage,
        cause: Cause,
        now: u64,
    ) -> bool {
        let topics = self.topics_of_readers(notice.topic.name, site);
        if topics.is_empty() {
            return false;
        }
        let (bytes, text) = (notice.message)(outage);
        let cause = self.record_notice(now, name, (COMPONENT_FAILED, text, Map::new()), cause);
        self.standstill.note_effect(now);
        for topic in topics {
            self.deliver_injection((now, name), cause, topic, (bytes.clone(), None, None), None);
        }
        true
    }

    /// The names on the bus that a topic has for components of a site.
    fn names_of(&self, declared: &str, site: &str) -> Vec<String> {
        let members = self.members_everywhere().filter(|(_, spec)| spec.site == site);
        let mut names: Vec<String> = members.map(|(_, spec)| spec.topic(declared).into_owned()).collect();
        names.sort_unstable();
        names.dedup();
        names
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
