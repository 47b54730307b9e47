//! Changes of a fleet: components end, start and are replaced by a plan, or everything stays as it was.
//!
//! The start of a fleet is the change from an empty one. New instances initialize on the caller's thread, providers
//! before those that call them, while those that they replace and those that end are out of the engine, as if they
//! served a call: the timer never waits. Messages of new instances are held back until all have initialized; then the
//! change is committed at one instant, and the old instances shut down.

mod error;
mod live;
mod membership;
mod takeover;
mod transaction;

use std::sync::Arc;

use saoms_lang::assembly::{Assembly, ComponentSpec};

use self::transaction::Change;
use super::shared::Shared;
use crate::assemble::{ChangePlan, Replacement};
use crate::report::PartOfFleet;

pub use error::{ChangeError, StartError};
pub use live::SetError;
pub(crate) use live::changed;
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
}

/// Changes the fleet to that of an assembly.
pub(crate) fn apply(shared: &Arc<Shared>, wanted: Assembly) -> Result<Changed, ChangeError> {
    let _one_at_a_time = shared.lock_changes();
    let current = shared.lock().specs();
    let wanted: Vec<_> = {
        let part = PartOfFleet::of(&wanted);
        let mut engine = shared.lock();
        engine.networks.elsewhere.know(part, wanted.elsewhere);
        engine.open_topics_of_others();
        let mut recalled = |spec| {
            let spec = engine.with_recalled_values(spec);
            engine.still_stopped(spec)
        };
        wanted.components.into_iter().map(|spec| Some(Arc::new(recalled(spec)))).collect()
    };
    let plan = ChangePlan::between(&as_members(&current), &as_members(&wanted));
    Change::new(shared).make(&plan, wanted)
}

/// Replaces one component by one of this specification, even if nothing differs. Its task settings stay.
pub(crate) fn replace(shared: &Arc<Shared>, spec: ComponentSpec) -> Result<Takeover, ChangeError> {
    let _one_at_a_time = shared.lock_changes();
    let mut wanted = shared.lock().specs();
    let same = |known: &Option<Arc<ComponentSpec>>| known.as_ref().is_some_and(|one| one.path == spec.path);
    let Some((number, known)) = wanted.iter_mut().enumerate().find(|(_, known)| same(known)) else {
        return Err(ChangeError::Unknown(spec.path));
    };
    let task = known.as_ref().and_then(|known| known.task.clone());
    let spec = shared.lock().still_stopped(spec);
    *known = Some(Arc::new(ComponentSpec { task, ..spec }));
    let differences = Vec::new();
    let replace = vec![Replacement { current: number, wanted: number, differences }];
    let others = (0..wanted.len()).filter(|one| *one != number && wanted[*one].is_some());
    let keep = others.map(|one| (one, one)).collect();
    let changed = Change::new(shared).make(&ChangePlan { replace, keep, ..ChangePlan::default() }, wanted)?;
    Ok(changed.replaced.first().map_or(Takeover::Awaited, |(_, done)| *done))
}

fn as_members(specs: &[Option<Arc<ComponentSpec>>]) -> Vec<Option<&ComponentSpec>> {
    specs.iter().map(Option::as_deref).collect()
}
