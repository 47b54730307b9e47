//! Reactions: components that messages trigger, at once and beside their executions.

use super::Engine;
use super::slot::{NEVER, SlotState};
use crate::bus::TopicId;
use crate::schedule::component::body::{Body, Job};

impl Engine {
    /// Triggers all components that react to messages of a topic, or the one that a message is for.
    #[cold]
    pub(super) fn trigger_all(&mut self, topic: TopicId, to: Option<u32>, now: u64) {
        for place in 0..self.bus.triggers(topic).len() {
            let index = self.bus.triggers(topic)[place];
            if to.is_none_or(|to| to == index) {
                self.trigger(index, now);
            }
        }
    }

    /// Triggers a component, unless a reaction of it is due already.
    fn trigger(&mut self, index: u32, now: u64) {
        let slot = &mut self.slots[index as usize];
        if slot.state != SlotState::Active || slot.react_due != NEVER {
            return;
        }
        let earliest = slot.last_react.map_or(0, |last| last.saturating_add(slot.policy.minimum));
        slot.triggered = now;
        slot.react_due = now.max(earliest);
        // Without an entry its code runs, and the end of that enters it.
        if slot.entry != NEVER && slot.react_due < slot.entry {
            let when = slot.react_due.max(slot.busy_until);
            self.enqueue(index, when);
        }
    }

    /// Triggers a component that starts or goes on, if messages wait for it.
    pub(crate) fn react_to_news(&mut self, index: u32, now: u64) {
        let body = self.slots[index as usize].body.as_ref();
        let hears_again = body.is_some_and(|body| body.reactions.iter().any(|inbox| !inbox.is_empty()));
        if hears_again || self.has_news(index) {
            self.trigger(index, now);
        }
    }

    /// True if messages wait for a reaction.
    fn has_news(&self, index: u32) -> bool {
        let Some(body) = &self.slots[index as usize].body else { return false };
        let is_news = |subscription| self.bus.is_trigger(subscription) && self.bus.has_news(subscription);
        body.part.subscriptions.iter().any(is_news) || body.reactions.iter().any(|inbox| !inbox.is_empty())
    }

    /// The reaction that is due, unless what triggered it was in none of the component's regions.
    pub(super) fn reaction(&mut self, index: u32) -> Option<Job> {
        if self.has_news(index) {
            return Some(Job::React);
        }
        let slot = &mut self.slots[index as usize];
        slot.react_due = NEVER;
        let when = slot.next_time();
        self.enqueue(index, when);
        None
    }

    /// Has a reaction tried again, with the messages that it had.
    pub(super) fn react_again(&mut self, index: u32, now: u64) {
        let slot = &mut self.slots[index as usize];
        slot.triggered = slot.reacts_since;
        slot.react_due = now.saturating_add(slot.policy.minimum);
    }

    /// Collects what a reaction is for.
    pub(super) fn begin_reaction(&mut self, index: u32, body: &mut Body) {
        let slot = &mut self.slots[index as usize];
        let (due, now) = (std::mem::replace(&mut slot.react_due, NEVER), body.part.now);
        slot.reacts_since = std::mem::replace(&mut slot.triggered, NEVER);
        slot.last_react = Some(due);
        slot.statistics.reactions += 1;
        body.part.due = due;
        self.collect(index, body, true, now);
        self.note_reading(index, &body.part, &body.reactions);
    }
}
