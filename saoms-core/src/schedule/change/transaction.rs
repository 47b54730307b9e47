use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, MutexGuard};
use std::time::{Duration, Instant};

use saoms_api::Failure;
use saoms_lang::assembly::ComponentSpec;

use super::apart::drop_apart;
use super::record::ChangeRecord;
use super::takeover::{Predecessor, Refusal, Takeover};
use super::updating::Updated;
use super::{ChangeError, ChangeWithdrawal, Changed, PlannedChanges, Specs, as_members};
use crate::assemble::{ChangePlan, providers_first};
use crate::schedule::component::body::{Body, Job};
use crate::schedule::component::estate::Estate;
use crate::schedule::component::library::{library_of, with_library};
use crate::schedule::engine::slot::SlotState;
use crate::schedule::engine::{Engine, RunPhase};
use crate::schedule::shared::Shared;

/// Maximum time that a change waits for running code.
pub(super) const WAIT: Duration = Duration::from_millis(500);

/// A change that is being made.
pub(super) struct Change<'a> {
    pub(super) shared: &'a Arc<Shared>,
    /// Numbers of new components, in the order of the fleet that is wanted.
    added: Vec<u32>,
    /// Components whose place another one of their path takes.
    displaced: Vec<u32>,
    /// New components that have initialized, in that order.
    begun: Vec<u32>,
    /// Components that a new instance has taken over.
    taken: Vec<(u32, Predecessor, Takeover)>,
    /// Components that are replaced and did not run.
    awaited: Vec<(u32, Arc<ComponentSpec>)>,
    /// Bodies of components that are to be replaced.
    present: BTreeMap<u32, Box<Body>>,
    /// Components that do not run and must not start meanwhile.
    held: Vec<u32>,
    /// Bodies of components that end.
    pub(super) leaving: Vec<(u32, Box<Body>)>,
    /// What those keep that end or are replaced, for those that begin.
    estate: Estate,
    /// Components with new values.
    pub(super) updated: Vec<Updated>,
    /// The way to take it back until it is made.
    withdrawal: ChangeWithdrawal,
    /// What the journal has of it once it is made.
    record: Option<&'a ChangeRecord>,
}

/// Kinds of change of a component of the wanted fleet.
#[derive(Clone, Copy)]
enum MemberChange {
    Kept,
    Added(u32),
    Replaced(u32),
}

impl<'a> Change<'a> {
    pub(super) fn new(
        shared: &'a Arc<Shared>,
        withdrawal: ChangeWithdrawal,
        record: Option<&'a ChangeRecord>,
    ) -> Change<'a> {
        Change {
            shared,
            added: Vec::new(),
            displaced: Vec::new(),
            begun: Vec::new(),
            taken: Vec::new(),
            awaited: Vec::new(),
            present: BTreeMap::new(),
            held: Vec::new(),
            leaving: Vec::new(),
            estate: Estate::default(),
            updated: Vec::new(),
            withdrawal,
            record,
        }
    }

    /// Makes the change that a plan describes from one fleet to another. Virtual time stands still meanwhile.
    pub(super) fn make(
        self,
        plan: &ChangePlan,
        wanted: Specs,
        current: &[Option<Arc<ComponentSpec>>],
    ) -> Result<Changed, ChangeError> {
        let shared = self.shared;
        let result = self.make_at_once(plan, wanted, current);
        let mut engine = shared.lock();
        engine.wake |= std::mem::take(&mut engine.is_changing);
        shared.release(engine);
        result
    }

    fn make_at_once(
        mut self,
        plan: &ChangePlan,
        mut wanted: Specs,
        current: &[Option<Arc<ComponentSpec>>],
    ) -> Result<Changed, ChangeError> {
        let order = providers_first(&as_members(&wanted));
        // An instance of another class or site does not go on from the state of the present one.
        let (anew, replaced): (Vec<_>, Vec<_>) = plan.replace.iter().partition(|one| one.is_anew());
        let removed: Vec<u32> =
            plan.remove.iter().chain(anew.iter().map(|one| &one.current)).map(|&one| one as u32).collect();
        self.displaced = anew.iter().map(|one| one.current as u32).collect();
        let mut engine = self.wait_for(&removed, replaced.iter().map(|one| one.current as u32))?;
        if !engine.is_still(current) {
            self.shared.release(engine);
            return Err(ChangeError::Meanwhile);
        }
        let mut member_changes = vec![MemberChange::Kept; wanted.len()];
        let mut numbers = vec![u32::MAX; wanted.len()];
        plan.keep.iter().for_each(|(current, wanted)| numbers[*wanted] = *current as u32);
        plan.update.iter().for_each(|one| numbers[one.wanted] = one.current as u32);
        for one in &replaced {
            numbers[one.wanted] = one.current as u32;
            member_changes[one.wanted] = MemberChange::Replaced(one.current as u32);
        }
        let mut added: Vec<usize> = plan.add.iter().copied().chain(anew.iter().map(|one| one.wanted)).collect();
        added.sort_unstable();
        self.added = engine.number(added.iter().filter_map(|&place| wanted[place].as_ref()));
        for (&place, &number) in added.iter().zip(&self.added) {
            (numbers[place], member_changes[place]) = (number, MemberChange::Added(number));
        }
        let mut is_updated = vec![false; wanted.len()];
        plan.update.iter().for_each(|one| is_updated[one.wanted] = true);
        let is_new = |place: &usize| !matches!(member_changes[*place], MemberChange::Kept) || is_updated[*place];
        for place in (0..wanted.len()).filter(is_new) {
            wanted[place] = wanted[place].take().map(|spec| retargeted(spec, &numbers));
        }
        engine.prepare(self.shared, added.iter().filter_map(|&place| wanted[place].clone()), &self.added);
        engine.publishers = None;
        let replaced: Vec<u32> = replaced.iter().map(|one| one.current as u32).collect();
        self.take_out(&mut engine, &removed, &replaced);
        self.estate = match engine.phase {
            RunPhase::Starting => engine.left_by_earlier_program(),
            _ => self.left_by(&engine, removed.iter().chain(&replaced)),
        };
        engine.leave_to(&self.added, &self.estate);
        self.shared.release(engine);
        for place in order {
            if matches!(member_changes[place], MemberChange::Kept) {
                continue;
            }
            let Some(spec) = wanted[place].take() else { continue };
            let result = match member_changes[place] {
                _ if self.withdrawal.is_withdrawn() => Err(ChangeError::Withdrawn),
                MemberChange::Kept => Ok(()),
                MemberChange::Added(number) => self.begin(number),
                MemberChange::Replaced(number) => self.replace(number, spec),
            };
            if let Err(error) = result {
                self.undo();
                return Err(error);
            }
        }
        // Last, and without code of others in between: a component is away from its fleet for as short as can be.
        for one in &plan.update {
            let Some(spec) = wanted[one.wanted].take() else { continue };
            if let Err(error) = self.update(one.current as u32, spec, one.properties.clone()) {
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
                engine.is_changing = true;
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

    /// Takes the bodies of components that run out of the engine. Others do not start before the change is made.
    fn take_out(&mut self, engine: &mut Engine, removed: &[u32], replaced: &[u32]) {
        for &number in removed {
            if engine.slots[number as usize].is_alive()
                && let Some(body) = engine.take(number)
            {
                self.leaving.push((number, body));
            } else {
                self.hold(engine, number);
            }
        }
        for &number in replaced {
            if engine.slots[number as usize].state == SlotState::Active
                && let Some(body) = engine.take(number)
            {
                self.present.insert(number, body);
            } else {
                self.hold(engine, number);
            }
        }
    }

    /// What components keep that end or are replaced, as it is once none of them runs.
    fn left_by<'n>(&self, engine: &Engine, numbers: impl Iterator<Item = &'n u32>) -> Estate {
        let leaving: BTreeMap<u32, &Body> = self.leaving.iter().map(|(number, body)| (*number, &**body)).collect();
        Estate::of(numbers.filter_map(|number| {
            let slot = &engine.slots[*number as usize];
            let out = leaving.get(number).copied().or_else(|| self.present.get(number).map(|body| &**body));
            Some(&out.or(slot.body.as_deref())?.part)
        }))
    }

    /// Keeps a component that does not run from starting before the change is made.
    pub(super) fn hold(&mut self, engine: &mut Engine, number: u32) {
        engine.slots[number as usize].held = true;
        self.held.push(number);
    }

    /// Constructs and initializes a new component, where it runs from the start.
    fn begin(&mut self, number: u32) -> Result<(), ChangeError> {
        if !self.shared.lock().starts_with_fleet(number) {
            return Ok(());
        }
        let mut result = self.initialize(number);
        let deadline = Instant::now() + WAIT;
        while let Err((culprit, failure)) = &result
            && *culprit == number
            && self.may_try_again(failure, deadline)
        {
            self.clear(number);
            result = self.initialize(number);
        }
        if let Err((culprit, failure)) = &result
            && *culprit == number
            && self.begins_anew(number, failure)
        {
            result = self.initialize(number);
        }
        match result {
            Ok(()) => {
                self.begun.push(number);
                Ok(())
            }
            Err((culprit, failure)) => Err(self.failed(culprit, failure)),
        }
    }

    /// Lets a component that could not go on from what an earlier program saved begin anew. False for others.
    fn begins_anew(&self, number: u32, failure: &Failure) -> bool {
        let mut engine = self.shared.lock();
        let now = engine.time_of_change(self.shared);
        let why = with_library(&engine.slots[number as usize].spec, failure);
        let begins = engine.begin_anew(number, &why, now);
        self.shared.release(engine);
        begins
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
        let is_start = engine.phase == RunPhase::Starting;
        self.shared.release(engine);
        let (body, result) = if is_start {
            // Who waits for the start of a fleet ends it.
            let result = body.perform(self.shared, Job::Start);
            (body, result)
        } else {
            self.perform_within(number, body, Job::Start)?
        };
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
        let Some(mut body) = self.present.remove(&number) else {
            self.awaited.push((number, spec));
            return Ok(());
        };
        let spec = self.shared.look(|engine| engine.still_stopped(number, spec));
        let now = self.shared.clock.now();
        (body.part.now, body.part.due) = (now, now);
        let (mut body, mut result) = body.take_over(self.shared, Arc::clone(&spec), self.estate.clone());
        let deadline = Instant::now() + WAIT;
        while let Err(Refusal::Failed(failure)) = &result
            && self.may_try_again(failure, deadline)
            && let Some(again) = body.take()
        {
            (body, result) = again.take_over(self.shared, Arc::clone(&spec), self.estate.clone());
        }
        let mut engine = self.shared.lock();
        engine.slots[number as usize].held = result.is_ok();
        let name = engine.slots[number as usize].name.to_string();
        match body {
            Some(body) if result.is_ok() => engine.put_back(number, body),
            Some(body) => engine.return_unchanged(number, body, now),
            // It goes on once its code has returned.
            None => {}
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

    pub(super) fn failed(&self, culprit: u32, failure: Failure) -> ChangeError {
        let engine = self.shared.lock();
        let spec = &engine.slots[culprit as usize].spec;
        let library = library_of(spec, failure.message()).map(Into::into);
        ChangeError::Failed { component: spec.path.clone(), class: spec.class.name().to_owned(), library, failure }
    }

    /// Leaves everything as it was.
    fn undo(&mut self) {
        self.undo_updates();
        for number in std::mem::take(&mut self.begun).into_iter().rev() {
            self.take_back(number);
        }
        let mut engine = self.shared.lock();
        let now = engine.time_of_change(self.shared);
        let mut outgoing = Vec::new();
        for (number, predecessor, _) in std::mem::take(&mut self.taken).into_iter().rev() {
            if let Some(mut body) = engine.take(number) {
                outgoing.push(body.give_back(&mut engine.bus, predecessor));
                engine.slots[number as usize].state = SlotState::Active;
                engine.return_unchanged(number, body, now);
            }
        }
        for (number, body) in std::mem::take(&mut self.present).into_iter().chain(self.leaving.drain(..)) {
            engine.return_unchanged(number, body, now);
        }
        for number in self.held.drain(..) {
            engine.let_go(number, now);
        }
        for &number in &self.added {
            engine.leave_topics(number, now);
            engine.forget(number);
        }
        for &number in &self.displaced {
            engine.take_place_again(number, now);
        }
        engine.publishers = None;
        self.shared.release(engine);
        drop_apart(self.shared, outgoing);
    }

    /// Commits the change after all have initialized: their messages are delivered, and removed components shut down.
    fn commit(mut self, removed: &[u32]) -> Result<Changed, ChangeError> {
        let mut engine = self.shared.lock();
        let is_ending = matches!(engine.phase, RunPhase::Stopping | RunPhase::Ended);
        if is_ending || self.withdrawal.is_withdrawn() {
            self.shared.release(engine);
            self.undo();
            return Err(if is_ending { ChangeError::Ending } else { ChangeError::Withdrawn });
        }
        let now = engine.time_of_change(self.shared);
        let begins = engine.phase == RunPhase::Starting;
        if begins {
            self.shared.clock.start();
            engine.phase = RunPhase::Running;
            engine.is_announcing = self.shared.clock.is_virtual();
            // The timer sleeps without a deadline so far. It has to sleep until the end of the run if no component is
            // due.
            engine.wake = true;
        }
        let name = |engine: &Engine, number: u32| engine.slots[number as usize].name.to_string();
        let mut changed = Changed {
            added: self.added.iter().map(|number| name(&engine, *number)).collect(),
            removed: removed.iter().map(|number| name(&engine, *number)).collect(),
            replaced: Vec::new(),
            updated: self.updated.iter().map(|one| name(&engine, one.number)).collect(),
            unfinished: Vec::new(),
            plan: PlannedChanges::default(),
        };
        if let Some(record) = self.record {
            record.is_made(&mut engine, now);
        }
        for &number in &self.begun {
            engine.take_vote(number, now);
        }
        // Before others may keep something under the same names.
        for &number in removed {
            engine.forget_stored(number, now);
        }
        for (_, body) in &mut self.leaving {
            engine.forget_stored_of(&mut body.part, now);
        }
        if begins {
            engine.recall_states();
        }
        for &number in &self.added {
            engine.join(number, now);
        }
        if begins {
            engine.recall_rest(now);
        }
        let mut outgoing = Vec::new();
        for (number, predecessor, done) in self.taken.drain(..) {
            outgoing.extend(engine.commit_takeover(number, predecessor, done, now));
            changed.replaced.push((name(&engine, number), done));
        }
        for (number, spec) in self.awaited.drain(..) {
            engine.await_spec(number, spec, self.estate.clone(), now);
            changed.replaced.push((name(&engine, number), Takeover::Awaited));
        }
        for one in self.updated.drain(..) {
            engine.commit_update(one, now);
        }
        let run: BTreeSet<u32> = self.leaving.iter().map(|(number, _)| *number).collect();
        for &number in removed {
            if !run.contains(&number) {
                engine.leave_topics(number, now);
                engine.forget_vote(number, now);
                engine.forget(number);
            }
        }
        for number in self.held.drain(..) {
            engine.let_go(number, now);
        }
        engine.takers = (None, engine.takers.1 + 1);
        (engine.speakers, engine.publishers) = (None, None);
        engine.end_if_done(now);
        self.shared.release(engine);
        if begins {
            // What happens first is told after the start, whichever thread is faster.
            let mut engine = self.shared.lock();
            (engine.is_announcing, engine.wake) = (false, true);
            self.shared.release(engine);
        }
        drop_apart(self.shared, outgoing);
        self.shut_down_removed(now);
        Ok(changed)
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
