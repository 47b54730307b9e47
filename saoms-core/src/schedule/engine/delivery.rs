use std::collections::BTreeMap;
use std::sync::Arc;

use saoms_api::Level;
use saoms_api::host::{SharedMessage, TopicKind};
use saoms_lang::assembly::Loss;

use super::{Engine, RunPhase};
use crate::bus::{MOST_KEYS, TopicId};
use crate::observe::{Notification, Occurrence, SentMessage};
use crate::schedule::component::part::Part;
use crate::schedule::inject::OUTSIDE_NAME;
use crate::schedule::networks::NO_NETWORK;

impl Engine {
    /// Takes over the journal records of a component.
    #[inline]
    pub(crate) fn record(&mut self, part: &mut Part, now: u64) {
        let recorder = &mut part.recorder;
        if recorder.is_empty() {
            return;
        }
        self.standstill.note_effect(now);
        if let Some(trace) = &mut self.trace {
            for head in recorder.batch.heads() {
                trace.record(head);
            }
        }
        if let Some(records) = &self.records {
            records.put(part.index, recorder);
        }
        self.slots[part.index as usize].journal.take(recorder, self.journal_capacity);
    }

    /// Publishes the messages of an outbox, and takes over its records. At the end of a run messages have no reader any
    /// more, so that no queue can overflow.
    #[inline]
    pub(crate) fn deliver(&mut self, part: &mut Part, now: u64) {
        self.record(part, now);
        if part.effects.has_new() {
            part.effects.note_cut(self.want_cut(now));
        }
        let events = if part.outbox.is_empty() { Vec::new() } else { self.events_to_keep(part) };
        if !part.to_keep.is_empty() || !events.is_empty() {
            self.keep(part, events, now);
        }
        if part.outbox.is_empty() {
            return;
        }
        let sent_bytes = std::mem::take(&mut part.sent_bytes);
        let settles = std::mem::take(&mut part.has_raised) || self.says_last_words(part);
        let slot = &self.slots[part.index as usize];
        if self.memory.is_over(self.phase) && !slot.is_cut_off {
            // It stays in the program: what waits for a commit leaves over networks, and this does not.
            self.send_all((part.index, &part.name), NO_NETWORK, part.outbox.drain(..), settles, now);
        } else if slot.uncommitted.is_empty() && !slot.is_cut_off {
            self.send_all((part.index, &part.name), slot.network, part.outbox.drain(..), settles, now);
        } else {
            // Those for a network have this form there.
            let bytes = match slot.network {
                NO_NETWORK => sent_bytes,
                _ => part.outbox.iter().map(|(_, message)| message.bytes().len()).sum(),
            };
            self.hold_back(part, bytes, settles);
        }
    }

    /// Sends messages of a component, also over a network. With `settles` the run does not end before they are read.
    #[inline]
    pub(super) fn send_all(
        &mut self,
        (index, name): (u32, &Arc<str>),
        network: u8,
        messages: impl ExactSizeIterator<Item = (TopicId, SharedMessage)>,
        settles: bool,
        now: u64,
    ) {
        self.standstill.note_effect(now);
        if settles && self.phase == RunPhase::Running {
            self.settle(now);
        }
        self.slots[index as usize].statistics.sent += messages.len() as u64;
        for (topic, message) in messages {
            if network != NO_NETWORK {
                self.put_on_network(network, name, topic, &message, now);
            }
            if let Some(trace) = &mut self.trace {
                trace.message(now, index, self.bus.name_hash(topic), &message);
            }
            if let Some(observers) = self.bus.observers(topic) {
                let (topic, component) = (Arc::clone(self.bus.name(topic)), Arc::clone(name));
                let sent = SentMessage { topic, component, message: message.clone(), is_of_other: false };
                self.notifications.push(Notification::Sent(sent, Arc::clone(observers)));
            }
            if self.phase == RunPhase::Running {
                self.send(topic, message, now);
            }
        }
    }

    /// True if the outbox has an event that somebody reads, and its component sees no work left from now on: the event
    /// has to be read before the run ends.
    #[inline]
    fn says_last_words(&self, part: &Part) -> bool {
        let slot = &self.slots[part.index as usize];
        let is_read = |topic| slot.network != NO_NETWORK || self.bus.readers(topic).next().is_some();
        part.vote.is_some_and(|vote| vote.is_done())
            && slot.sees_work != Some(false)
            && part.outbox.iter().any(|(topic, _)| self.bus.kind(*topic) == TopicKind::Event && is_read(*topic))
    }

    /// Sends a message to the readers of its topic.
    #[inline]
    pub(crate) fn send(&mut self, topic: TopicId, message: SharedMessage, now: u64) {
        if self.faults.is_quiet() {
            self.publish(topic, message, now);
        } else {
            self.send_with_faults(topic, message, now);
        }
    }

    /// Puts a message into its topic, and triggers the components that react to it.
    #[inline]
    pub(crate) fn publish(&mut self, topic: TopicId, message: SharedMessage, now: u64) {
        let (sender, to) = (message.header().sender, message.to());
        if to.is_some() {
            self.bus.note_addressed(topic);
        }
        if !self.bus.publish(topic, message) {
            return self.unkept(sender, topic, now);
        }
        if !self.bus.triggers(topic).is_empty() {
            self.trigger_all(topic, to, now);
        }
    }

    /// Counts a message that its topic could not keep, since its publisher has too many keys there.
    #[cold]
    fn unkept(&mut self, sender: u32, topic: TopicId, now: u64) {
        let topic = Arc::clone(self.bus.name(topic));
        let keys = format!(
            "has published {MOST_KEYS} keys on topic `{topic}`, the maximum: messages with other keys are lost; reuse keys, or use an event topic"
        );
        let Some(slot) = self.slots.get_mut(sender as usize) else {
            let who = self.name_of(sender).unwrap_or_else(|| Arc::from(OUTSIDE_NAME));
            let reason = format!("`{who}` {keys}");
            if !self.reasons.contains(&reason) {
                self.reasons.push(reason);
            }
            return;
        };
        slot.statistics.unkept += 1;
        if slot.statistics.unkept == 1 {
            self.reasons.push(format!("component `{}` {keys}", slot.name));
            self.emit(now, sender, Occurrence::Log { level: Level::Warning, text: keys });
        }
    }

    /// Counts messages that did not fit into a queue, beside these that did.
    #[cold]
    pub(crate) fn dropped(&mut self, index: u32, topic: &Arc<str>, count: u64, others: &[SharedMessage], now: u64) {
        let sender = self.most_frequent_sender(others);
        let slot = &mut self.slots[index as usize];
        if slot.statistics.dropped == 0 && slot.policy.loss == Loss::Fail {
            let by = sender.as_ref().map(|sender| format!(" (most were sent by `{sender}`)")).unwrap_or_default();
            self.reasons.push(format!(
                "component `{}` lost messages of topic `{topic}`, whose queue was full{by}: read faster, give it a longer `queue`, \
                 or accept loss",
                slot.name
            ));
        }
        slot.statistics.dropped += count;
        if !std::mem::replace(&mut slot.dropping, true) {
            self.emit(now, index, Occurrence::Dropped { topic: Arc::clone(topic), count, sender });
        }
    }

    fn most_frequent_sender(&self, messages: &[SharedMessage]) -> Option<Arc<str>> {
        let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
        for message in messages {
            *counts.entry(message.header().sender).or_default() += 1;
        }
        let (sender, _) = counts.into_iter().max_by_key(|(_, count)| *count)?;
        self.name_of(sender)
    }
}
