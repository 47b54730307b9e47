//! Calls of components of other programs, which components of this one serve.

use std::time::Duration;

use saoms_api::CallError;
use saoms_lang::assembly::RemoteTarget;
use saoms_lang::registry::InterfaceDeclaration;

use crate::hash::text_hash;
use crate::network::exchange::wire::{Request, STOP};
use crate::schedule::engine::{Engine, RunPhase};
use crate::schedule::order::RemoteCall;

/// The hash of an interface, which is the same in all programs that declare it alike.
pub(in crate::schedule) fn interface_hash(interface: &InterfaceDeclaration) -> u64 {
    text_hash(&format!("{} {}", interface.name, interface.operations))
}

impl Engine {
    /// Has a component serve a call of another program. Of a heartbeat, gives the component, and the time to the next
    /// one.
    pub(super) fn serve(&mut self, network: u8, request: Request, now: u64) -> Option<(u32, Duration)> {
        let provider = self.numbers.get(request.component.as_str()).copied();
        let provider = provider.filter(|number| self.slots[*number as usize].is_member());
        let caller = self.networks.elsewhere.hear(&request.caller);
        let Request { number, operation, left, .. } = request;
        let refusal = self.refusal(provider, caller, &request);
        if number == 0 {
            let period = Duration::from_nanos(left);
            return provider.filter(|_| refusal.is_none()).map(|provider| (provider, period));
        }
        let call = RemoteCall::new(network, request, caller, now);
        if provider.is_none() && self.phase == RunPhase::Starting {
            // A program joins its networks before all of its components are members: who calls puts the call again.
            self.leave_unserved(&call);
            return None;
        }
        let provider = match (provider, refusal) {
            (Some(provider), None) => provider,
            (_, refusal) => {
                self.reply_to(&call, Err(refusal?));
                return None;
            }
        };
        if operation == STOP {
            self.stops.request_of(provider);
            self.reply_to(&call, Ok(Vec::new()));
        } else if matches!(self.phase, RunPhase::Stopping | RunPhase::Ended) {
            let provider = self.slots[provider as usize].name.to_string();
            self.reply_to(&call, Err(CallError::NotRunning { provider }));
        } else {
            self.queue_call(provider, call);
        }
        None
    }

    /// Why a call is refused: the other program has another fleet, or other classes.
    fn refusal(&self, provider: Option<u32>, caller: u32, request: &Request) -> Option<CallError> {
        let Request { component, service, interface, caller: path, operation, number, .. } = request;
        let mismatch = |message: String| Some(CallError::Mismatch { message });
        let Some(slot) = provider.and_then(|provider| self.slots.get(provider as usize)) else {
            return mismatch(format!("component `{component}` is not in its program: run all nodes of one composite"));
        };
        let known = self.networks.elsewhere.get(caller).map(|(spec, _)| spec);
        let ends = known.iter().flat_map(|spec| &spec.references).flat_map(|wire| &wire.elsewhere);
        // A heartbeat names no service.
        let is_meant = |end: &RemoteTarget| end.component == *component && (*number == 0 || end.service == *service);
        if !ends.into_iter().any(is_meant) {
            return mismatch(format!(
                "component `{path}` is not wired to service `{service}` of component `{component}` in the composite of \
                 its program: run all nodes of one composite"
            ));
        }
        let declared = slot.spec.class.declaration().services.iter().find(|declared| declared.name == *service);
        let is_same = declared.is_some_and(|declared| interface_hash(&declared.interface) == *interface);
        if is_same || *operation == STOP || *number == 0 {
            return None;
        }
        let name = declared.map_or("", |declared| declared.interface.name.as_str());
        mismatch(format!(
            "the interface `{name}` differs: component `{path}` of node `{}` has another form of it than component \
             `{component}` of node `{}`; build both from one version",
            known.map_or("", |spec| &spec.node),
            slot.spec.node
        ))
    }

    /// A program gives no sign of life any more: the hardware is stopped that its components move.
    pub(super) fn stop_hardware_for(&mut self, program: &str) {
        if !self.stops.any() {
            return;
        }
        let gone = self.networks.elsewhere.specs().filter(|(_, spec)| spec.node == program);
        let moved = gone.flat_map(|(_, spec)| {
            let ends = spec.references.iter().flat_map(|wire| &wire.elsewhere);
            ends.filter_map(|end| self.numbers.get(end.component.as_str()).copied()).collect::<Vec<u32>>()
        });
        moved.collect::<Vec<u32>>().into_iter().for_each(|provider| self.stops.request_of(provider));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::FromRun;
    use crate::schedule::os::clock::Clock;
    use crate::schedule::settings::Settings;
    use crate::schedule::shared::Shared;

    #[test]
    fn a_call_of_a_component_that_is_not_there_yet_is_put_again() {
        let shared = Shared::new(Settings::default(), Clock::real(), Vec::new());
        let mut engine = shared.lock();
        let mut said = |phase: RunPhase| {
            engine.phase = phase;
            let request = Request { number: 1, component: "World".to_owned(), ..Request::default() };
            assert_eq!(engine.serve(0, request, 0), None);
            engine.networks.waiting.pop()
        };
        assert!(matches!(said(RunPhase::Starting), Some((0, FromRun::Unserved { number: 1, .. }))));
        let refused = said(RunPhase::Running);
        assert!(matches!(refused, Some((0, FromRun::Reply { answer: Err(CallError::Mismatch { .. }), .. }))));
    }
}
