//! Calls of components of other programs.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::{Duration, Instant};

use saoms_api::extension::{CallLine, CallOutcome, CallProxy, RemoteProxy};
use saoms_api::host::{Operation, ServiceCall, format_duration};
use saoms_api::{CallError, Failure};
use saoms_lang::assembly::{CALL_DEADLINE, ComponentSpec, RemoteTarget, Wire};

use super::part::Part;
use crate::network::exchange::call::{Outcome, OwnCall};
use crate::network::exchange::wire::STOP;
use crate::network::{FromRun, Port, Ticket};
use crate::schedule::engine::Engine;
use crate::schedule::networks::{NO_NETWORK, interface_hash};
use crate::schedule::settings::nanos;
use crate::schedule::shared::Shared;

/// Time after which who waits looks whether it is to end.
const LOOK: Duration = Duration::from_millis(50);

/// Calls of a proxy whose outcomes are kept for it, at most.
const MOST_TICKETS: usize = 256;

/// What a component has in other programs.
#[derive(Default)]
pub(crate) struct Remotes {
    /// By the handles of references.
    ends: HashMap<u32, RemoteEnd>,
}

/// A service in another program.
struct RemoteEnd {
    line: Line,
    proxy: Option<Box<dyn CallProxy>>,
}

/// The way to it.
struct Line {
    port: Arc<Port>,
    /// What all calls have in common.
    call: OwnCall,
    /// Time within which a call is answered that its caller waits for.
    deadline: Duration,
    /// Calls of a proxy whose outcome is not known.
    tickets: BTreeMap<u64, Arc<Ticket>>,
    last: u64,
    is_ending: bool,
}

/// Calls a service in another program: through a proxy if its interface has one, or else waiting for the answer.
#[cold]
pub(super) fn call_elsewhere(
    shared: &Shared,
    caller: &mut Part,
    (wire, target): (&Wire, &RemoteTarget),
    handle: u32,
    call: &mut dyn ServiceCall,
) -> Result<(), CallError> {
    let mut remotes = caller.remotes.take().unwrap_or_default();
    let result = match remotes.end(shared, caller, (wire, target), handle) {
        Some(end) => end.call(caller, call),
        // Without networks it is nowhere.
        None => Err(CallError::NotRunning { provider: target.component.clone() }),
    };
    caller.remotes = Some(remotes);
    result
}

impl Remotes {
    fn end(
        &mut self,
        shared: &Shared,
        caller: &Part,
        (wire, target): (&Wire, &RemoteTarget),
        handle: u32,
    ) -> Option<&mut RemoteEnd> {
        Some(match self.ends.entry(handle) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let port = shared.look(|engine| engine.networks.port(engine.slots[caller.index as usize].network))?;
                let line = Line {
                    port,
                    call: own_call(&caller.spec, caller.index, (wire, target), handle),
                    deadline: wire.deadline.unwrap_or(CALL_DEADLINE),
                    tickets: BTreeMap::new(),
                    last: 0,
                    is_ending: false,
                };
                let proxy = RemoteProxy::of(&wire.interface).map(|proxy| (proxy.make)());
                new.insert(RemoteEnd { line, proxy })
            }
        })
    }
}

/// A call through a reference, without operation and arguments.
fn own_call(spec: &ComponentSpec, index: u32, (wire, target): (&Wire, &RemoteTarget), handle: u32) -> OwnCall {
    let declared = &spec.class.declaration().references;
    let interface = declared.iter().find(|declared| declared.name == wire.reference);
    OwnCall {
        line: u64::from(index) << 32 | u64::from(handle),
        node: target.node.to_string(),
        component: target.component.clone(),
        service: target.service.clone(),
        interface: interface.map_or(0, |declared| interface_hash(&declared.interface)),
        caller: spec.path.clone(),
        ..OwnCall::default()
    }
}

impl RemoteEnd {
    fn call(&mut self, caller: &Part, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        self.line.call.cause = caller.recorder.cause().0;
        match &mut self.proxy {
            Some(proxy) => {
                self.line.is_ending = caller.is_ending;
                proxy.call(&mut self.line, call)
            }
            None => self.line.call_and_wait(caller, call),
        }
    }
}

impl Line {
    fn put(&self, call: OwnCall) -> Arc<Ticket> {
        let ticket = Arc::<Ticket>::default();
        self.port.put(std::iter::once(FromRun::Call { call, ticket: Arc::clone(&ticket) }));
        ticket
    }

    fn call_and_wait(&self, caller: &Part, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        let (operation, arguments) = (call.operation(), call.arguments());
        let ticket =
            self.put(OwnCall { operation, arguments, deadline: Some(nanos(self.deadline)), ..self.call.clone() });
        // The thread of the network ends it in time, unless that is held up.
        let longest = Instant::now() + self.deadline.saturating_mul(2);
        let outcome = loop {
            match ticket.wait(LOOK) {
                Some(outcome) => break outcome,
                None if caller.is_cancelled() => return Err(self.failed("its caller is to end".to_owned())),
                None if Instant::now() > longest => break Outcome::Late { was_there: true },
                None => {}
            }
        };
        let url = caller.spec.url().unwrap_or_default();
        let within = || format!("no answer came within {} over the network `{url}`", format_duration(self.deadline));
        match outcome {
            Outcome::Reply { bytes, .. } => call.reply(&bytes),
            Outcome::Refused { error, .. } => Err(error),
            Outcome::Late { was_there: true } => Err(self.failed(within())),
            Outcome::Late { was_there: false } => {
                Err(self.failed(format!("{}: nobody runs its node `{}` there", within(), self.call.node)))
            }
            Outcome::Gone => Err(self.failed(format!(
                "the program of its node `{}` on the network `{url}` has ended or begun anew: whether it carried the \
                 call out is not known",
                self.call.node
            ))),
            Outcome::Dropped => Err(self.failed(format!(
                "a stop of the hardware has overtaken the call, or this program has left the network `{url}`"
            ))),
        }
    }

    fn failed(&self, why: String) -> CallError {
        CallError::Failed { provider: self.call.component.clone(), failure: Failure::new(why) }
    }
}

impl CallLine for Line {
    fn start(&mut self, operation: Operation, arguments: Vec<u8>, program: Option<u64>) -> u64 {
        let ticket = self.put(OwnCall { operation, arguments, program, ..self.call.clone() });
        self.last += 1;
        self.tickets.insert(self.last, ticket);
        // Those that nobody asks about any more.
        if self.tickets.len() > MOST_TICKETS {
            self.tickets.pop_first();
        }
        self.last
    }

    fn outcome(&mut self, call: u64) -> Option<CallOutcome> {
        let outcome = self.tickets.get(&call)?.take()?;
        self.tickets.remove(&call);
        Some(match outcome {
            Outcome::Reply { program, bytes } => CallOutcome::Reply { program, bytes },
            Outcome::Refused { error, .. } => CallOutcome::Refused(error),
            Outcome::Gone | Outcome::Late { .. } => CallOutcome::Gone,
            Outcome::Dropped => CallOutcome::Stopped,
        })
    }

    fn provider(&self) -> &str {
        &self.call.component
    }

    fn is_ending(&self) -> bool {
        self.is_ending
    }
}

/// Hardware of another program that hears when a component has executed.
pub(crate) struct RemoteHeartbeat {
    port: Arc<Port>,
    node: String,
    component: String,
}

impl RemoteHeartbeat {
    /// Tells it, and within which time the next execution ends.
    pub(super) fn beat(&self, caller: &Arc<str>, period: u64) {
        let (node, component, caller) = (self.node.clone(), self.component.clone(), Arc::clone(caller));
        self.port.put(std::iter::once(FromRun::Beat { node, component, caller, period }));
    }
}

/// The services in other programs whose hardware a component moves, with their handles.
fn moved(spec: &ComponentSpec) -> impl Iterator<Item = (&Wire, &RemoteTarget, u32)> {
    (0..).zip(&spec.references).flat_map(|(place, wire)| {
        let ends = (wire.targets.len() as u32..).zip(&wire.elsewhere).filter(|(_, end)| end.stops);
        ends.map(move |(target, end)| (wire, end, place | target << saoms_api::host::TARGET_SHIFT))
    })
}

impl Engine {
    /// True if a component moves hardware of other programs.
    pub(crate) fn moves_elsewhere(&self, index: u32) -> bool {
        moved(&self.slots[index as usize].spec).next().is_some()
    }

    /// The hardware of other programs that hears of a component's executions.
    pub(crate) fn heartbeats_elsewhere(&self, index: u32) -> Option<Box<[RemoteHeartbeat]>> {
        let slot = &self.slots[index as usize];
        let port = self.networks.port(slot.network)?;
        let heartbeats = moved(&slot.spec).map(|(_, end, _)| RemoteHeartbeat {
            port: Arc::clone(&port),
            node: end.node.to_string(),
            component: end.component.clone(),
        });
        let heartbeats: Box<[RemoteHeartbeat]> = heartbeats.collect();
        (!heartbeats.is_empty()).then_some(heartbeats)
    }

    /// Stops the hardware of other programs that a component moves: what it has called is not wanted any more.
    pub(crate) fn stop_hardware_elsewhere(&mut self, index: u32) {
        let slot = &self.slots[index as usize];
        if slot.network == NO_NETWORK {
            return;
        }
        for (wire, end, handle) in moved(&slot.spec) {
            let call = own_call(&slot.spec, index, (wire, end), handle);
            let call = OwnCall { operation: STOP, overtakes: true, ..call };
            self.networks.waiting.push((slot.network, FromRun::Call { call, ticket: Arc::default() }));
        }
    }
}
