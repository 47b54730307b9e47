use std::sync::Arc;

use saoms_api::host::DynComponent;
use saoms_api::host::contain::contained;
use saoms_api::{Failure, Saved};
use saoms_lang::assembly::ComponentSpec;

use super::body::{Body, Part};
use super::shared::Shared;
use crate::bus::{Bus, TopicId, TopicReader};
use crate::journal::Recorder;

/// The outcome of a replacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takeover {
    /// The new instance runs, and goes on where the earlier one was.
    Continued,
    /// The new instance runs, from the beginning.
    Began,
    /// It did not run. The new one is for when it is scheduled the next time; one that had failed is scheduled now.
    Awaited,
}

/// Why no instance took over. The earlier one goes on.
#[derive(Debug)]
pub(super) enum Refusal {
    /// It may be possible later.
    NotNow(String),
    /// The new one does not come to be, or cannot go on where the earlier one was.
    Failed(Failure),
}

/// An instance that another one has taken over from, until the change is committed.
pub(super) struct Predecessor {
    instance: Box<dyn DynComponent>,
    ties: Ties,
}

/// What ties an instance to the fleet.
struct Ties {
    spec: Arc<ComponentSpec>,
    publishers: Vec<TopicId>,
    subscriptions: Vec<TopicReader>,
    recorder: Recorder,
}

impl Body {
    /// Lets a new instance go on where the present one is: it is constructed, the present one [saves](saoms_api::Component::save) what the
    /// new one needs, which initializes and restores that. After an error the present one stays.
    pub(super) fn take_over(
        &mut self,
        shared: &Arc<Shared>,
        spec: Arc<ComponentSpec>,
    ) -> Result<(Predecessor, Takeover), Refusal> {
        let construct = || contained(|| spec.class.construct(&spec.values))?;
        let successor = construct().map_err(Refusal::Failed)?;
        let Some(present) = &mut self.instance else {
            return Err(Refusal::NotNow("it has just ended".to_owned()));
        };
        let saved = contained(|| present.save()).map_err(Refusal::Failed)?;
        let saved = saved.map_err(|failure| Refusal::NotNow(failure.to_string()))?;
        let ties = Ties::take(&mut self.part, spec);
        let Some(instance) = self.instance.replace(successor) else {
            return Err(Refusal::NotNow("it has just ended".to_owned()));
        };
        let predecessor = Predecessor { instance, ties };
        if let Err(failure) = self.begin_instead(shared, &saved) {
            self.give_back(&mut shared.lock().bus, predecessor);
            return Err(Refusal::Failed(failure));
        }
        self.inboxes.clear();
        self.inboxes.resize_with(self.part.subscriptions.len(), Vec::new);
        Ok((predecessor, if saved.is_nothing() { Takeover::Began } else { Takeover::Continued }))
    }

    fn begin_instead(&mut self, shared: &Arc<Shared>, saved: &Saved) -> Result<(), Failure> {
        self.inboxes.clear();
        self.part.held = true;
        self.part.initializing = true;
        let result = self.call(shared, |instance, context| {
            instance.initialize(context)?;
            if saved.is_nothing() { Ok(()) } else { instance.restore(saved) }
        });
        self.part.initializing = false;
        result?
    }

    /// The change is committed: the new instance reads on where the earlier one was; what that one had beside is given up.
    pub(super) fn inherit(&mut self, bus: &mut Bus, predecessor: Predecessor) {
        let Predecessor { instance, ties } = predecessor;
        let Ties { publishers, mut subscriptions, .. } = ties;
        let queue = self.part.spec.task.as_ref().map(|task| task.queue);
        for fresh in &mut self.part.subscriptions {
            let topic = bus.topic_of(fresh);
            if let Some(place) = subscriptions.iter().position(|old| bus.topic_of(old) == topic) {
                std::mem::swap(fresh, &mut subscriptions[place]);
                bus.rewind(fresh);
                queue.into_iter().for_each(|queue| bus.resize(fresh, queue));
                let idle = subscriptions.swap_remove(place);
                bus.unsubscribe(idle);
            }
        }
        // Those that nobody asked for again are released, with what they have lost, when the body is given back.
        self.part.kept.append(&mut subscriptions);
        for topic in publishers {
            bus.unpublish(topic);
        }
        self.part.held = false;
        // What its destructor does says nothing about its successor.
        let _ = contained(|| drop(instance));
    }

    /// The change is not made: nothing of the new instance stays.
    pub(super) fn give_back(&mut self, bus: &mut Bus, predecessor: Predecessor) {
        self.discard();
        self.instance = Some(predecessor.instance);
        let part = &mut self.part;
        part.publishers.drain(..).for_each(|topic| bus.unpublish(topic));
        for subscription in part.subscriptions.drain(..).chain(part.kept.drain(..)) {
            bus.unsubscribe(subscription);
        }
        part.outbox.clear();
        part.vote = None;
        part.held = false;
        let Ties { spec, publishers, subscriptions, recorder } = predecessor.ties;
        (part.spec, part.publishers) = (spec, publishers);
        (part.subscriptions, part.recorder) = (subscriptions, recorder);
        self.inboxes.clear();
        self.inboxes.resize_with(self.part.subscriptions.len(), Vec::new);
    }
}

impl Ties {
    /// Takes those of the present instance; a new one finds this specification.
    fn take(part: &mut Part, spec: Arc<ComponentSpec>) -> Ties {
        Ties {
            spec: std::mem::replace(&mut part.spec, spec),
            publishers: std::mem::take(&mut part.publishers),
            subscriptions: std::mem::take(&mut part.subscriptions),
            recorder: std::mem::take(&mut part.recorder),
        }
    }
}
