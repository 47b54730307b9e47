//! Effects outside of the program, such as moves of hardware: with a memory, one begins once it is committed that its
//! caller wants it. So a program that goes on after a crash knows of each that may have begun.

use std::any::Any;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use saoms_api::CallError;
use saoms_api::extension::ServiceEffects;
use saoms_api::host::{Operation, ServiceCall};
use saoms_lang::assembly::Wire;

use super::call::call_now;
use super::part::Part;
use crate::schedule::shared::Shared;

/// The effects that a component wants and that have not begun.
#[derive(Debug, Default)]
pub(crate) struct Effects {
    /// By the handles of the references.
    waiting: Vec<Effect>,
    has_new: bool,
}

#[derive(Debug)]
struct Effect {
    handle: u32,
    arguments: Vec<u8>,
    /// The cut in which its caller wants it; `None` before the present execution has ended.
    cut: Option<u64>,
}

impl Effects {
    /// True if the present execution wants one.
    #[inline]
    pub(crate) fn has_new(&self) -> bool {
        self.has_new
    }

    /// Notes in which cut those of the execution that has ended are wanted.
    pub(crate) fn note_cut(&mut self, cut: u64) {
        self.has_new = false;
        self.waiting.iter_mut().filter(|one| one.cut.is_none()).for_each(|one| one.cut = Some(cut));
    }

    /// Forgets those of an execution that failed.
    pub(crate) fn forget_new(&mut self) {
        self.has_new = false;
        self.waiting.retain(|one| one.cut.is_some());
    }

    fn take(&mut self, handle: u32) -> Option<Effect> {
        let place = self.waiting.iter().position(|one| one.handle == handle)?;
        Some(self.waiting.swap_remove(place))
    }
}

/// The effects that the target of a reference has outside of what the memory of this program goes back to.
pub(super) fn effects_of(shared: &Shared, wire: &Wire, number: usize) -> Option<&'static ServiceEffects> {
    shared.store.get()?;
    let effects = ServiceEffects::of(&wire.interface)?;
    let Some(target) = wire.targets.get(number) else { return Some(effects) };
    // What is simulated goes back with its caller.
    let is_remembered = shared.look(|engine| {
        let slot = engine.slots.get(target.component);
        slot.is_some_and(|slot| {
            let declared = slot.spec.class.declaration();
            declared.saves && !declared.stops
        })
    });
    (!is_remembered).then_some(effects)
}

/// Serves a call of a service with effects; `None` if it is a usual call.
pub(super) fn serve(
    shared: &Arc<Shared>,
    caller: &mut Part,
    reference: u32,
    effects: &ServiceEffects,
    call: &mut dyn ServiceCall,
) -> Option<Result<(), CallError>> {
    let operation = call.operation();
    if operation == effects.begin {
        caller.effects.take(reference);
        caller.effects.waiting.push(Effect { handle: reference, arguments: call.arguments(), cut: None });
        caller.effects.has_new = true;
        return Some(call.reply(&(effects.waiting)()));
    }
    if effects.end.contains(&operation) {
        caller.effects.take(reference);
        return None;
    }
    if operation != effects.poll {
        return None;
    }
    let effect = caller.effects.take(reference)?;
    if caller.emergency.load(Ordering::Relaxed) {
        return Some(call.reply(&(effects.failed)()));
    }
    let is_committed = |cut| shared.look(|engine| engine.memory.is_committed(cut));
    if !effect.cut.is_some_and(is_committed) {
        caller.effects.waiting.push(effect);
        return Some(call.reply(&(effects.waiting)()));
    }
    let arguments = effect.arguments.clone();
    let mut begin = BytesCall { operation: effects.begin, arguments, reply: Vec::new() };
    Some(match call_now(shared, caller, reference, &mut begin) {
        Ok(()) => call.reply(&begin.reply),
        Err(error @ (CallError::Busy { .. } | CallError::NotRunning { .. })) => {
            caller.effects.waiting.push(effect);
            Err(error)
        }
        Err(error) => Err(error),
    })
}

/// A call whose arguments and reply are bytes.
struct BytesCall {
    operation: Operation,
    arguments: Vec<u8>,
    reply: Vec<u8>,
}

impl ServiceCall for BytesCall {
    fn operation(&self) -> Operation {
        self.operation
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        None
    }

    fn arguments(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.arguments)
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        self.reply = bytes.to_vec();
        Ok(())
    }
}
