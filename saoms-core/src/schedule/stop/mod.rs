//! Functions that stop the hardware of components, whatever the code of the components does: see
//! [`StopFunction`](saoms_api::StopFunction).
//!
//! They are called on threads of their own, so that one that hangs holds up neither the fleet nor the others. All are
//! requested when a run ends; [`stop_hardware`] does that for a process that ends without its runs.

mod emergency;
mod hang;
mod threads;

use std::collections::HashMap;
use std::mem::ManuallyDrop;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};
use std::time::{Duration, Instant};

use saoms_api::host::contain::contained;
use saoms_api::{Failure, StopFunction};

pub(crate) use self::emergency::STOPPED;
pub use self::emergency::hears_stops;
use self::threads::StopThreads;
use super::component::library::with_library;
use super::engine::Engine;
use super::shared::Shared;
use crate::observe::Occurrence;

/// The functions of a fleet that stop hardware.
#[derive(Default)]
pub(crate) struct Stops {
    /// By the number of their component. Bodies own them.
    registered: Mutex<HashMap<u32, Vec<Weak<RegisteredStop>>>>,
    threads: StopThreads,
    /// True once there was one.
    any: AtomicBool,
    /// True once the fleet is watched for code that does not return.
    is_watched: AtomicBool,
    /// The fleet, which is told what could not be stopped.
    fleet: OnceLock<Weak<Shared>>,
}

/// A function of a component that stops hardware.
#[derive(Debug)]
pub(crate) struct RegisteredStop {
    component: u32,
    /// Path of the component.
    name: Arc<str>,
    function: ManuallyDrop<StopFunction>,
    /// Those of its fleet, whose threads release it.
    stops: Weak<Stops>,
}

impl RegisteredStop {
    /// Frees the state of the function on this thread, if this is its last owner.
    pub(crate) fn release_here(self: Arc<RegisteredStop>) {
        if let Some(mut last) = Arc::into_inner(self) {
            last.stops = Weak::new();
            drop(last);
        }
    }
}

impl Drop for RegisteredStop {
    /// The last owner frees the state, which is code of the component and may hang: that holds up nobody else.
    fn drop(&mut self) {
        // SAFETY: it is taken once, and nobody uses it afterwards.
        let function = unsafe { ManuallyDrop::take(&mut self.function) };
        match self.stops.upgrade() {
            Some(stops) => stops.threads.release(&stops, &self.name, function),
            None => release(function),
        }
    }
}

/// Frees the state of a function. A panic of its destructor is contained: nothing depends on it.
fn release(function: StopFunction) {
    let _ = contained(|| drop(function));
}

/// The functions of all fleets of the process.
static ALL: Mutex<Vec<Weak<Stops>>> = Mutex::new(Vec::new());

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Stops the hardware of all fleets of this process, for a process that ends at once. Waits for it, but no longer than
/// `patience`; gives the components whose hardware may still move.
pub fn stop_hardware(patience: Duration) -> Vec<String> {
    let all: Vec<Arc<Stops>> = lock(&ALL).iter().filter_map(Weak::upgrade).collect();
    let deadline = Instant::now() + patience;
    all.iter().for_each(Stops::request_all);
    let rest = |stops: &Arc<Stops>| stops.threads.wait(deadline.saturating_duration_since(Instant::now()));
    all.iter().flat_map(rest).map(|name| name.to_string()).collect()
}

impl Stops {
    /// Names the fleet of these functions.
    pub(super) fn serve(self: &Arc<Stops>, fleet: &Arc<Shared>) {
        // It is set once, by the start of the fleet.
        let _ = self.fleet.set(Arc::downgrade(fleet));
    }

    /// True if a component of the fleet ever registered one: where none did, nothing has to be looked up.
    #[inline]
    pub(crate) fn any(&self) -> bool {
        self.any.load(Ordering::Relaxed)
    }

    /// Registers a function of a component, until what is given back is dropped.
    pub(crate) fn register(
        self: &Arc<Stops>,
        component: u32,
        name: &Arc<str>,
        function: StopFunction,
    ) -> Arc<RegisteredStop> {
        let registered = Arc::new(RegisteredStop {
            component,
            name: Arc::clone(name),
            function: ManuallyDrop::new(function),
            stops: Arc::downgrade(self),
        });
        let mut all = lock(&self.registered);
        let own = all.entry(component).or_default();
        own.retain(|known| known.strong_count() > 0);
        own.push(Arc::downgrade(&registered));
        drop(all);
        if !self.any.swap(true, Ordering::Relaxed) {
            lock(&ALL).retain(|known| known.strong_count() > 0);
            lock(&ALL).push(Arc::downgrade(self));
            self.watch();
        }
        registered
    }

    /// Watches the fleet for code that does not return, from the first time on that there may be such code.
    pub(crate) fn watch(&self) {
        if !self.is_watched.swap(true, Ordering::Relaxed)
            && let Some(fleet) = self.fleet.get().and_then(Weak::upgrade)
        {
            hang::watch(&fleet);
        }
    }

    /// The functions of a component.
    fn of(&self, component: u32) -> Vec<Arc<RegisteredStop>> {
        lock(&self.registered).get(&component).into_iter().flatten().filter_map(Weak::upgrade).collect()
    }

    /// Has these functions called.
    pub(crate) fn request(self: &Arc<Stops>, functions: &[Arc<RegisteredStop>]) {
        if !functions.is_empty() {
            self.threads.request(self, functions);
        }
    }

    /// Has the functions of a component called.
    pub(crate) fn request_of(self: &Arc<Stops>, component: u32) {
        self.request(&self.of(component));
    }

    /// Has all functions called.
    pub(crate) fn request_all(self: &Arc<Stops>) {
        if self.any() {
            let all: Vec<_> = lock(&self.registered).values().flatten().filter_map(Weak::upgrade).collect();
            self.request(&all);
        }
    }

    /// Tells the hardware of these components that an execution has finished, and within which time the next one does.
    ///
    /// # Errors
    /// The function of this component panicked: its hardware stops by itself, which whoever executed has to know.
    #[cold]
    pub(crate) fn beat(&self, components: &[u32], period: Duration) -> Result<(), (u32, Failure)> {
        let mut result = Ok(());
        for registered in components.iter().flat_map(|component| self.of(*component)) {
            if let Err(panic) = contained(|| registered.function.beat(period)) {
                let name = &registered.name;
                let failure = Failure::new(format!("the heartbeat of the hardware of component `{name}`: {panic}"));
                result = Err((registered.component, failure));
            }
        }
        result
    }

    /// Waits until all that were requested have returned; gives the components of those that have not.
    pub(super) fn wait(&self, patience: Duration) -> Vec<Arc<str>> {
        if self.any() { self.threads.wait(patience) } else { Vec::new() }
    }

    /// Calls a function.
    fn call(&self, registered: &RegisteredStop) {
        let Err(failure) = contained(|| registered.function.stop()).and_then(|stopped| stopped) else { return };
        let Some(fleet) = self.fleet.get().and_then(Weak::upgrade) else { return };
        let mut engine = fleet.lock();
        let spec = &engine.slots[registered.component as usize].spec;
        let message = with_library(spec, failure);
        engine.hardware_moves(registered.component, message, fleet.clock.now());
        fleet.release(engine);
    }
}

impl Engine {
    /// The components whose hardware hears a heartbeat when this one has executed: itself, and those that it is wired
    /// to, where they register functions that stop hardware.
    pub(crate) fn heartbeats_of(&self, index: u32) -> Vec<u32> {
        let spec = &self.slots[index as usize].spec;
        let targets = spec.references.iter().flat_map(|wire| &wire.targets).map(|target| target.component as u32);
        let stops =
            |index: &u32| self.slots.get(*index as usize).is_some_and(|slot| slot.spec.class.declaration().stops);
        let mut all: Vec<u32> = std::iter::once(index).chain(targets).filter(stops).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Stops the hardware of passive components that only this one uses, and that of other programs.
    pub(crate) fn stop_its_hardware(&mut self, index: u32) {
        self.stop_hardware_elsewhere(index);
        if !self.stops.any() {
            return;
        }
        let uses = |user: u32, provider: u32| {
            let wires = &self.slots[user as usize].spec.references;
            wires.iter().flat_map(|wire| &wire.targets).any(|target| target.component as u32 == provider)
        };
        for provider in self.heartbeats_of(index) {
            let goes_on = |user: u32| self.slots[user as usize].is_alive() && !self.slots[user as usize].is_stopped();
            let is_used = |user: u32| user != index && goes_on(user) && uses(user, provider);
            let is_passive = !self.slots[provider as usize].policy.periodic;
            if is_passive && !(0..self.slots.len() as u32).any(is_used) {
                self.stops.request_of(provider);
            }
        }
    }

    /// Notes that hardware may still move, which fails the run.
    pub(super) fn hardware_moves(&mut self, index: u32, message: String, now: u64) {
        let name = &self.slots[index as usize].name;
        let reason = format!("component `{name}` could not stop its hardware: {message}");
        // It is asked again at the end.
        if !self.reasons.contains(&reason) {
            self.reasons.push(reason);
        }
        self.emit(now, index, Occurrence::NotStopped { message });
    }
}
