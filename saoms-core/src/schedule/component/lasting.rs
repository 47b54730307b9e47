//! What a component goes on from after a failure: the state that it saved, and the messages that it heard in vain.

use std::sync::Arc;

use saoms_api::host::SharedMessage;
use saoms_api::host::contain::contained;
use saoms_api::{Failure, Saved};

use super::body::Body;
use super::part::Part;
use super::steps::note_restored;
use crate::bus::{Bus, TopicId};
use crate::report::Sections;
use crate::schedule::engine::memory::AlertForm;

/// What outlives an instance that fails.
#[derive(Debug, Default)]
pub(crate) struct Lasting {
    /// True if the state is saved after each execution, for a restart after a failure.
    pub(crate) saves: bool,
    /// True if it is saved after each execution, so that it outlives the program; and whether it is after each call,
    /// too, since nobody else may run its code.
    pub(crate) outlives: bool,
    pub(crate) saves_at_once: bool,
    /// State of the last execution that did not fail.
    saved: Option<Arc<Saved>>,
    /// True if the saved state is of an earlier program.
    is_recalled: bool,
    /// True while an instance initializes that goes on from it.
    goes_on: bool,
    /// True if the present instance has gone on from it.
    continued: bool,
    /// True if the state may have changed since, by a call or an execution that was skipped.
    touched: bool,
    /// What was counted since, which a failure takes back: the next instance counts it again.
    counted: Vec<(String, i64)>,
    /// Events of the execution that failed, by topic: the next instance hears them again.
    unread: Vec<(TopicId, Vec<SharedMessage>)>,
    /// The same of the reaction that failed.
    unread_reactions: Vec<(TopicId, Vec<SharedMessage>)>,
    /// True if the present instance hears such events, and has not finished an execution yet. If it fails, too, they
    /// may be why: they are not heard a third time.
    hears_unread: bool,
    /// True if the events that are unread are of an earlier program, in which no execution failed that heard them.
    is_unread_recalled: bool,
}

impl Lasting {
    /// Begins an instance.
    pub(super) fn begin(&mut self) {
        self.goes_on = self.will_go_on();
        if !self.goes_on {
            self.saved = None;
        }
        (self.continued, self.touched) = (false, false);
        self.counted.clear();
    }

    /// True if the next instance goes on from a saved state.
    pub(crate) fn will_go_on(&self) -> bool {
        (self.saves || self.is_recalled) && self.saved.as_ref().is_some_and(|saved| !saved.is_nothing())
    }

    /// Has the next instance go on from the state that an earlier program saved.
    pub(crate) fn recall(&mut self, saved: Arc<Saved>) {
        (self.saved, self.is_recalled) = (Some(saved), true);
    }

    /// True if the state is of an earlier program, and no instance of this one has gone on from it.
    pub(super) fn is_recalled(&self) -> bool {
        self.is_recalled
    }

    /// The state that was saved last.
    pub(crate) fn saved(&self) -> Option<&Arc<Saved>> {
        self.saved.as_ref()
    }

    /// True if the state may have changed since it was saved.
    pub(crate) fn is_touched(&self) -> bool {
        self.touched
    }

    /// True if the state is saved after each execution.
    #[inline]
    pub(super) fn is_saved(&self) -> bool {
        self.saves || self.outlives
    }

    /// The events that an execution heard in vain, by topic.
    pub(crate) fn unread(&self) -> impl Iterator<Item = &(TopicId, Vec<SharedMessage>)> {
        self.unread.iter().chain(&self.unread_reactions)
    }

    /// Has the next instance hear events, or react to them, that an earlier program left.
    pub(crate) fn hear_recalled(&mut self, topic: TopicId, messages: Vec<SharedMessage>, reacts: bool) {
        let unread = if reacts { &mut self.unread_reactions } else { &mut self.unread };
        unread.push((topic, messages));
        self.is_unread_recalled = true;
    }

    /// True while an instance initializes that goes on from a saved state.
    pub(super) fn goes_on(&self) -> bool {
        self.goes_on
    }

    /// An instance of a takeover, which restores this state.
    pub(crate) fn of_takeover(saved: &Saved) -> Lasting {
        Lasting { goes_on: !saved.is_nothing(), ..Lasting::default() }
    }

    /// True if the present instance has gone on from a saved state.
    pub(crate) fn has_continued(&self) -> bool {
        self.continued
    }

    /// Forgets all: whoever is scheduled anew begins anew.
    pub(crate) fn forget(&mut self) {
        let Lasting { saves, outlives, saves_at_once, .. } = *self;
        *self = Lasting { saves, outlives, saves_at_once, ..Lasting::default() };
    }

    /// Forgets the state of an instance that was replaced by one of another build.
    pub(crate) fn forget_state(&mut self) {
        (self.saved, self.touched, self.is_recalled) = (None, false, false);
        self.counted.clear();
    }

    /// True if the events of an execution that failed are heard again: by an instance that goes on from a state that
    /// was saved, or from bytes that were kept.
    pub(super) fn hears_again(&self, keeps: bool) -> bool {
        (keeps || self.saves && self.saved.is_some()) && !self.hears_unread
    }

    /// Notes that an execution has ended well, in which all that it heard was heard.
    #[inline]
    pub(super) fn note_heard(&mut self) {
        self.hears_unread = false;
    }

    /// Notes that the state may have changed other than by an execution.
    pub(crate) fn touch(&mut self) {
        self.touched = self.is_saved();
    }

    /// Takes over the events that the instance before a takeover had not handled.
    pub(crate) fn take_unread(
        &mut self,
        [inboxes, reactions]: [Vec<Vec<SharedMessage>>; 2],
        topics: impl Iterator<Item = TopicId> + Clone,
    ) {
        let unread = |inboxes: Vec<Vec<SharedMessage>>| {
            topics.clone().zip(inboxes).filter(|(_, inbox)| !inbox.is_empty()).collect()
        };
        (self.unread, self.unread_reactions) = (unread(inboxes), unread(reactions));
    }

    /// Notes a count, which a failure takes back.
    pub(super) fn note_count(&mut self, path: &str, more: i64) {
        if self.saves {
            self.counted.push((path.to_owned(), more));
        }
    }
}

impl Part {
    /// Takes back what was counted since the last save.
    pub(super) fn take_back_counts(&mut self, sections: &mut Sections) {
        if self.lasting.saves && self.lasting.saved.is_some() {
            for (path, more) in self.lasting.counted.drain(..) {
                // It was added, so there is room for it.
                let _ = sections.add(&path, more.saturating_neg());
            }
            sections.forget_in_code(self.index);
        }
    }

    /// Notes an alert that the component raises or ends.
    pub(super) fn note_alert(&mut self, kind: &str, subject: &str, text: Option<&str>) {
        self.alerts.retain(|alert| alert.kind != kind || alert.subject != subject);
        if let Some(text) = text {
            self.alerts.push(AlertForm { kind: kind.into(), subject: subject.into(), text: text.into() });
        }
    }
}

impl Body {
    /// True if it was given messages that it has not handled.
    pub(crate) fn has_unread(&self) -> bool {
        let inboxes = self.inboxes.iter().chain(&self.reactions);
        self.part.lasting.unread().next().is_some() || inboxes.into_iter().any(|inbox| !inbox.is_empty())
    }

    /// Saves the state after an execution, for the instance that a restart puts in its place.
    #[cold]
    pub(super) fn save(&mut self) -> Result<(), Failure> {
        let Some(instance) = &mut self.instance else { return Ok(()) };
        let saved = contained(|| instance.save()).and_then(|saved| saved);
        let saved = saved.map_err(|failure| Failure::new(format!("could not save its state: {failure}")))?;
        let lasting = &mut self.part.lasting;
        lasting.touched = false;
        lasting.counted.clear();
        if lasting.saved.as_deref() != Some(&saved) {
            lasting.saved = Some(Arc::new(saved));
        }
        Ok(())
    }

    /// Saves what changed since the last execution, before code runs that may fail.
    #[inline]
    pub(super) fn save_touched(&mut self) -> Result<(), Failure> {
        if self.part.lasting.touched && self.part.lasting.saves { self.save() } else { Ok(()) }
    }

    /// Saves what changed since the last execution, so that it outlives the program.
    pub(in crate::schedule) fn save_for_later(&mut self) -> Result<(), Failure> {
        if self.part.lasting.touched { self.save() } else { Ok(()) }
    }

    /// Goes on from what the instance before had saved. A state that cannot be restored is forgotten. An instance that
    /// begins saves what it begins with.
    pub(super) fn go_on(&mut self) -> Result<(), Failure> {
        let lasting = &mut self.part.lasting;
        let was_recalled = std::mem::replace(&mut lasting.is_recalled, false);
        lasting.goes_on = false;
        let Some(instance) = &mut self.instance else { return Ok(()) };
        let Some(saved) = lasting.saved.take().filter(|saved| !saved.is_nothing()) else {
            if lasting.is_saved() && self.save().is_err() {
                // It has nothing to save before its first execution.
                self.part.lasting.saved = None;
            }
            return Ok(());
        };
        note_restored(&mut self.part.tape, &saved);
        let restored = contained(|| instance.restore(&saved)).and_then(|restored| restored);
        restored.map_err(|failure| Failure::new(format!("could not continue with its saved state: {failure}")))?;
        (lasting.saved, lasting.continued) = (Some(saved), true);
        // It may note that the state is of an earlier program, which the next instance is to know, too.
        lasting.touched = was_recalled && lasting.is_saved();
        lasting.counted.clear();
        Ok(())
    }

    /// Keeps the events that an instance heard in vain. The next one gets the states of topics anyway.
    pub(crate) fn keep_unread(&mut self, bus: &mut Bus) {
        let Body { inboxes, reactions, part: Part { subscriptions, lasting, .. }, .. } = self;
        for (inboxes, unread) in [(inboxes, &mut lasting.unread), (reactions, &mut lasting.unread_reactions)] {
            for (subscription, inbox) in subscriptions.iter_mut().zip(inboxes) {
                if !inbox.is_empty() || bus.has_region(subscription) {
                    bus.put_back(subscription, inbox);
                }
                if !inbox.is_empty() {
                    unread.push((bus.topic_of(subscription), std::mem::take(inbox)));
                }
            }
        }
    }

    /// Gives these events to the present instance, before those that came since.
    pub(crate) fn give_unread(&mut self, bus: &Bus) {
        let Body { inboxes, reactions, part: Part { subscriptions, lasting, .. }, .. } = self;
        if lasting.unread.is_empty() && lasting.unread_reactions.is_empty() {
            return;
        }
        lasting.hears_unread = !std::mem::take(&mut lasting.is_unread_recalled);
        for (inboxes, unread) in [(inboxes, &mut lasting.unread), (reactions, &mut lasting.unread_reactions)] {
            for (topic, messages) in unread.drain(..) {
                let mut places = subscriptions.iter().zip(&mut *inboxes);
                let place =
                    places.find(|(subscription, inbox)| bus.topic_of(subscription) == topic && inbox.is_empty());
                if let Some((_, inbox)) = place {
                    *inbox = messages;
                }
            }
        }
    }
}
