//! Changes of a fleet: components end, start and are replaced by a plan, or everything stays as it was.
//!
//! The start of a fleet is the change from an empty one. New instances initialize on the caller's thread, providers
//! before those that call them, while those that they replace and those that end are out of the engine, as if they
//! served a call: the timer never waits. Messages of new instances are held back until all have initialized; then the
//! change is committed at one instant, and the old instances shut down.

use std::fmt;
use std::sync::{Arc, MutexGuard};
use std::time::{Duration, Instant};

use saoms_api::Failure;
use saoms_lang::assembly::{Assembly, ComponentSpec};

use super::body::{Body, Job};
use super::engine::{Engine, RunPhase};
use super::lifecycle::Request;
use super::shared::Shared;
use super::slot::{NEVER, Slot, SlotState, TaskPolicy, Wish};
use super::takeover::{Predecessor, Refusal, Takeover};
use super::trace::TraceStep;
use crate::assemble::{ChangePlan, Difference, providers_first};
use crate::journal::ComponentName;
use crate::observe::Occurrence;

/// Maximum time that a change waits for running code.
const WAIT: Duration = Duration::from_millis(500);

/// A change that was made, by the paths of components.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changed {
    /// Components that joined the fleet.
    pub added: Vec<String>,
    /// Components that ended.
    pub removed: Vec<String>,
    /// Components with new instances.
    pub replaced: Vec<(String, Takeover)>,
}

/// Error of a change that was not made. The fleet is as it was.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChangeError {
    /// A component cannot end or be replaced now: its code runs, or it refused. A later try may succeed.
    NotNow {
        /// Its path.
        component: String,
        /// The reason.
        why: String,
    },
    /// A new instance of a component cannot be constructed, initialized or restored.
    Failed {
        /// Its path.
        component: String,
        /// Its class.
        class: String,
        /// Its failure.
        failure: Failure,
    },
    /// The fleet has no such component.
    Unknown(String),
    /// The run ends.
    Ending,
}

impl fmt::Display for ChangeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ChangeError::NotNow { component, why } => write!(formatter, "component `{component}`: {why}"),
            ChangeError::Failed { component, class, failure } => {
                write!(formatter, "component `{component}` of class `{class}` could not start: {failure}")
            }
            ChangeError::Unknown(component) => write!(formatter, "the fleet has no component `{component}`"),
            ChangeError::Ending => formatter.write_str("the run ends"),
        }
    }
}

impl std::error::Error for ChangeError {}

/// Changes the fleet to that of an assembly.
pub(super) fn apply(shared: &Arc<Shared>, wanted: Assembly) -> Result<Changed, ChangeError> {
    let _one_at_a_time = shared.lock_changes();
    let current = shared.lock().specs();
    let wanted: Vec<_> = wanted.components.into_iter().map(|spec| Some(Arc::new(spec))).collect();
    let plan = ChangePlan::between(&as_members(&current), &as_members(&wanted));
    Change::new(shared).make(&plan, wanted)
}

/// Replaces one component by one of this specification, even if nothing differs. Its task settings stay.
pub(super) fn replace(shared: &Arc<Shared>, spec: ComponentSpec) -> Result<Takeover, ChangeError> {
    let _one_at_a_time = shared.lock_changes();
    let mut wanted = shared.lock().specs();
    let same = |known: &Option<Arc<ComponentSpec>>| known.as_ref().is_some_and(|one| one.path == spec.path);
    let Some((number, known)) = wanted.iter_mut().enumerate().find(|(_, known)| same(known)) else {
        return Err(ChangeError::Unknown(spec.path));
    };
    let task = known.as_ref().and_then(|known| known.task.clone());
    *known = Some(Arc::new(ComponentSpec { task, ..spec }));
    let differences = Vec::new();
    let replace = vec![crate::assemble::Replacement { current: number, wanted: number, differences }];
    let others = (0..wanted.len()).filter(|one| *one != number && wanted[*one].is_some());
    let keep = others.map(|one| (one, one)).collect();
    let changed = Change::new(shared).make(&ChangePlan { replace, keep, ..ChangePlan::default() }, wanted)?;
    Ok(changed.replaced.first().map_or(Takeover::Awaited, |(_, done)| *done))
}

fn as_members(specs: &[Option<Arc<ComponentSpec>>]) -> Vec<Option<&ComponentSpec>> {
    specs.iter().map(Option::as_deref).collect()
}

/// A change that is being made.
struct Change<'a> {
    shared: &'a Arc<Shared>,
    /// Numbers of new components, in the order of the fleet that is wanted.
    added: Vec<u32>,
    /// New components that have initialized, in that order.
    begun: Vec<u32>,
    /// Components that a new instance has taken over.
    taken: Vec<(u32, Predecessor, Takeover)>,
    /// Components that are replaced and did not run.
    awaited: Vec<(u32, Arc<ComponentSpec>)>,
    /// Bodies of components that are to be replaced.
    present: Vec<(u32, Box<Body>)>,
    /// Bodies of components that end.
    leaving: Vec<(u32, Box<Body>)>,
}

/// Kinds of change of a component of the wanted fleet.
#[derive(Clone, Copy)]
enum Fate {
    Kept,
    Added(u32),
    Replaced(u32),
}

impl<'a> Change<'a> {
    fn new(shared: &'a Arc<Shared>) -> Change<'a> {
        Change {
            shared,
            added: Vec::new(),
            begun: Vec::new(),
            taken: Vec::new(),
            awaited: Vec::new(),
            present: Vec::new(),
            leaving: Vec::new(),
        }
    }

    fn make(
        mut self,
        plan: &ChangePlan,
        mut wanted: Vec<Option<Arc<ComponentSpec>>>,
    ) -> Result<Changed, ChangeError> {
        let order = providers_first(&as_members(&wanted));
        // An instance of another class cannot restore the state of the present one.
        let (anew, replaced): (Vec<_>, Vec<_>) =
            plan.replace.iter().partition(|one| one.differences.contains(&Difference::Class));
        let removed: Vec<u32> =
            plan.remove.iter().chain(anew.iter().map(|one| &one.current)).map(|&one| one as u32).collect();
        let mut engine = self.wait_for(&removed, replaced.iter().map(|one| one.current as u32))?;
        let mut fates = vec![Fate::Kept; wanted.len()];
        let mut numbers = vec![u32::MAX; wanted.len()];
        plan.keep.iter().for_each(|(current, wanted)| numbers[*wanted] = *current as u32);
        for one in &replaced {
            numbers[one.wanted] = one.current as u32;
            fates[one.wanted] = Fate::Replaced(one.current as u32);
        }
        let mut added: Vec<usize> =
            plan.add.iter().copied().chain(anew.iter().map(|one| one.wanted)).collect();
        added.sort_unstable();
        self.added = engine.number(added.iter().filter_map(|&place| wanted[place].as_ref()));
        for (&place, &number) in added.iter().zip(&self.added) {
            (numbers[place], fates[place]) = (number, Fate::Added(number));
        }
        for place in (0..wanted.len()).filter(|place| !matches!(fates[*place], Fate::Kept)) {
            wanted[place] = wanted[place].take().map(|spec| retargeted(spec, &numbers));
        }
        engine.prepare(self.shared, added.iter().filter_map(|&place| wanted[place].clone()), &self.added);
        self.take_out(
            &mut engine,
            &removed,
            &replaced.iter().map(|one| one.current as u32).collect::<Vec<_>>(),
        );
        self.shared.release(engine);
        for place in order {
            let Some(spec) = wanted[place].take() else { continue };
            let result = match fates[place] {
                Fate::Kept => Ok(()),
                Fate::Added(number) => self.begin(number),
                Fate::Replaced(number) => self.replace(number, spec),
            };
            if let Err(error) = result {
                self.undo();
                return Err(error);
            }
        }
        self.commit(&removed)
    }

    /// Waits until no code of these components runs.
    fn wait_for(
        &self,
        removed: &[u32],
        replaced: impl Iterator<Item = u32> + Clone,
    ) -> Result<MutexGuard<'a, Engine>, ChangeError> {
        let deadline = Instant::now() + WAIT;
        let mut engine = self.shared.lock();
        loop {
            if matches!(engine.phase, RunPhase::Stopping | RunPhase::Ended) {
                return Err(ChangeError::Ending);
            }
            let mut all = removed.iter().copied().chain(replaced.clone());
            let Some(busy) = all.find(|number| engine.slots[*number as usize].body.is_none()) else {
                return Ok(engine);
            };
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                let component = engine.slots[busy as usize].name.to_string();
                let why = "its code has not returned yet".to_owned();
                return Err(ChangeError::NotNow { component, why });
            }
            engine = self.shared.wait_for_return(engine, left);
        }
    }

    /// Takes the bodies of components that run out of the engine.
    fn take_out(&mut self, engine: &mut Engine, removed: &[u32], replaced: &[u32]) {
        for &number in removed {
            if engine.slots[number as usize].is_alive()
                && let Some(body) = engine.take(number)
            {
                self.leaving.push((number, body));
            }
        }
        for &number in replaced {
            if engine.slots[number as usize].state == SlotState::Active
                && let Some(body) = engine.take(number)
            {
                self.present.push((number, body));
            }
        }
    }

    /// Constructs and initializes a new component, where it runs from the start.
    fn begin(&mut self, number: u32) -> Result<(), ChangeError> {
        if !self.shared.lock().slots[number as usize].policy.on_startup {
            return Ok(());
        }
        match self.initialize(number) {
            Ok(()) => {
                self.begun.push(number);
                Ok(())
            }
            Err((culprit, failure)) => Err(self.failed(culprit, failure)),
        }
    }

    /// Initializes a new component. The number in the error is that of the component that failed, which may be a
    /// provider.
    fn initialize(&self, number: u32) -> Result<(), (u32, Failure)> {
        let mut engine = self.shared.lock();
        let now = engine.time_of_change(self.shared);
        engine.slots[number as usize].state = SlotState::Starting;
        let Some(mut body) = engine.begin(number, Job::Start, now) else {
            return Err((number, Failure::new("it is in use")));
        };
        self.shared.release(engine);
        let result = body.perform(self.shared, Job::Start);
        let mut engine = self.shared.lock();
        let result = match result {
            Ok(()) => {
                engine.finish(number, body, Job::Start, Ok(()), now, now);
                engine.held_failure.take().map_or(Ok(()), Err)
            }
            Err(failure) => {
                engine.put_back(number, body);
                engine.slots[number as usize].state = SlotState::Failed;
                Err((number, failure))
            }
        };
        self.shared.release(engine);
        result
    }

    /// Constructs the new instance and lets it take over.
    fn replace(&mut self, number: u32, spec: Arc<ComponentSpec>) -> Result<(), ChangeError> {
        let place = self.present.iter().position(|(known, _)| *known == number);
        let Some(mut body) = place.map(|place| self.present.swap_remove(place).1) else {
            self.awaited.push((number, spec));
            return Ok(());
        };
        let now = self.shared.clock.now();
        (body.part.now, body.part.due) = (now, now);
        let result = body.take_over(self.shared, spec);
        let mut engine = self.shared.lock();
        engine.slots[number as usize].held = result.is_ok();
        let name = engine.slots[number as usize].name.to_string();
        if result.is_ok() {
            engine.put_back(number, body);
        } else {
            engine.return_unchanged(number, body, now);
        }
        let failure = engine.held_failure.take();
        self.shared.release(engine);
        match result {
            Ok((predecessor, done)) => {
                self.taken.push((number, predecessor, done));
                failure.map_or(Ok(()), |(culprit, failure)| Err(self.failed(culprit, failure)))
            }
            Err(Refusal::NotNow(why)) => Err(ChangeError::NotNow { component: name, why }),
            Err(Refusal::Failed(failure)) => Err(self.failed(number, failure)),
        }
    }

    fn failed(&self, culprit: u32, failure: Failure) -> ChangeError {
        let engine = self.shared.lock();
        let spec = &engine.slots[culprit as usize].spec;
        ChangeError::Failed { component: spec.path.clone(), class: spec.class.name().to_owned(), failure }
    }

    /// Leaves everything as it was.
    fn undo(&mut self) {
        for number in std::mem::take(&mut self.begun).into_iter().rev() {
            self.take_back(number);
        }
        let mut engine = self.shared.lock();
        let now = engine.time_of_change(self.shared);
        for (number, predecessor, _) in std::mem::take(&mut self.taken).into_iter().rev() {
            if let Some(mut body) = engine.take(number) {
                body.give_back(&mut engine.bus, predecessor);
                engine.slots[number as usize].state = SlotState::Active;
                engine.return_unchanged(number, body, now);
            }
        }
        for (number, body) in std::mem::take(&mut self.present).into_iter().chain(self.leaving.drain(..)) {
            engine.return_unchanged(number, body, now);
        }
        for &number in &self.added {
            engine.leave_topics(number, now);
            engine.forget(number);
        }
        self.shared.release(engine);
    }

    /// Shuts down a new component of a change that is undone.
    fn take_back(&self, number: u32) {
        let mut engine = self.shared.lock();
        if engine.slots[number as usize].state != SlotState::Active {
            return;
        }
        let now = engine.time_of_change(self.shared);
        let Some(mut body) = engine.begin(number, Job::Shutdown, now) else { return };
        self.shared.release(engine);
        let result = body.perform(self.shared, Job::Shutdown);
        let mut engine = self.shared.lock();
        body.part.outbox.clear();
        engine.put_back(number, body);
        if let Err(failure) = result {
            let message = format!("could not shut down: {failure}");
            engine.tell(now, number, Occurrence::Failed { message, restart: None });
        }
        self.shared.release(engine);
    }

    /// Commits the change after all have initialized: their messages are delivered, and removed components shut down.
    fn commit(mut self, removed: &[u32]) -> Result<Changed, ChangeError> {
        let mut engine = self.shared.lock();
        if matches!(engine.phase, RunPhase::Stopping | RunPhase::Ended) {
            self.shared.release(engine);
            self.undo();
            return Err(ChangeError::Ending);
        }
        let now = engine.time_of_change(self.shared);
        if engine.phase == RunPhase::Starting {
            self.shared.clock.start();
            engine.phase = RunPhase::Running;
            // The timer sleeps without a deadline so far. It has to sleep until the end of the run if no component is
            // due.
            engine.wake = true;
        }
        let name = |engine: &Engine, number: u32| engine.slots[number as usize].name.to_string();
        let mut changed = Changed {
            added: self.added.iter().map(|number| name(&engine, *number)).collect(),
            removed: removed.iter().map(|number| name(&engine, *number)).collect(),
            replaced: Vec::new(),
        };
        for &number in &self.begun {
            engine.take_vote(number, now);
        }
        for &number in &self.added {
            engine.join(number, now);
        }
        for (number, predecessor, done) in self.taken.drain(..) {
            engine.commit_takeover(number, predecessor, done, now);
            changed.replaced.push((name(&engine, number), done));
        }
        for (number, spec) in self.awaited.drain(..) {
            engine.await_spec(number, spec, now);
            changed.replaced.push((name(&engine, number), Takeover::Awaited));
        }
        for &number in removed {
            if !self.leaving.iter().any(|(leaving, _)| *leaving == number) {
                engine.leave_topics(number, now);
                engine.forget_vote(number, now);
                engine.forget(number);
            }
        }
        engine.end_if_done(now);
        self.shared.release(engine);
        for (number, body) in std::mem::take(&mut self.leaving) {
            self.shut_down(number, body, now);
        }
        Ok(changed)
    }

    fn shut_down(&self, number: u32, mut body: Box<Body>, now: u64) {
        let mut engine = self.shared.lock();
        let slot = &mut engine.slots[number as usize];
        if slot.state != SlotState::Abandoned {
            (slot.state, slot.wish) = (SlotState::Leaving, Wish::None);
        }
        self.shared.release(engine);
        (body.part.now, body.part.due) = (now, now);
        let result = body.perform(self.shared, Job::Shutdown);
        let mut engine = self.shared.lock();
        engine.finish(number, body, Job::Shutdown, result, now, now);
        engine.forget(number);
        self.shared.release(engine);
    }
}

/// The specification with slot numbers as targets of its wires.
fn retargeted(spec: Arc<ComponentSpec>, numbers: &[u32]) -> Arc<ComponentSpec> {
    let number = |target: usize| numbers.get(target).map_or(usize::MAX, |number| *number as usize);
    let mut targets = spec.references.iter().flat_map(|wire| &wire.targets);
    if targets.all(|target| number(target.component) == target.component) {
        return spec;
    }
    let mut spec = Arc::unwrap_or_clone(spec);
    for target in spec.references.iter_mut().flat_map(|wire| &mut wire.targets) {
        target.component = number(target.component);
    }
    Arc::new(spec)
}

impl Engine {
    /// The specifications of the fleet by their numbers.
    fn specs(&self) -> Vec<Option<Arc<ComponentSpec>>> {
        self.slots.iter().map(|slot| slot.is_member().then(|| Arc::clone(&slot.spec))).collect()
    }

    /// The time at which a change happens.
    fn time_of_change(&self, shared: &Shared) -> u64 {
        if self.phase == RunPhase::Starting { 0 } else { shared.clock.now() }
    }

    /// The numbers of new components. A removed component that returns gets its number again.
    fn number<'s>(&self, specs: impl Iterator<Item = &'s Arc<ComponentSpec>>) -> Vec<u32> {
        let mut next = self.slots.len() as u32;
        let number = |spec: &Arc<ComponentSpec>| {
            let known = self.numbers.get(spec.path.as_str()).copied();
            known.filter(|number| !self.slots[*number as usize].is_member()).unwrap_or_else(|| {
                next += 1;
                next - 1
            })
        };
        specs.map(number).collect()
    }

    /// Makes slots for new components.
    fn prepare(&mut self, shared: &Shared, specs: impl Iterator<Item = Arc<ComponentSpec>>, numbers: &[u32]) {
        let mut names = Vec::new();
        for (spec, &number) in specs.zip(numbers) {
            if let Some(slot) = self.slots.get_mut(number as usize) {
                slot.revive(spec);
                continue;
            }
            if let Some(records) = &self.records {
                records.join(ComponentName::of(&spec), self.phase != RunPhase::Starting);
            }
            let slot = Slot::new(number, spec);
            names.push(Arc::clone(&slot.name));
            self.numbers.insert(Arc::clone(&slot.name), number);
            self.slots.push(slot);
        }
        shared.names.add(names);
        if self.phase == RunPhase::Starting {
            self.journal_capacity /= self.slots.len().max(1);
        }
    }

    /// Takes a body out, as for a call.
    fn take(&mut self, number: u32) -> Option<Box<Body>> {
        let body = self.slots[number as usize].body.take()?;
        self.out += 1;
        Some(body)
    }

    /// Gives a body back.
    fn put_back(&mut self, number: u32, body: Box<Body>) {
        if self.is_abandoned(number) {
            // It was abandoned, and its destructor may block as its code did: it is leaked.
            std::mem::forget(body);
            return;
        }
        self.came_back();
        self.slots[number as usize].body = Some(body);
    }

    /// Gives back the body of a component that goes on as before.
    fn return_unchanged(&mut self, number: u32, body: Box<Body>, now: u64) {
        self.slots[number as usize].held = false;
        self.put_back(number, body);
        if self.slots[number as usize].is_alive() {
            self.resume(number, now);
        }
    }

    /// Removes a component from the fleet.
    fn forget(&mut self, number: u32) {
        let slot = &mut self.slots[number as usize];
        if slot.state != SlotState::Abandoned {
            slot.state = SlotState::Removed;
            (slot.entry, slot.wish, slot.vote) = (NEVER, Wish::None, None);
        }
    }

    fn take_vote(&mut self, number: u32, now: u64) {
        let body = self.slots[number as usize].body.as_mut();
        if let Some(vote) = body.and_then(|body| body.part.vote.take()) {
            self.note_vote(number, vote, now);
        }
    }

    /// Adds a new component to the fleet: its messages are delivered, and its first execution is scheduled.
    fn join(&mut self, number: u32, now: u64) {
        let slot = &mut self.slots[number as usize];
        (slot.joined, slot.held) = (true, false);
        let is_active = slot.state == SlotState::Active;
        let Some(mut body) = slot.body.take() else { return };
        body.part.held = false;
        if is_active {
            self.deliver(&mut body.part, now);
            self.step(now, number, TraceStep::Started);
            self.tell(now, number, Occurrence::Started);
        }
        let slot = &mut self.slots[number as usize];
        slot.body = Some(body);
        if is_active && slot.policy.periodic {
            slot.due = now.saturating_add(slot.policy.delay);
            let when = slot.due.min(slot.until);
            match slot.wish {
                Wish::None => self.enqueue(number, when),
                Wish::Leave | Wish::Return { .. } => self.resume(number, now),
            }
        } else if std::mem::take(&mut slot.waiting) {
            self.enqueue(number, now);
        }
    }

    fn commit_takeover(&mut self, number: u32, predecessor: Predecessor, done: Takeover, now: u64) {
        let Some(mut body) = self.slots[number as usize].body.take() else { return };
        body.inherit(&mut self.bus, predecessor);
        self.release(number, &mut body, now);
        self.deliver(&mut body.part, now);
        let vote = body.part.vote.take();
        let slot = &mut self.slots[number as usize];
        let period = slot.policy.period;
        slot.renew(Arc::clone(&body.part.spec));
        body.part.period = slot.policy.period;
        slot.body = Some(body);
        slot.held = false;
        slot.statistics.replaced += 1;
        self.tell(now, number, Occurrence::Replaced { continued: done == Takeover::Continued });
        if let Some(vote) = vote {
            self.note_vote(number, vote, now);
        }
        let slot = &mut self.slots[number as usize];
        // A new period counts from the last execution.
        if let Some(last) = slot.last_due.filter(|_| slot.policy.period != period) {
            slot.due = last.saturating_add(slot.policy.period).max(now);
            if slot.entry != NEVER {
                let when = slot.due.min(slot.until);
                self.enqueue(number, when);
            }
        }
        self.resume(number, now);
    }

    /// Sets the specification that a component which does not run has from its next start on.
    fn await_spec(&mut self, number: u32, spec: Arc<ComponentSpec>, now: u64) {
        let slot = &mut self.slots[number as usize];
        slot.renew(Arc::clone(&spec));
        let has_failed = slot.state == SlotState::Failed;
        if let Some(body) = &mut slot.body {
            (body.part.spec, body.part.period) = (spec, slot.policy.period);
        }
        if has_failed {
            self.request(number, Request::Schedule { lasting: NEVER }, now);
        }
    }
}

impl Slot {
    /// Sets a new specification.
    fn renew(&mut self, spec: Arc<ComponentSpec>) {
        self.policy = TaskPolicy::of(&spec);
        self.spec = spec;
    }

    /// Reuses the slot of a removed component that returns.
    fn revive(&mut self, spec: Arc<ComponentSpec>) {
        self.renew(Arc::clone(&spec));
        (self.state, self.held) = (SlotState::Idle, true);
        (self.due, self.last_due, self.until) = (NEVER, None, NEVER);
        if let Some(body) = &mut self.body {
            (body.part.spec, body.part.period, body.part.held) = (spec, self.policy.period, true);
        }
    }
}
