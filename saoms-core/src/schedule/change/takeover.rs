use std::sync::Arc;

use saoms_api::host::contain::contained;
use saoms_api::host::{DynComponent, SharedMessage};
use saoms_api::{Failure, Saved};
use saoms_lang::assembly::ComponentSpec;

use super::apart::{Unreturned, drop_apart, within, within_member};
use crate::bus::{Bus, TopicId, TopicReader};
use crate::journal::Recorder;
use crate::schedule::component::body::Body;
use crate::schedule::component::estate::Estate;
use crate::schedule::component::lasting::Lasting;
use crate::schedule::component::library::with_library;
use crate::schedule::component::part::Part;
use crate::schedule::shared::Shared;
use crate::schedule::stop::RegisteredStop;

/// The reason of a takeover from an instance that is gone.
const ENDED: &str = "it has just ended";

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

/// The earlier instance of a takeover and its outcome, or why it was refused.
pub(crate) type TakenOver = Result<(Predecessor, Takeover), Refusal>;

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

/// Topics and subscriptions of an instance, and what was left to it.
struct Endpoints {
    spec: Arc<ComponentSpec>,
    estate: Estate,
    publishers: Vec<TopicId>,
    subscriptions: Vec<TopicReader>,
    recorder: Recorder,
}

/// An instance that is no part of the fleet any more, with its functions that stop hardware. Its destructor and theirs
/// are the component's code, which may not return.
pub(crate) struct Outgoing {
    instance: Option<Box<dyn DynComponent>>,
    stops: Vec<Arc<RegisteredStop>>,
    name: Arc<str>,
}

impl Outgoing {
    /// The path of its component.
    pub(super) fn name(&self) -> &str {
        &self.name
    }
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
    /// its state, and the new one initializes and restores it. After an error the present one stays; its body comes
    /// back later where its own code has not returned.
    pub(crate) fn take_over(
        self: Box<Body>,
        shared: &Arc<Shared>,
        spec: Arc<ComponentSpec>,
        estate: Estate,
    ) -> (Option<Box<Body>>, TakenOver) {
        let mut successor = self.successor(spec);
        successor.part.estate = estate;
        let construct = |body: &mut Body, _: &Arc<Shared>| body.construct();
        let successor = match successor.of_new(("the constructor", false), shared, construct) {
            Ok(successor) => successor,
            Err(failure) => return (Some(self), Err(Refusal::Failed(failure))),
        };
        if self.instance.is_none() {
            successor.withdraw(shared);
            return (Some(self), Err(Refusal::NotNow(ENDED.to_owned())));
        }
        let (mut present, saved) = match self.saved(shared) {
            (Some(present), Ok(saved)) => (present, saved),
            (present, refused) => {
                successor.withdraw(shared);
                return (present, Err(refused.err().unwrap_or_else(|| Refusal::NotNow(ENDED.to_owned()))));
            }
        };
        let result = present.give_over(successor, Arc::new(saved), shared);
        (Some(present), result)
    }

    /// The state that the present instance saves.
    fn saved(self: Box<Body>, shared: &Arc<Shared>) -> (Option<Box<Body>>, Result<Saved, Refusal>) {
        let save = |body: &mut Body, _: &Arc<Shared>| match &mut body.instance {
            Some(present) => contained(|| present.save()),
            None => Ok(Err(Failure::new(ENDED))),
        };
        let goes_on = |body: Box<Body>, _: Result<Result<Saved, Failure>, Failure>, shared: &Arc<Shared>| {
            let mut engine = shared.lock();
            engine.return_unchanged(body.part.index, body, shared.clock.now());
            shared.release(engine);
        };
        match within_member(shared, ("`save`", shared.settings.grace), self, save, goes_on) {
            Ok((body, Ok(Ok(saved)))) => (Some(body), Ok(saved)),
            Ok((body, Ok(Err(not_now)))) => {
                let why = with_library(&body.part.spec, not_now);
                (Some(body), Err(Refusal::NotNow(why)))
            }
            Ok((body, Err(panic))) => (Some(body), Err(Refusal::Failed(panic))),
            Err(Unreturned { body, failure }) => (body, Err(Refusal::NotNow(failure.message().to_owned()))),
        }
    }

    /// Lets a new instance begin from the state of the present one, and take its place.
    fn give_over(&mut self, successor: Box<Body>, saved: Arc<Saved>, shared: &Arc<Shared>) -> TakenOver {
        let is_nothing = saved.is_nothing();
        let begin = move |body: &mut Body, shared: &Arc<Shared>| body.begin_instead(shared, &saved);
        let mut successor =
            successor.of_new(("`initialize` or `restore`", true), shared, begin).map_err(Refusal::Failed)?;
        let endpoints = Endpoints::take(&mut self.part, &mut successor.part);
        let (Some(instance), new) = (self.instance.take(), successor.instance.take()) else {
            return Err(Refusal::NotNow(ENDED.to_owned()));
        };
        self.instance = new;
        self.part.note_replacement(shared);
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

    /// Runs code of a new instance within the time that components have to end. One whose code fails, or does not
    /// return, is no part of the fleet. `moves` says whether the code may move hardware.
    fn of_new(
        self: Box<Body>,
        (what, moves): (&str, bool),
        shared: &Arc<Shared>,
        code: impl FnOnce(&mut Body, &Arc<Shared>) -> Result<(), Failure> + Send + 'static,
    ) -> Result<Box<Body>, Failure> {
        let (index, mut body) = (self.part.index, self);
        let apart = shared.lock().goes_apart(&mut body);
        let late = |body: Box<Body>, _: Result<(), Failure>, shared: &Arc<Shared>| body.end_late(shared);
        match within(shared, (what, shared.settings.grace), body, code, late) {
            Ok((mut body, result)) => {
                shared.lock().returns_from_apart(&mut body);
                match result {
                    Ok(()) => Ok(body),
                    Err(failure) => {
                        body.withdraw(shared);
                        Err(failure)
                    }
                }
            }
            Err(Unreturned { body: Some(body), failure }) => {
                body.withdraw(shared);
                Err(failure)
            }
            Err(Unreturned { body: None, failure }) => {
                let mut engine = shared.lock();
                engine.take_off(apart);
                if moves {
                    // It may have moved hardware already, which is that of the present one, too.
                    engine.stops.request_of(index);
                }
                shared.release(engine);
                Err(failure)
            }
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
    pub(super) fn withdraw(mut self: Box<Body>, shared: &Shared) {
        self.leave_bus(shared);
        let (instance, stops) = (self.instance.take(), std::mem::take(&mut self.part.stops));
        if instance.is_some() || !stops.is_empty() {
            let name = Arc::clone(&self.part.name);
            drop_apart(shared, vec![Outgoing { instance, stops, name }]);
        }
    }

    /// The same on a thread that was left behind, once its code has returned. Its hardware is stopped before, unless
    /// another instance moves that by now: it was stopped when the code was left behind.
    pub(in crate::schedule) fn end_late(mut self: Box<Body>, shared: &Shared) {
        if !shared.look(|engine| engine.has_other_instance(&self.part)) {
            shared.stops.request(&self.part.stops);
        }
        self.leave_bus(shared);
        self.discard();
    }

    /// Takes it off all topics, unless that was done when it was left behind.
    fn leave_bus(&mut self, shared: &Shared) {
        let mut engine = shared.lock();
        let is_there = engine.returns_from_apart(self);
        let part = &mut self.part;
        for topic in part.publishers.drain(..).filter(|_| is_there) {
            engine.bus.unpublish(topic);
        }
        for reader in part.subscriptions.drain(..).chain(part.kept.drain(..)).filter(|_| is_there) {
            let topic = engine.bus.topic_of(&reader);
            engine.bus.unsubscribe(reader);
            engine.tell_interest(topic);
        }
        shared.release(engine);
    }

    /// Commits the takeover: the new instance gets the read positions of the earlier one, with the regions that it has
    /// set; its other subscriptions are released. The earlier one is given back, to be dropped where nobody waits for
    /// it.
    pub(crate) fn inherit(&mut self, bus: &mut Bus, predecessor: Predecessor) -> Outgoing {
        // The hardware goes on: it is the new instance that stops it from now on.
        let Predecessor { instance, endpoints, stops, inboxes } = predecessor;
        let Endpoints { publishers, mut subscriptions, .. } = endpoints;
        self.part.lasting.take_unread(inboxes, subscriptions.iter().map(|reader| bus.topic_of(reader)));
        let queue = self.part.spec.task.as_ref().map(|task| task.queue);
        for fresh in &mut self.part.subscriptions {
            let topic = bus.topic_of(fresh);
            if let Some(place) = subscriptions.iter().position(|old| bus.topic_of(old) == topic) {
                let region = bus.region(fresh);
                std::mem::swap(fresh, &mut subscriptions[place]);
                if region.is_some() {
                    bus.set_region(fresh, region, queue.unwrap_or(Some(1)));
                }
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
        Outgoing { instance: Some(instance), stops, name: Arc::clone(&self.part.name) }
    }

    /// Undoes the takeover. The new instance is given back, to be dropped where nobody waits for it.
    pub(crate) fn give_back(&mut self, bus: &mut Bus, predecessor: Predecessor) -> Outgoing {
        let part = &mut self.part;
        let stops = std::mem::replace(&mut part.stops, predecessor.stops);
        let (instance, name) = (self.instance.replace(predecessor.instance), Arc::clone(&part.name));
        let outgoing = Outgoing { instance, stops, name };
        part.publishers.drain(..).for_each(|topic| bus.unpublish(topic));
        for subscription in part.subscriptions.drain(..).chain(part.kept.drain(..)) {
            bus.unsubscribe(subscription);
        }
        part.outbox.clear();
        part.to_keep.clear();
        part.vote = None;
        part.collection.reset();
        part.held = false;
        let Endpoints { spec, estate, publishers, subscriptions, recorder } = predecessor.endpoints;
        (part.spec, part.estate, part.publishers) = (spec, estate, publishers);
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
            estate: std::mem::replace(&mut part.estate, std::mem::take(&mut successor.estate)),
            publishers: std::mem::replace(&mut part.publishers, std::mem::take(&mut successor.publishers)),
            subscriptions: std::mem::replace(&mut part.subscriptions, std::mem::take(&mut successor.subscriptions)),
            recorder: std::mem::replace(&mut part.recorder, std::mem::take(&mut successor.recorder)),
        }
    }
}
