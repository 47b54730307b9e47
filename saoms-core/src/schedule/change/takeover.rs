use std::sync::Arc;

use saoms_api::host::DynComponent;
use saoms_api::host::contain::contained;
use saoms_api::{Failure, Saved};
use saoms_lang::assembly::ComponentSpec;

use crate::bus::{Bus, TopicId, TopicReader};
use crate::journal::Recorder;
use crate::schedule::component::body::{Body, Part};
use crate::schedule::shared::Shared;

/// The outcome of a replacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takeover {
    /// The new instance runs, with the restored state of the earlier one.
    Continued,
    /// The new instance runs, without the state of the earlier one.
    Began,
    /// The component did not run. The new instance starts when it is scheduled next; a component that had failed is
    /// scheduled now.
    Awaited,
}

/// Reasons of a takeover that was refused. The earlier instance continues.
#[derive(Debug)]
pub(crate) enum Refusal {
    /// It may be possible later.
    NotNow(String),
    /// The new instance cannot be constructed, initialized or restored.
    Failed(Failure),
}

/// The earlier instance after a takeover, kept until the change is committed.
pub(crate) struct Predecessor {
    instance: Box<dyn DynComponent>,
    endpoints: Endpoints,
}

/// Topics and subscriptions of an instance.
struct Endpoints {
    spec: Arc<ComponentSpec>,
    publishers: Vec<TopicId>,
    subscriptions: Vec<TopicReader>,
    recorder: Recorder,
}

impl Body {
    /// Replaces the present instance: the new one is constructed, the present one [saves](saoms_api::Component::save)
    /// its state, and the new one initializes and restores it. After an error the present one stays.
    pub(crate) fn take_over(
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
        let endpoints = Endpoints::take(&mut self.part, spec);
        let Some(instance) = self.instance.replace(successor) else {
            return Err(Refusal::NotNow("it has just ended".to_owned()));
        };
        let predecessor = Predecessor { instance, endpoints };
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

    /// Commits the takeover: the new instance gets the read positions of the earlier one; its other subscriptions are
    /// released.
    pub(crate) fn inherit(&mut self, bus: &mut Bus, predecessor: Predecessor) {
        let Predecessor { instance, endpoints } = predecessor;
        let Endpoints { publishers, mut subscriptions, .. } = endpoints;
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
        // Subscriptions that the new instance did not use are released, with their lost messages, when the body is
        // given back.
        self.part.kept.append(&mut subscriptions);
        for topic in publishers {
            bus.unpublish(topic);
        }
        self.part.held = false;
        // A panic of its destructor does not concern its successor.
        let _ = contained(|| drop(instance));
    }

    /// Undoes the takeover: the new instance is dropped.
    pub(crate) fn give_back(&mut self, bus: &mut Bus, predecessor: Predecessor) {
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
        let Endpoints { spec, publishers, subscriptions, recorder } = predecessor.endpoints;
        (part.spec, part.publishers) = (spec, publishers);
        (part.subscriptions, part.recorder) = (subscriptions, recorder);
        self.inboxes.clear();
        self.inboxes.resize_with(self.part.subscriptions.len(), Vec::new);
    }
}

impl Endpoints {
    /// Takes the endpoints of the present instance, and sets the specification of the new one.
    fn take(part: &mut Part, spec: Arc<ComponentSpec>) -> Endpoints {
        Endpoints {
            spec: std::mem::replace(&mut part.spec, spec),
            publishers: std::mem::take(&mut part.publishers),
            subscriptions: std::mem::take(&mut part.subscriptions),
            recorder: std::mem::take(&mut part.recorder),
        }
    }
}
