//! What crates of components say of changes: what may not change while a fleet runs, and what follows of what may.

use std::collections::BTreeSet;
use std::sync::Arc;

use saoms_api::extension::{ChangeConsequence, ChangeLimit};
use saoms_api::rule::FleetView;
use saoms_lang::assembly::{Assembly, ComponentSpec, seen};

use super::planned::PlannedRefusal;

/// The judgement of crates of components on a change, about all sites.
#[derive(Default)]
pub(super) struct Judgement {
    /// The reasons against it.
    pub(super) reasons: Vec<PlannedRefusal>,
    /// What follows of it.
    pub(super) consequences: Vec<String>,
}

impl Judgement {
    pub(super) fn of(current: &[Option<Arc<ComponentSpec>>], wanted: &[Option<Arc<ComponentSpec>>]) -> Judgement {
        let sites: BTreeSet<&str> = current.iter().flatten().map(|spec| spec.site.as_str()).collect();
        let mut judgement = Judgement::default();
        for site in sites {
            let [current, wanted] = [current, wanted].map(|fleet| part(fleet, site));
            seen(&current, "", |present| seen(&wanted, "", |wanted| judgement.look(present, wanted)));
        }
        judgement
    }

    fn look(&mut self, present: &FleetView<'_>, wanted: &FleetView<'_>) {
        let objections = ChangeLimit::linked().flat_map(|limit| (limit.judge)(present, wanted));
        self.reasons.extend(objections.map(PlannedRefusal::from));
        self.consequences.extend(ChangeConsequence::linked().flat_map(|one| (one.tell)(present, wanted)));
    }
}

/// The components of a site, whose wires lead to each other.
fn part(fleet: &[Option<Arc<ComponentSpec>>], site: &str) -> Assembly {
    let is_of_site = |spec: &&Arc<ComponentSpec>| spec.site.as_str() == site;
    let mut places = vec![None; fleet.len()];
    let members = fleet.iter().enumerate().filter(|(_, spec)| spec.as_ref().is_some_and(|spec| is_of_site(&spec)));
    for (place, (number, _)) in members.enumerate() {
        places[number] = Some(place);
    }
    let mut components: Vec<ComponentSpec> =
        fleet.iter().flatten().filter(is_of_site).map(|spec| (**spec).clone()).collect();
    for wire in components.iter_mut().flat_map(|spec| &mut spec.references) {
        wire.targets.retain_mut(|target| {
            let place = places.get(target.component).copied().flatten();
            target.component = place.unwrap_or_default();
            place.is_some()
        });
    }
    Assembly { components, ..Assembly::default() }
}
