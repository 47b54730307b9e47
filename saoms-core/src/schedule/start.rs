use std::fmt;
use std::io;
use std::sync::Arc;

use saoms_api::Failure;

use super::body::Job;
use super::engine::{Engine, Phase};
use super::realtime::RealtimeError;
use super::shared::Shared;
use super::slot::{State, Wish};
use super::trace::Step;
use crate::assemble::Plan;
use crate::observe::Occurrence;
use saoms_lang::assembly::Assembly;

/// Why a fleet did not start. Nothing of it runs.
#[derive(Debug)]
#[non_exhaustive]
pub enum StartError {
    /// A component could not be constructed or initialized. Those that were initialized before it have been shut down.
    Component {
        /// Its path in the composite.
        component: String,
        /// Its class.
        class: String,
        /// Why, in its own words.
        failure: Failure,
    },
    /// Real-time scheduling was asked for and is not permitted.
    Realtime(RealtimeError),
    /// An observer of the run cannot do its work.
    Observer(Failure),
    /// The system gives no thread.
    Thread(io::Error),
}

impl fmt::Display for StartError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StartError::Component { component, class, failure } => {
                write!(formatter, "component `{component}` of class `{class}` could not start: {failure}")
            }
            StartError::Realtime(error) => error.fmt(formatter),
            StartError::Observer(failure) => failure.fmt(formatter),
            StartError::Thread(error) => {
                write!(formatter, "the system gives no thread to run the fleet on: {error}")
            }
        }
    }
}

impl std::error::Error for StartError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            StartError::Component { .. } | StartError::Observer(_) => None,
            StartError::Realtime(error) => Some(error),
            StartError::Thread(error) => Some(error),
        }
    }
}

/// Brings the fleet from nothing to its assembly: either every component that runs from the start has initialized, or none is left.
pub(super) fn start(shared: &Arc<Shared>) -> Result<(), StartError> {
    let plan = Plan::between(&Assembly::default(), &shared.assembly);
    let mut begun = Vec::new();
    for place in plan.add {
        let index = place as u32;
        if !shared.lock().slots[place].policy.on_startup {
            continue;
        }
        if let Err((culprit, failure)) = initialize(shared, index) {
            for earlier in begun.into_iter().rev() {
                take_back(shared, earlier);
            }
            let spec = shared.spec(culprit);
            let (component, class) = (spec.path.clone(), spec.class.name().to_owned());
            return Err(StartError::Component { component, class, failure });
        }
        begun.push(index);
    }
    shared.clock.start();
    let mut engine = shared.lock();
    engine.commit();
    shared.release(engine);
    Ok(())
}

/// Constructs and initializes a component. What it sends is held back. A failure may be that of a provider which it called.
fn initialize(shared: &Arc<Shared>, index: u32) -> Result<(), (u32, Failure)> {
    let mut engine = shared.lock();
    engine.slots[index as usize].state = State::Starting;
    let Some(mut body) = engine.begin(index, Job::Start, 0) else {
        return Err((index, Failure::new("it is in use")));
    };
    shared.release(engine);
    let result = body.perform(shared, Job::Start);
    let mut engine = shared.lock();
    let result = match result {
        Ok(()) => {
            engine.finish(index, body, Job::Start, Ok(()), 0, 0);
            // A failure in this phase can only be that of a component that was called.
            match engine.reasons.pop() {
                None => Ok(()),
                Some(reason) => {
                    let culprit = engine.slots.iter().position(|slot| slot.state == State::Failed);
                    Err((culprit.unwrap_or(index as usize) as u32, Failure::new(reason)))
                }
            }
        }
        Err(failure) => {
            engine.out -= 1;
            let slot = &mut engine.slots[index as usize];
            slot.state = State::Failed;
            slot.body = Some(body);
            Err((index, failure))
        }
    };
    shared.release(engine);
    result
}

/// Shuts down a component of a fleet that does not start after all.
fn take_back(shared: &Arc<Shared>, index: u32) {
    let mut engine = shared.lock();
    if engine.slots[index as usize].state != State::Active {
        return;
    }
    let Some(mut body) = engine.begin(index, Job::Shutdown, 0) else { return };
    shared.release(engine);
    let result = body.perform(shared, Job::Shutdown);
    let mut engine = shared.lock();
    engine.out -= 1;
    body.part.outbox.clear();
    if let Err(failure) = result {
        let message = format!("could not shut down: {failure}");
        engine.tell(0, index, Occurrence::Failed { message, restart: None });
    }
    let slot = &mut engine.slots[index as usize];
    slot.state = State::Idle;
    slot.body = Some(body);
    shared.release(engine);
}

impl Engine {
    /// All have initialized: what they sent leaves, and time begins.
    fn commit(&mut self) {
        self.phase = Phase::Running;
        // The timer sleeps without a term so far; where nobody is due, the end of the run still is.
        self.wake = true;
        for index in 0..self.slots.len() as u32 {
            let slot = &mut self.slots[index as usize];
            let Some(mut body) = slot.body.take_if(|_| slot.state == State::Active) else { continue };
            self.deliver(&mut body.part, 0);
            self.step(0, index, Step::Started);
            self.tell(0, index, Occurrence::Started);
            let slot = &mut self.slots[index as usize];
            slot.body = Some(body);
            if slot.policy.periodic {
                slot.due = slot.policy.delay;
                let when = slot.due.min(slot.until);
                match slot.wish {
                    Wish::None => self.enqueue(index, when),
                    Wish::Leave | Wish::Return { .. } => self.resume(index, 0),
                }
            }
        }
        self.end_if_done(0);
    }
}
