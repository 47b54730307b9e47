//! Conditions of components, includes and wires, evaluated while composites are unfolded.

mod included;
mod known;

use std::rc::Rc;

pub(crate) use known::UnitProperties;

use crate::check::fleet::Unit;
use crate::check::report::Report;
use crate::check::unfolding::expression_scope::Names;
use crate::check::unfolding::replica::{Instance, all_complex_texts};
use crate::check::unfolding::replica_plan::{condition, report_fault};
use crate::check::unfolding::{MOST_MEMBERS, Unfolding};
use crate::diagnostic::{Diagnostic, codes};
use crate::expression::{ExpressionFault, render};
use crate::model::{ComponentElement, Composite, Origin};
use crate::source::Text;

/// True if a component is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Presence {
    There,
    /// A condition keeps it away.
    Absent,
    /// Its condition has a fault, which is reported.
    Unknown,
}

impl Presence {
    pub(crate) const fn of(is_there: bool) -> Self {
        if is_there { Self::There } else { Self::Absent }
    }
}

impl<'a> Unfolding<'a> {
    /// The scope of expressions in a unit.
    pub(crate) fn names(&mut self, unit: usize) -> Rc<Names> {
        if let Some(Some(names)) = self.fleet.names.get(unit) {
            return Rc::clone(names);
        }
        let owner = self.fleet.scopes[self.fleet.units[unit].scope].owner;
        if let Some(owner) = owner {
            self.names(self.fleet.members[owner].unit);
        }
        if self.fleet.names.len() <= unit {
            self.fleet.names.resize(unit + 1, None);
            self.known.resize_with(unit + 1, || None);
        }
        let included = self.included(unit, owner);
        let names = Rc::new(self.names_in(&included, unit, owner));
        self.fleet.names[unit] = Some(Rc::clone(&names));
        names
    }

    /// The scope of expressions in a unit of these composites.
    fn names_in(&mut self, composites: &[&'a Composite], unit: usize, owner: Option<usize>) -> Names {
        self.known[unit] = Some(UnitProperties::of(composites, owner));
        let component = owner.map(|owner| self.fleet.members[owner].component);
        Names::of(composites, component, &|name| self.supplied(unit, name))
    }

    /// True if a condition in a unit is true; `None` for a faulty one, which is reported.
    pub(crate) fn holds(&mut self, text: &Text, unit: usize, report: &mut Report<'_>) -> Option<bool> {
        let names = self.names(unit);
        let holds = condition(text, &names, &mut |name| names.value(name), report);
        if holds.is_none() {
            self.fault(unit);
        }
        holds
    }

    /// True if an include or a wire in a unit is there. With a faulty condition it is not.
    pub(crate) fn is_there(
        &mut self,
        condition: Option<&Text>,
        origin: Origin,
        unit: usize,
        report: &mut Report<'_>,
    ) -> bool {
        let Some(condition) = condition else { return true };
        let holds = self.holds(condition, unit, report);
        if holds.is_none() {
            // Names that lead nowhere may be those of its components.
            self.miss(unit, "*".to_owned());
        }
        let is_there = holds.unwrap_or(false);
        *self.fleet.conditional.entry((origin.file(), origin.element)).or_default() |= is_there;
        is_there
    }

    /// Finds the wires of a composite that conditions keep away.
    pub(crate) fn wires(&mut self, composite: &'a Composite, unit: usize, report: &mut Report<'_>) {
        for wire in &composite.wires {
            if !self.is_there(wire.condition(), wire.origin, unit, report) {
                self.fleet.absent_wires.insert((unit, wire.origin.file(), wire.origin.element));
            }
        }
    }

    /// A unit of its own for a composite that is included in `unit` and kept away.
    pub(crate) fn absent_unit(&mut self, unit: usize) -> usize {
        let Unit { scope, composites, .. } = &self.fleet.units[unit];
        let absent = Unit { scope: *scope, composites: composites.clone(), is_absent: true };
        self.fleet.units.push(absent);
        self.fleet.units.len() - 1
    }

    /// Remembers that parts of a unit are not as they are meant.
    pub(crate) fn fault(&mut self, unit: usize) {
        let scope = self.fleet.units[unit].scope;
        self.fleet.scopes[scope].is_faulty = true;
    }

    /// Remembers that components of a unit with names like this could not be made.
    pub(crate) fn miss(&mut self, unit: usize, pattern: String) {
        self.fault(unit);
        let scope = self.fleet.units[unit].scope;
        self.fleet.scopes[scope].missing.push(pattern);
    }

    /// Reports faults in the texts of a replica.
    pub(crate) fn faults(&self, names: &Names, faults: Vec<(Text, ExpressionFault)>, report: &mut Report<'_>) {
        for faults in faults.chunk_by(|(one, _), (other, _)| one.location == other.location) {
            let parts = report.parts(&faults[0].0);
            for (text, fault) in faults {
                report_fault(text, &parts, fault, names, report);
            }
        }
    }

    /// True if complex values of a replicated component have faults, which are reported.
    pub(crate) fn complex(&self, component: &ComponentElement, instance: &Instance, report: &mut Report<'_>) -> bool {
        let Some(open) = self.open.last() else { return false };
        let mut has_faults = false;
        for text in all_complex_texts(component, &open.composite.document) {
            let faults = render(&text, &mut |name| instance.value(name)).err().unwrap_or_default();
            if faults.is_empty() {
                continue;
            }
            has_faults = true;
            let parts = report.parts(&text);
            for fault in &faults {
                report_fault(&text, &parts, fault, &instance.names, report);
            }
        }
        has_faults
    }

    /// True if the fleet is as large as one can be. That is reported.
    pub(crate) fn is_beyond(&mut self, component: &ComponentElement, report: &mut Report<'_>) -> bool {
        let is_beyond = self.fleet.members.len() >= MOST_MEMBERS;
        if is_beyond && !std::mem::replace(&mut self.is_full, true) {
            let message = format!("replicas and composites in them come to more than {MOST_MEMBERS} components");
            let one = Diagnostic::new(&codes::FLEET_TOO_LARGE, component.name.location, message);
            report.push(one.help("replicas of composites with replicas multiply: is this what is meant?"));
        }
        is_beyond
    }
}
