//! Taking away what conditions keep away, once all that can be known about it is checked.

use crate::check::fleet::{Fleet, Kind};

/// Removes the components that are not there, and what belongs to them. `checks` is what is found out about each.
pub(crate) fn remove<T>(fleet: &mut Fleet<'_>, checks: &mut Vec<T>) {
    if fleet.units.iter().all(|unit| !unit.is_absent) && fleet.members.iter().all(|member| !member.is_absent) {
        return;
    }
    let is_there: Vec<bool> = fleet.members.iter().map(|member| !member.is_absent).collect();
    let members = places(is_there.iter().copied());
    let units = places(fleet.units.iter().map(|unit| !unit.is_absent));
    for (place, scope) in fleet.scopes.iter_mut().enumerate() {
        scope.owner = scope.owner.and_then(|owner| members[owner]);
        scope.members = scope.members.iter().filter_map(|member| members[*member]).collect();
        scope.by_name = scope.by_name.drain().filter_map(|(name, member)| Some((name, members[member]?))).collect();
        scope.units = scope.units.iter().filter_map(|unit| units[*unit]).collect();
        debug_assert!(place == 0 || scope.owner.is_some() || scope.units.is_empty());
    }
    for group in fleet.groups.values_mut() {
        *group = group.iter().filter_map(|member| members[*member]).collect();
    }
    let absent_wires = fleet.absent_wires.iter();
    fleet.absent_wires =
        absent_wires.filter_map(|(unit, file, element)| Some((units[*unit]?, *file, *element))).collect();
    fleet.members.retain(|member| !member.is_absent);
    fleet.units.retain(|unit| !unit.is_absent);
    for member in &mut fleet.members {
        member.unit = units[member.unit].unwrap_or_default();
        debug_assert!(!matches!(member.kind, Kind::Composite(scope) if fleet.scopes[scope].owner.is_none()));
    }
    let mut is_there = is_there.into_iter();
    checks.retain(|_| is_there.next().unwrap_or_default());
}

/// The place of each among those that stay.
fn places(stays: impl Iterator<Item = bool>) -> Vec<Option<usize>> {
    let mut next = 0;
    let place = |stays: bool| {
        next += usize::from(stays);
        stays.then(|| next - 1)
    };
    stays.map(place).collect()
}
