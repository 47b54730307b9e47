//! Changes of a fleet: components end, start and are replaced by a plan, or everything stays as it was.
//!
//! The start of a fleet is the change from an empty one. New instances initialize one after the other, providers before
//! those that call them: at the start on the caller's thread, later on threads that can be left behind. Meanwhile
//! those that they replace and those that end are out of the engine, as if they served a call: the timer never waits.
//! Messages of new instances are held back until all have initialized; then the change is committed at one instant, and
//! the old instances shut down.

mod apart;
mod behind;
mod ending;
mod error;
mod leaving;
mod limits;
mod live;
mod membership;
mod options;
mod planned;
mod record;
mod takeover;
mod transaction;
mod updating;

use std::sync::Arc;
use std::time::Instant;

use saoms_lang::assembly::{Assembly, ComponentSpec};

use self::leaving::{Leave, who_leaves};
use self::limits::Judgement;
use self::record::ChangeRecord;
use self::transaction::{Change, WAIT};
use super::engine::slot::Slot;
use super::shared::Shared;
use crate::assemble::{ChangePlan, Replacement};
use crate::report::PartOfFleet;

pub(crate) use behind::ApartBodies;
pub use error::{ChangeError, StartError};
pub(crate) use leaving::{LEAVING, Leaving};
pub use live::SetError;
pub(crate) use live::changed;
pub use options::{ChangeOptions, ChangeWithdrawal};
pub use planned::{
    HandedOver, PlannedChanges, PlannedDifference, PlannedMember, PlannedRefusal, PlannedReplacement, PlannedValue,
};
pub use takeover::Takeover;

/// A change that was made, by the paths of components.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changed {
    /// Components that joined the fleet.
    pub added: Vec<String>,
    /// Components that ended.
    pub removed: Vec<String>,
    /// Components with new instances.
    pub replaced: Vec<(String, Takeover)>,
    /// Components that go on with new values of live properties.
    pub updated: Vec<String>,
    /// Components that ended before they had finished what they had begun: their time for that was over.
    pub unfinished: Vec<String>,
    /// The plan that was carried out, as it was when the change was made.
    pub plan: PlannedChanges,
}

/// The fleet of each number.
type Specs = Vec<Option<Arc<ComponentSpec>>>;

/// Starts a fleet.
pub(crate) fn start(shared: &Arc<Shared>, wanted: Assembly) -> Result<(), ChangeError> {
    let _one_at_a_time = shared.lock_changes();
    let current = shared.lock().specs();
    let wanted: Specs = {
        let part = PartOfFleet::of(&wanted);
        let mut engine = shared.lock();
        engine.networks.elsewhere.know(part, wanted.elsewhere);
        engine.open_topics_of_others();
        let recalled = |spec| Some(Arc::new(engine.with_recalled_values(spec)));
        wanted.components.into_iter().map(recalled).collect()
    };
    let plan = ChangePlan::between(&as_members(&current), &as_members(&wanted));
    Change::new(shared, ChangeWithdrawal::default(), None).make(&plan, wanted, &current).map(drop)
}

/// What a change to the fleet of an assembly would do.
pub(crate) fn plan(shared: &Arc<Shared>, wanted: &Assembly) -> PlannedChanges {
    Wanted::of(shared, wanted).planned
}

/// Changes the fleet to that of an assembly.
pub(crate) fn apply(shared: &Arc<Shared>, wanted: &Assembly, options: ChangeOptions) -> Result<Changed, ChangeError> {
    let _one_at_a_time = shared.try_lock_changes().ok_or(ChangeError::Busy)?;
    let Wanted { plan, planned, current, .. } = Wanted::of(shared, wanted);
    if !planned.refused.is_empty() {
        let reasons = planned.refused.into_iter().map(|one| one.reason);
        return Err(ChangeError::Refused(reasons.collect()));
    }
    if !options.allow_loss {
        let losses = planned.losses().map(|one| one.component.clone());
        let is_anew = |path: &String| {
            let anew = plan.replace.iter().filter(|one| one.is_anew());
            anew.filter_map(|one| current[one.current].as_ref()).any(|spec| spec.path == *path)
        };
        let (anew, unsaved): (Vec<String>, Vec<String>) = losses.partition(is_anew);
        if !(anew.is_empty() && unsaved.is_empty()) {
            return Err(ChangeError::LosesState { unsaved, anew });
        }
    }
    let (by, keeps) = (options.by.clone(), options.keeps.clone());
    let mut record = ChangeRecord { by, plan: planned, unfinished: Vec::new(), keeps };
    let made = carry_out(shared, wanted, &plan, &options, &mut record);
    record.unless_made(shared, made)
}

/// Makes a change, once those that leave by this plan have finished, or their time for that is over.
fn carry_out(
    shared: &Arc<Shared>,
    wanted: &Assembly,
    plan: &ChangePlan,
    options: &ChangeOptions,
    record: &mut ChangeRecord,
) -> Result<Changed, ChangeError> {
    let leave = Leave::of(shared, who_leaves(plan));
    record.unfinished = leave.wait(options)?;
    let now = Wanted::of(shared, wanted);
    if now.planned != record.plan {
        return Err(ChangeError::Meanwhile);
    }
    let change = Change::new(shared, options.withdrawal.clone(), Some(record));
    let mut changed = change.make(&now.plan, now.specs, &now.current)?;
    leave.finish();
    (changed.plan, changed.unfinished) = (now.planned, record.unfinished.clone());
    Ok(changed)
}

/// A fleet that is wanted, and the way to it.
struct Wanted {
    plan: ChangePlan,
    /// The fleet that is wanted, as its composites describe it.
    specs: Specs,
    /// The fleet from which the plan leads there.
    current: Specs,
    planned: PlannedChanges,
}

impl Wanted {
    fn of(shared: &Arc<Shared>, wanted: &Assembly) -> Wanted {
        let part = PartOfFleet::of(wanted);
        let specs: Specs = wanted.components.iter().map(|spec| Some(Arc::new(spec.clone()))).collect();
        let engine = shared.lock();
        let (current, runs): (Specs, Vec<bool>) = (engine.specs(), engine.slots.iter().map(Slot::is_alive).collect());
        let mut refused = engine.beyond_its_networks(part.as_ref(), &wanted.components);
        // What the fleet itself tells its components is no difference.
        let told = |spec: &Option<Arc<ComponentSpec>>| spec.as_ref().map(|spec| engine.as_told(Arc::clone(spec)));
        let expected: Specs = specs.iter().map(told).collect();
        let elsewhere: Specs = engine.networks.elsewhere.specs().map(|(_, spec)| Some(spec)).collect();
        shared.release(engine);
        let plan = ChangePlan::between(&as_members(&current), &as_members(&expected));
        let judgement = if plan.is_empty() && elsewhere.is_empty() {
            Judgement::default()
        } else {
            // Those of other programs do not change here, and may not have to in those.
            let wanted_elsewhere: Specs = wanted.elsewhere.iter().map(|spec| Some(Arc::new(spec.clone()))).collect();
            Judgement::of(&[&current[..], &elsewhere].concat(), &[expected.clone(), wanted_elsewhere].concat())
        };
        refused.extend(judgement.reasons);
        let deadline = Instant::now() + WAIT;
        let state = |number: usize, saves: bool| match runs.get(number) {
            Some(true) if saves || keeps(shared, number, deadline) => HandedOver::Kept,
            Some(true) => HandedOver::Lost,
            _ => HandedOver::None,
        };
        let planned = PlannedChanges::of(&plan, &current, &expected, state);
        let consequences = if plan.is_empty() { Vec::new() } else { judgement.consequences };
        let planned = PlannedChanges { refused, consequences, ..planned };
        Wanted { plan, specs, current, planned }
    }
}

/// Replaces one component by one of this specification, even if nothing differs. Its task settings stay.
pub(crate) fn replace(shared: &Arc<Shared>, spec: ComponentSpec, by: Option<&str>) -> Result<Takeover, ChangeError> {
    let _one_at_a_time = shared.try_lock_changes().ok_or(ChangeError::Busy)?;
    let current = shared.lock().specs();
    let mut wanted = current.clone();
    let same = |known: &Option<Arc<ComponentSpec>>| known.as_ref().is_some_and(|one| one.path == spec.path);
    let Some((number, known)) = wanted.iter_mut().enumerate().find(|(_, known)| same(known)) else {
        return Err(ChangeError::Unknown(spec.path));
    };
    let task = known.as_ref().and_then(|known| known.task.clone());
    *known = Some(Arc::new(ComponentSpec { task, ..spec }));
    let differences = Vec::new();
    let replace = vec![Replacement { current: number, wanted: number, differences }];
    let others = (0..wanted.len()).filter(|one| *one != number && wanted[*one].is_some());
    let keep = others.map(|one| (one, one)).collect();
    let plan = ChangePlan { replace, keep, ..ChangePlan::default() };
    let record = ChangeRecord::of_replacement(by, &plan, &wanted);
    let change = Change::new(shared, ChangeWithdrawal::default(), Some(&record));
    let changed = record.unless_made(shared, change.make(&plan, wanted, &current))?;
    Ok(changed.replaced.first().map_or(Takeover::Awaited, |(_, done)| *done))
}

/// True if a component has [kept](saoms_api::Context::keep) something, from which a new instance goes on.
fn keeps(shared: &Shared, number: usize, deadline: Instant) -> bool {
    let mut engine = shared.lock();
    loop {
        let body = engine.slots[number].body.as_ref();
        let left = deadline.saturating_duration_since(Instant::now());
        if body.is_some() || left.is_zero() {
            let keeps = body.is_some_and(|body| !body.part.stored.entries().is_empty());
            shared.release(engine);
            return keeps;
        }
        engine = shared.wait_for_return(engine, left);
    }
}

fn as_members(specs: &[Option<Arc<ComponentSpec>>]) -> Vec<Option<&ComponentSpec>> {
    specs.iter().map(Option::as_deref).collect()
}
