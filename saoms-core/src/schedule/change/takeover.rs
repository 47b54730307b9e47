use std::sync::{Arc, mpsc};
use std::thread;

use saoms_api::host::contain::contained;
use saoms_api::host::{DynComponent, SharedMessage, format_duration};
use saoms_api::{Failure, Saved};
use saoms_lang::assembly::ComponentSpec;

use crate::bus::{Bus, TopicId, TopicReader};
use crate::journal::Recorder;
use crate::schedule::component::body::{Body, Part};
use crate::schedule::component::lasting::Lasting;
use crate::schedule::component::library::with_library;
use crate::schedule::shared::Shared;
use crate::schedule::stop::RegisteredStop;

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
    stops: Vec<Arc<RegisteredStop>>,
    /// Events of executions that were skipped, by subscription; and those of reactions.
    inboxes: [Vec<Vec<SharedMessage>>; 2],
}

/// Topics and subscriptions of an instance.
struct Endpoints {
    spec: Arc<ComponentSpec>,
    publishers: Vec<TopicId>,
    subscriptions: Vec<TopicReader>,
    recorder: Recorder,
}

/// An instance that is no part of the fleet any more, with its functions that stop hardware. Its destructor and theirs
/// are the component's code, which may not return.
pub(crate) struct Outgoing {
    instance: Option<Box<dyn DynComponent>>,
    stops: Vec<Arc<RegisteredStop>>,
}

impl Drop for Outgoing {
    fn drop(&mut self) {
        let (instance, stops) = (self.instance.take(), std::mem::take(&mut self.stops));
        // A panic of its destructor does not concern its successor.
        let _ = contained(|| drop(instance));
        stops.into_iter().for_each(RegisteredStop::release_here);
    }
}

impl Body {
    /// Replaces the present instance: the new one is constructed, the present one [saves](saoms_api::Component::save)
    /// its state, and the new one initializes and restores it. After an error the present one stays.
    pub(crate) fn take_over(
        &mut self,
        shared: &Arc<Shared>,
        spec: Arc<ComponentSpec>,
    ) -> Result<(Predecessor, Takeover), Refusal> {
        let successor = self.successor(spec);
        let construct = |body: &mut Body, _: &Arc<Shared>| body.construct();
        let mut successor = successor.within(shared, "the constructor", construct).map_err(Refusal::Failed)?;
        let Some(present) = &mut self.instance else {
            return Err(Refusal::NotNow("it has just ended".to_owned()));
        };
        let saved = match contained(|| present.save()) {
            Ok(Ok(saved)) => saved,
            refused => {
                successor.withdraw(shared);
                return Err(refused.map_or_else(Refusal::Failed, |not_now| {
                    let spec = &self.part.spec;
                    Refusal::NotNow(not_now.err().map(|failure| with_library(spec, failure)).unwrap_or_default())
                }));
            }
        };
        let (is_nothing, saved) = (saved.is_nothing(), Arc::new(saved));
        let begin = move |body: &mut Body, shared: &Arc<Shared>| body.begin_instead(shared, &saved);
        successor = successor.within(shared, "`initialize` or `restore`", begin).map_err(Refusal::Failed)?;
        let endpoints = Endpoints::take(&mut self.part, &mut successor.part);
        let (Some(instance), new) = (self.instance.take(), successor.instance.take()) else {
            return Err(Refusal::NotNow("it has just ended".to_owned()));
        };
        self.instance = new;
        let inboxes = [std::mem::take(&mut self.inboxes), std::mem::take(&mut self.reactions)];
        self.fit_inboxes();
        let takeover = if is_nothing { Takeover::Began } else { Takeover::Continued };
        let stops = std::mem::replace(&mut self.part.stops, std::mem::take(&mut successor.part.stops));
        Ok((Predecessor { instance, endpoints, stops, inboxes }, takeover))
    }

    /// The body of a new instance, apart from that of the present one, which goes on if the new one never returns.
    fn successor(&self, spec: Arc<ComponentSpec>) -> Box<Body> {
        let part = &self.part;
        let mut body = Body::new(part.index, spec, Arc::clone(&part.name), part.period, Arc::clone(&part.cancelled));
        body.part.emergency = Arc::clone(&part.emergency);
        body.part.chance = part.chance.clone();
        body.part.stored = part.stored.clone();
        (body.part.now, body.part.due, body.part.execution) = (part.now, part.due, part.execution);
        Box::new(body)
    }

    /// Runs code of a new instance on a thread of its own, and gives it back if it returns within the time that
    /// components have to end. Otherwise the thread is left behind with it.
    fn within(
        mut self: Box<Body>,
        shared: &Arc<Shared>,
        what: &str,
        code: impl FnOnce(&mut Body, &Arc<Shared>) -> Result<(), Failure> + Send + 'static,
    ) -> Result<Box<Body>, Failure> {
        let (sender, receiver) = mpsc::channel();
        let apart = Arc::clone(shared);
        let run = move || {
            let result = code(&mut self, &apart);
            if let Err(mpsc::SendError((body, _))) = sender.send((self, result)) {
                body.withdraw(&apart);
            }
        };
        thread::Builder::new()
            .name("saoms-change".to_owned())
            .spawn(run)
            .map_err(|error| Failure::new(format!("the system cannot create a thread: {error}")))?;
        let limit = shared.settings.grace;
        match receiver.recv_timeout(limit) {
            Ok((body, Ok(()))) => Ok(body),
            Ok((body, Err(failure))) => {
                body.withdraw(shared);
                Err(failure)
            }
            Err(_) => Err(Failure::new(format!("{what} has not returned within {}", format_duration(limit)))),
        }
    }

    fn begin_instead(&mut self, shared: &Arc<Shared>, saved: &Saved) -> Result<(), Failure> {
        self.part.initializing = true;
        self.part.lasting = Lasting::of_takeover(saved);
        let result = self.call(shared, |instance, context| {
            instance.initialize(context)?;
            if saved.is_nothing() { Ok(()) } else { instance.restore(saved) }
        });
        self.part.initializing = false;
        self.part.spent.is_within().and(result)??;
        self.part.has_registered_stop()
    }

    /// Drops a new instance that takes nothing over, with its topics.
    fn withdraw(mut self: Box<Body>, shared: &Shared) {
        self.discard();
        let bus = &mut shared.lock().bus;
        for topic in self.part.publishers {
            bus.unpublish(topic);
        }
        for subscription in self.part.subscriptions {
            bus.unsubscribe(subscription);
        }
    }

    /// Commits the takeover: the new instance gets the read positions of the earlier one; its other subscriptions are
    /// released. The earlier one is given back, to be dropped where nobody waits for it.
    pub(crate) fn inherit(&mut self, bus: &mut Bus, predecessor: Predecessor) -> Outgoing {
        // The hardware goes on: it is the new instance that stops it from now on.
        let Predecessor { instance, endpoints, stops, inboxes } = predecessor;
        let Endpoints { publishers, mut subscriptions, .. } = endpoints;
        self.part.lasting.take_unread(inboxes, subscriptions.iter().map(|reader| bus.topic_of(reader)));
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
        self.give_unread(bus);
        self.part.collection.reset();
        self.part.held = false;
        Outgoing { instance: Some(instance), stops }
    }

    /// Undoes the takeover. The new instance is given back, to be dropped where nobody waits for it.
    pub(crate) fn give_back(&mut self, bus: &mut Bus, predecessor: Predecessor) -> Outgoing {
        let part = &mut self.part;
        let stops = std::mem::replace(&mut part.stops, predecessor.stops);
        let outgoing = Outgoing { instance: self.instance.replace(predecessor.instance), stops };
        part.publishers.drain(..).for_each(|topic| bus.unpublish(topic));
        for subscription in part.subscriptions.drain(..).chain(part.kept.drain(..)) {
            bus.unsubscribe(subscription);
        }
        part.outbox.clear();
        part.to_keep.clear();
        part.vote = None;
        part.collection.reset();
        part.held = false;
        let Endpoints { spec, publishers, subscriptions, recorder } = predecessor.endpoints;
        (part.spec, part.publishers) = (spec, publishers);
        (part.subscriptions, part.recorder) = (subscriptions, recorder);
        [self.inboxes, self.reactions] = predecessor.inboxes;
        self.fit_inboxes();
        outgoing
    }
}

impl Endpoints {
    /// Takes the endpoints of the present instance, and sets those of its successor.
    fn take(part: &mut Part, successor: &mut Part) -> Endpoints {
        part.schemas.append(&mut successor.schemas);
        part.outbox.append(&mut successor.outbox);
        part.vote = successor.vote.take();
        part.to_keep = std::mem::take(&mut successor.to_keep);
        part.lasting.forget_state();
        part.chance = successor.chance.clone();
        part.held = true;
        part.collection.reset();
        Endpoints {
            spec: std::mem::replace(&mut part.spec, Arc::clone(&successor.spec)),
            publishers: std::mem::replace(&mut part.publishers, std::mem::take(&mut successor.publishers)),
            subscriptions: std::mem::replace(&mut part.subscriptions, std::mem::take(&mut successor.subscriptions)),
            recorder: std::mem::replace(&mut part.recorder, std::mem::take(&mut successor.recorder)),
        }
    }
}
