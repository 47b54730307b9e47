//! Components that are to leave the fleet finish what they have begun, before anything changes.
//!
//! A class that wants to be asked has a live property `leaving`. While it is true, a component begins nothing new, and
//! votes in each execution whether work of its own is left. Once all who leave say that none is, or their time is over,
//! the change is made: one that has not finished hands over what it can when it shuts down. If the change fails, they
//! are called back with the value `false`.

use std::fmt;
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::host::declaration::PropertyKind;
use saoms_api::{Cause, Level};
use saoms_lang::assembly::ComponentSpec;

use super::transaction::WAIT;
use super::{ChangeError, ChangeOptions};
use crate::assemble::ChangePlan;
use crate::observe::Occurrence;
use crate::schedule::engine::slot::{Slot, SlotState};
use crate::schedule::engine::{Engine, RunPhase};
use crate::schedule::settings::nanos;
use crate::schedule::shared::Shared;
use crate::schedule::stop::STOPPED;

/// The property by which a component hears that it is to leave.
pub(crate) const LEAVING: &str = "leaving";

/// The time between two looks at those who leave.
const LOOK: Duration = Duration::from_millis(10);

/// The real time after which a run that pauses is not waited for: its time stands still.
const STANDSTILL: Duration = Duration::from_secs(1);

/// What a component knows of its leaving, and what it says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) enum Leaving {
    /// It stays.
    #[default]
    Not,
    /// It is told between two of its executions.
    Told,
    /// It has something to finish.
    Finishing,
    /// It has finished.
    Finished,
    /// It refuses, for this reason.
    Refused(Box<str>),
    /// It is told between two of its executions that it stays.
    CalledBack,
}

impl Leaving {
    /// Takes in whether a component sees work left.
    pub(crate) fn note(&mut self, is_left: bool) {
        if matches!(self, Leaving::Finishing | Leaving::Finished) {
            *self = if is_left { Leaving::Finishing } else { Leaving::Finished };
        }
    }

    /// Takes in that a component has failed, and will start again: what it said does not hold for its next instance.
    pub(crate) fn begins_again(&mut self) {
        if *self == Leaving::Finished {
            *self = Leaving::Finishing;
        }
    }

    /// Takes in what a component that was told answers.
    pub(crate) fn answer(&mut self, value: &str, refusal: Option<&impl fmt::Display>) {
        *self = match (value == "true", refusal) {
            (true, None) => Leaving::Finishing,
            (true, Some(refusal)) => Leaving::Refused(refusal.to_string().into()),
            (false, _) => Leaving::Not,
        };
    }
}

/// True if components of this specification are asked to finish before they leave.
fn hears_leaving(spec: &ComponentSpec) -> bool {
    let declared = spec.class.declaration().property(LEAVING);
    declared.is_some_and(|one| one.live && one.kind == PropertyKind::Boolean)
}

/// The components that were asked to finish; called back when it is dropped before they have left.
pub(super) struct Leave<'a> {
    shared: &'a Shared,
    components: Vec<u32>,
}

impl<'a> Leave<'a> {
    /// Asks those of the components that run and want to be asked.
    pub(super) fn of(shared: &'a Shared, components: impl Iterator<Item = u32>) -> Leave<'a> {
        let mut engine = shared.lock();
        let asked = |index: &u32| {
            let slot = &engine.slots[*index as usize];
            matches!(slot.state, SlotState::Starting | SlotState::Active) && hears_leaving(&slot.spec)
        };
        let components: Vec<u32> = components.filter(asked).collect();
        components.iter().for_each(|index| engine.tell_leaving(*index, true, shared.clock.now()));
        shared.release(engine);
        Leave { shared, components }
    }

    /// Waits until all have finished, or for the time of the run that the options give them; gives the paths of those
    /// that have not.
    pub(super) fn wait(&self, options: &ChangeOptions) -> Result<Vec<String>, ChangeError> {
        if self.components.is_empty() {
            return Ok(Vec::new());
        }
        let deadline = self.shared.clock.now().saturating_add(nanos(options.wait));
        let asked = Instant::now();
        let mut moved = asked;
        loop {
            if options.withdrawal.is_withdrawn() {
                return Err(ChangeError::Withdrawn);
            }
            let engine = self.shared.lock();
            if matches!(engine.phase, RunPhase::Stopping | RunPhase::Ended) {
                return Err(ChangeError::Ending);
            }
            let now = self.shared.clock.now();
            if !engine.stands_still(now) {
                moved = Instant::now();
            }
            // Whoever does not run any more has nothing to finish; one that waits for its restart may have.
            let runs = |slot: &Slot| matches!(slot.state, SlotState::Starting | SlotState::Active | SlotState::Leaving);
            let slots = self.components.iter().map(|index| &engine.slots[*index as usize]);
            let slots = slots.filter(|slot| runs(slot) && slot.leaving != Leaving::Finished);
            let refusal = slots.clone().find_map(|slot| match &slot.leaving {
                Leaving::Refused(why) => Some((slot.name.to_string(), format!("it does not leave: {why}"))),
                _ => None,
            });
            // One that has not heard of it yet may refuse.
            let have_heard = slots.clone().all(|slot| slot.leaving != Leaving::Told) || asked.elapsed() > WAIT;
            let mut unfinished = slots.map(|slot| slot.name.to_string()).peekable();
            let component = unfinished.peek().cloned();
            let left = component.is_none() || now >= deadline && have_heard;
            let left = left.then(|| unfinished.collect());
            self.shared.release(engine);
            if let Some((component, why)) = refusal {
                return Err(ChangeError::NotNow { component, why });
            }
            if let Some(unfinished) = left {
                return Ok(unfinished);
            }
            if let Some(component) = component.filter(|_| moved.elapsed() > STANDSTILL) {
                let why = "it cannot finish what it has begun while the time of the run stands still".to_owned();
                return Err(ChangeError::NotNow { component, why });
            }
            sleep(LOOK);
        }
    }

    /// Lets them leave.
    pub(super) fn finish(mut self) {
        self.components.clear();
    }
}

impl Drop for Leave<'_> {
    fn drop(&mut self) {
        if self.components.is_empty() {
            return;
        }
        let mut engine = self.shared.lock();
        for index in std::mem::take(&mut self.components) {
            engine.tell_leaving(index, false, self.shared.clock.now());
        }
        self.shared.release(engine);
    }
}

impl Engine {
    /// Has a component told that it is to leave, or that it stays.
    fn tell_leaving(&mut self, index: u32, leaves: bool, now: u64) {
        let slot = &mut self.slots[index as usize];
        if !leaves && matches!(slot.leaving, Leaving::Not | Leaving::Refused(_)) {
            slot.leaving = Leaving::Not;
            return;
        }
        slot.leaving = if leaves { Leaving::Told } else { Leaving::CalledBack };
        let text = if leaves { "leaves, once it has finished what it has begun" } else { "is called back, and stays" };
        self.emit(now, index, Occurrence::Log { level: Level::Info, text: text.to_owned() });
        self.queue_told(index, LEAVING, leaves, Cause::default());
        self.look_at = 0;
        self.wake |= self.roles.asleep_until != 0;
    }

    /// True if a fleet is still as it was, but for what it tells its components itself.
    pub(super) fn is_still(&self, before: &[Option<Arc<ComponentSpec>>]) -> bool {
        let own = |spec: &&(_, _)| spec.0 != LEAVING && spec.0 != STOPPED;
        let is_same = |slot: &Slot, before: &Option<Arc<ComponentSpec>>| match before {
            Some(before) if slot.is_member() => {
                Arc::ptr_eq(before, &slot.spec)
                    || before.values.iter().filter(own).eq(slot.spec.values.iter().filter(own))
            }
            Some(_) => false,
            None => !slot.is_member(),
        };
        self.slots.len() == before.len() && self.slots.iter().zip(before).all(|(slot, before)| is_same(slot, before))
    }

    /// The specification that a component of the wanted fleet has if nothing of it changes: it may be stopped, and one
    /// that has just been called back is as it was, although it may not know that yet.
    pub(super) fn as_told(&self, spec: Arc<ComponentSpec>) -> Arc<ComponentSpec> {
        let Some(&number) = self.numbers.get(spec.path.as_str()) else { return spec };
        let spec = self.still_stopped(number, spec);
        let slot = &self.slots[number as usize];
        if slot.leaving == Leaving::Not || slot.spec.class.name() != spec.class.name() {
            return spec;
        }
        let found = slot.spec.values.iter().find(|(name, _)| name == LEAVING);
        let Some(value) = found.map(|(_, value)| value.clone()) else { return spec };
        let mut spec = Arc::unwrap_or_clone(spec);
        match spec.values.iter_mut().find(|(name, _)| name == LEAVING) {
            Some((_, own)) => *own = value,
            None => spec.values.push((LEAVING.into(), value)),
        }
        Arc::new(spec)
    }
}

/// The numbers of those who would leave.
pub(super) fn who_leaves(plan: &ChangePlan) -> impl Iterator<Item = u32> {
    let anew = plan.replace.iter().filter(|one| one.is_anew());
    plan.remove.iter().copied().chain(anew.map(|one| one.current)).map(|number| number as u32)
}
