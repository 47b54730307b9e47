//! A component of a new build takes the place of the one that runs.

use std::fmt;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use saoms_api::contain::contained;
use saoms_api::{DynComponent, Failure, Saved};

use super::body::{Body, Part};
use super::engine::{Engine, Phase};
use super::lifecycle::Request;
use super::shared::Shared;
use super::slot::{NEVER, State};
use crate::bus::{Subscription, TopicId};
use crate::journal::Recorder;
use crate::observe::Occurrence;
use saoms_lang::assembly::ComponentSpec;

/// What became of a component whose class was built anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Replacement {
    /// The new one runs, and goes on where the earlier one was.
    Continued,
    /// The new one runs, from the beginning.
    Began,
    /// It did not run. The new build is for when it is scheduled the next time; one that had failed is scheduled now.
    Awaited,
}

/// Why a component was not replaced. The earlier one goes on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReplaceError {
    /// It cannot be replaced now, and may be later: its code runs, or it said so.
    NotNow(String),
    /// The new one does not come to be, or cannot go on where the earlier one was.
    Failed(Failure),
}

impl fmt::Display for ReplaceError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReplaceError::NotNow(why) => formatter.write_str(why),
            ReplaceError::Failed(failure) => failure.fmt(formatter),
        }
    }
}

impl std::error::Error for ReplaceError {}

/// How long to wait for code that runs.
const WAIT: Duration = Duration::from_millis(500);

/// Replaces a component. All of it happens on the caller's thread: the component is out of the engine meanwhile, as one that serves a call.
pub(super) fn replace(
    shared: &Arc<Shared>,
    index: u32,
    spec: ComponentSpec,
) -> Result<Replacement, ReplaceError> {
    let construct = || contained(|| spec.class.construct(&spec.values))?;
    let successor = construct().map_err(ReplaceError::Failed)?;
    let deadline = Instant::now() + WAIT;
    let mut body = loop {
        let mut engine = shared.lock();
        if engine.phase != Phase::Running {
            return Err(ReplaceError::Failed(Failure::new("the run ends")));
        }
        let slot = &mut engine.slots[index as usize];
        let Some(mut body) = slot.body.take() else {
            shared.release(engine);
            if Instant::now() >= deadline {
                return Err(ReplaceError::NotNow("its code has not returned yet".to_owned()));
            }
            thread::sleep(Duration::from_millis(1));
            continue;
        };
        if slot.state == State::Active {
            engine.out += 1;
            shared.release(engine);
            break body;
        }
        let failed = slot.state == State::Failed;
        body.part.spec = Some(Box::new(spec));
        slot.body = Some(body);
        if failed {
            engine.request(index, Request::Schedule { lasting: NEVER }, shared.clock.now());
        }
        shared.release(engine);
        return Ok(Replacement::Awaited);
    };
    let now = shared.clock.now();
    (body.part.now, body.part.due) = (now, now);
    let result = body.replace(shared, successor, Box::new(spec));
    let now = shared.clock.now();
    let mut engine = shared.lock();
    engine.finish_replace(index, body, &result, now);
    shared.release(engine);
    result
}

impl Body {
    /// Lets a new component go on where the present one is; that one stays after an error.
    fn replace(
        &mut self,
        shared: &Arc<Shared>,
        successor: Box<dyn DynComponent>,
        spec: Box<ComponentSpec>,
    ) -> Result<Replacement, ReplaceError> {
        let Some(present) = &mut self.instance else {
            return Err(ReplaceError::NotNow("it has just ended".to_owned()));
        };
        let saved = contained(|| present.save()).map_err(ReplaceError::Failed)?;
        let saved = saved.map_err(|failure| ReplaceError::NotNow(failure.to_string()))?;
        let before = Ties::take(&mut self.part, spec);
        let predecessor = self.instance.replace(successor);
        let result = self.take_over(shared, &saved);
        match &result {
            Ok(()) => {
                self.part.inherit(shared, before);
                self.inboxes.clear();
                self.inboxes.resize_with(self.part.subscriptions.len(), Vec::new);
                // What its destructor does says nothing about its successor.
                let _ = contained(|| drop(predecessor));
            }
            Err(_) => {
                self.discard();
                self.instance = predecessor;
                self.part.go_back(shared, before);
            }
        }
        let done = if saved.is_nothing() { Replacement::Began } else { Replacement::Continued };
        result.map(|()| done).map_err(ReplaceError::Failed)
    }

    fn take_over(&mut self, shared: &Arc<Shared>, saved: &Saved) -> Result<(), Failure> {
        let inboxes = std::mem::take(&mut self.inboxes);
        self.part.initializing = true;
        let result = self.call(shared, |instance, context| {
            instance.initialize(context)?;
            if saved.is_nothing() { Ok(()) } else { instance.restore(saved) }
        });
        self.part.initializing = false;
        self.inboxes = inboxes;
        result?
    }
}

/// What ties an instance to the fleet.
struct Ties {
    spec: Option<Box<ComponentSpec>>,
    publishers: Vec<TopicId>,
    subscriptions: Vec<Subscription>,
    recorder: Recorder,
}

impl Ties {
    /// Takes those of the present instance; a new one finds this specification.
    fn take(part: &mut Part, spec: Box<ComponentSpec>) -> Ties {
        Ties {
            spec: part.spec.replace(spec),
            publishers: std::mem::take(&mut part.publishers),
            subscriptions: std::mem::take(&mut part.subscriptions),
            recorder: std::mem::take(&mut part.recorder),
        }
    }
}

impl Part {
    /// The new instance reads on where the earlier one was; what that one had beside is given up.
    fn inherit(&mut self, shared: &Shared, before: Ties) {
        let mut engine = shared.lock();
        let Ties { publishers, mut subscriptions, .. } = before;
        for fresh in &mut self.subscriptions {
            let topic = engine.bus.topic_of(fresh);
            if let Some(place) = subscriptions.iter().position(|old| engine.bus.topic_of(old) == topic) {
                std::mem::swap(fresh, &mut subscriptions[place]);
                engine.bus.rewind(fresh);
                let idle = subscriptions.swap_remove(place);
                engine.bus.unsubscribe(idle);
            }
        }
        // Those that nobody asked for again are released, with what they have lost, when the body is given back.
        self.kept.append(&mut subscriptions);
        for topic in publishers {
            engine.bus.unpublish(topic);
        }
    }

    /// Nothing of the new instance stays.
    fn go_back(&mut self, shared: &Shared, before: Ties) {
        let mut engine = shared.lock();
        for topic in self.publishers.drain(..) {
            engine.bus.unpublish(topic);
        }
        for subscription in self.subscriptions.drain(..) {
            engine.bus.unsubscribe(subscription);
        }
        self.outbox.clear();
        self.vote = None;
        let Ties { spec, publishers, subscriptions, recorder } = before;
        (self.spec, self.publishers) = (spec, publishers);
        (self.subscriptions, self.recorder) = (subscriptions, recorder);
    }
}

impl Engine {
    /// Gives the body back.
    fn finish_replace(
        &mut self,
        index: u32,
        mut body: Box<Body>,
        result: &Result<Replacement, ReplaceError>,
        now: u64,
    ) {
        if self.is_abandoned(index) {
            std::mem::forget(body);
            return;
        }
        self.came_back();
        self.release(index, &mut body, now);
        self.deliver(&mut body.part, now);
        let vote = body.part.vote.take();
        let slot = &mut self.slots[index as usize];
        slot.body = Some(body);
        if let Ok(done) = result {
            slot.statistics.replaced += 1;
            let continued = *done == Replacement::Continued;
            self.tell(now, index, Occurrence::Replaced { continued });
        }
        if let Some(vote) = vote {
            self.vote(index, vote, now);
        }
        self.resume(index, now);
    }
}
