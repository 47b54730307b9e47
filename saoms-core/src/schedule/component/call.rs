use std::sync::Arc;

use saoms_api::host::TARGET_SHIFT;
use saoms_api::host::{Invocation, ServiceCall, cdr};
use saoms_api::{CallError, Failure};

use super::body::{Body, Job};
use super::effects;
use super::part::Part;
use super::remote::call_elsewhere;
use super::web::call_web;
use crate::schedule::engine::Engine;
use crate::schedule::engine::lifecycle::Request;
use crate::schedule::engine::slot::NEVER;
use crate::schedule::shared::Shared;

/// Greatest number of calls within each other: each takes some of the thread's stack.
const MAX_DEPTH: u32 = 64;

/// Calls through a reference of a component whose code runs on this thread. The provider's code runs on the same
/// thread, as in a function call: it is taken out of the engine meanwhile, and is busy for all others.
pub(crate) fn call(
    shared: &Arc<Shared>,
    caller: &mut Part,
    reference: u32,
    call: &mut dyn ServiceCall,
) -> Result<(), CallError> {
    if caller.apart.is_some() {
        shared.look(|engine| engine.may_call(caller))?;
    }
    let place = reference & ((1 << TARGET_SHIFT) - 1);
    let Some(wire) = caller.spec.references.get(place as usize) else {
        return Err(CallError::NotWired { reference: "(a handle that `Context::reference` did not give)".to_owned() });
    };
    let number = (reference >> TARGET_SHIFT) as usize;
    if let Some(effects) = effects::effects_of(shared, wire, number)
        && let Some(served) = effects::serve(shared, caller, reference, effects, call)
    {
        return served;
    }
    call_now(shared, caller, reference, call)
}

/// The same, at once.
pub(super) fn call_now(
    shared: &Arc<Shared>,
    caller: &mut Part,
    reference: u32,
    call: &mut dyn ServiceCall,
) -> Result<(), CallError> {
    let place = reference & ((1 << TARGET_SHIFT) - 1);
    let Some(wire) = caller.spec.references.get(place as usize) else {
        return Err(CallError::NotWired { reference: "(a handle that `Context::reference` did not give)".to_owned() });
    };
    let number = (reference >> TARGET_SHIFT) as usize;
    let Some(target) = wire.targets.get(number) else {
        let number = number - wire.targets.len();
        if let Some(target) = wire.elsewhere.get(number) {
            let (wire, target) = (wire.clone(), target.clone());
            return call_elsewhere(shared, caller, (&wire, &target), reference, call);
        }
        let Some(target) = wire.web.get(number - wire.elsewhere.len()) else {
            return Err(CallError::NotWired { reference: wire.reference.clone() });
        };
        return call_web(shared, caller, (target, wire.deadline), call);
    };
    let provider = target.component as u32;
    let mut engine = shared.lock();
    if engine.is_task_service(provider, &target.service) {
        drop(engine);
        return task(shared, caller, provider, call);
    }
    let mut body = engine.begin_call(provider, caller)?;
    body.part.call_depth = caller.call_depth + 1;
    shared.release(engine);
    let own = (body.part.now, body.part.due);
    (body.part.now, body.part.due) = (caller.now, caller.due);
    let cause = caller.recorder.cause();
    let result = body.serve(shared, &mut Invocation { service: &target.service, call }, cause);
    (body.part.now, body.part.due) = own;
    body.part.call_depth = 0;
    let (result, panic) = match result {
        Ok(result) => (result, None),
        Err(panic) => (Err(CallError::from(panic.clone())), Some(panic)),
    };
    let now = shared.clock.now();
    let mut engine = shared.lock();
    let name = Arc::clone(&body.part.name);
    if engine.is_left_behind(&body.part) && !engine.is_abandoned(provider) {
        shared.release(engine);
        body.end_late(shared);
    } else {
        engine.finish_call(provider, body, panic, now);
        shared.release(engine);
    }
    result.map_err(|error| named(error, &name))
}

/// Adds the provider's path to an error that lacks it.
fn named(error: CallError, name: &str) -> CallError {
    match error {
        CallError::Failed { provider, failure } if provider.is_empty() => {
            CallError::Failed { provider: name.to_owned(), failure }
        }
        other => other,
    }
}

/// Serves [`saoms_api::TaskInterface`], whose operations have the numbers of their places in the trait.
fn task(shared: &Shared, caller: &Part, provider: u32, call: &mut dyn ServiceCall) -> Result<(), CallError> {
    let operation = call.operation();
    let request = match operation {
        0 => Some(Request::Schedule { lasting: NEVER }),
        1 => {
            let milliseconds: u64 = cdr::decode(&call.arguments()).map_err(|error| CallError::Mismatch {
                message: format!("the arguments of `schedule_for`: {error}"),
            })?;
            Some(Request::Schedule { lasting: milliseconds.saturating_mul(1_000_000) })
        }
        2 => Some(Request::Unschedule),
        3 => None,
        other => {
            let message =
                format!("interface `unibg.robotics.tca.TaskInterface` has no operation with the number {other}");
            return Err(CallError::Mismatch { message });
        }
    };
    let now = if shared.clock.is_virtual() { caller.now } else { shared.clock.now() };
    let mut engine = shared.lock();
    let Some(request) = request else {
        let scheduled = engine.slots[provider as usize].is_scheduled();
        drop(engine);
        return call.reply(&cdr::encode(&scheduled));
    };
    engine.may_call(caller)?;
    engine.note_caller(caller.index);
    engine.request(provider, request, now);
    shared.release(engine);
    call.reply(&cdr::encode(&()))
}

impl Engine {
    /// True if it is the service that the host itself serves for every periodic component.
    fn is_task_service(&self, provider: u32, service: &str) -> bool {
        let declaration = self.slots[provider as usize].spec.class.declaration();
        declaration.offers().any(|offered| offered.name == service && offered.is_of_host())
    }

    /// Judges whether a component may call others.
    fn may_call(&self, caller: &Part) -> Result<(), CallError> {
        self.may_act(caller).map_err(|failure| CallError::Failed { provider: String::new(), failure })
    }

    /// Takes a component's body to serve a call. An instance that is not committed serves only others of the same
    /// change.
    fn begin_call(&mut self, index: u32, caller: &Part) -> Result<Box<Body>, CallError> {
        self.may_call(caller)?;
        let slot = &mut self.slots[index as usize];
        let provider = || slot.name.to_string();
        if caller.call_depth >= MAX_DEPTH {
            let failure = Failure::new(format!("it is the end of a chain of more than {MAX_DEPTH} calls"));
            return Err(CallError::Failed { provider: provider(), failure });
        }
        if !slot.is_alive() {
            return Err(CallError::NotRunning { provider: provider() });
        }
        let Some(mut body) = slot.body.take_if(|_| (caller.held || !slot.held) && caller.now >= slot.busy_until) else {
            return Err(CallError::Busy { provider: provider() });
        };
        self.slots[index as usize].out_since = self.begin_of_code(caller.now);
        self.out += 1;
        self.note_code(index, &mut body);
        self.note_caller(caller.index);
        Ok(body)
    }

    /// Gives the body back; messages sent in the call are delivered now.
    fn finish_call(&mut self, index: u32, mut body: Box<Body>, panic: Option<Failure>, now: u64) {
        if self.is_abandoned(index) {
            std::mem::forget(body);
            return;
        }
        self.note_return();
        self.slots[index as usize].memory.note_end_of_code();
        if let Some(failure) = panic {
            self.fail(index, &mut body, Job::Execute, &failure, now);
            self.slots[index as usize].body = Some(body);
            return;
        }
        self.note_saved(&body.part, false, now);
        if !body.part.held {
            self.deliver(&mut body.part, now);
        }
        let vote = body.part.vote.take_if(|_| !body.part.held);
        self.slots[index as usize].body = Some(body);
        if let Some(vote) = vote {
            self.vote(index, vote, now);
        }
        self.resume(index, now);
    }
}
