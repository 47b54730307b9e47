//! Multiplicities of references, and whose targets count.

use super::promotion::ReferenceId;
use crate::check::fleet::Fleet;
use crate::model::{Multiplicity, ReferenceElement};
use crate::source::Located;

/// True if the targets of a reference stay when a composite that promotes it gives others (SCA Assembly 1.1, 4.3.1):
/// only with `nonOverridable`. In SCA 1.0 those of a reference that takes several do.
pub(crate) fn keeps_own(fleet: &Fleet<'_>, (member, _): ReferenceId<'_>, reference: Option<&ReferenceElement>) -> bool {
    let Some(reference) = reference else { return false };
    if reference.non_overridable().is_some_and(|fixed| fixed.value) {
        return true;
    }
    let is_many = reference.multiplicity().is_some_and(|given| given.value.is_many());
    !fleet.members[member].composite.version.is_1_1() && is_many
}

impl Fleet<'_> {
    /// The number of targets a reference of a component can have that a composite implements.
    pub(crate) fn multiplicity_of(&self, place: ReferenceId<'_>) -> Multiplicity {
        self.given_multiplicity(place).map_or(Multiplicity::One, |given| given.value)
    }

    /// The multiplicity that the component or the composite that implements it writes.
    pub(crate) fn given_multiplicity(&self, (member, name): ReferenceId<'_>) -> Option<&Located<Multiplicity>> {
        let own = self.members[member].component.reference(name);
        let inner = self.inner(member).and_then(|inner| inner.references().find(|one| one.name == name));
        [own, inner].into_iter().flatten().find_map(|one| one.multiplicity())
    }
}
