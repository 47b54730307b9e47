//! Conditions of components, includes and wires, evaluated while composites are unfolded, and the composites that the
//! expressions of a unit see: what is included by a condition may declare what another one declares that is there in
//! place of it.

use std::rc::Rc;

use crate::check::fleet::Unit;
use crate::check::judged::{Faulty, Judged};
use crate::check::unfolding::Unfolding;
use crate::check::unfolding::replica_plan::{condition, report_faults};
use crate::check::values::expression_scope::Names;
use crate::check::values::replica::{Instance, all_complex_texts};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::expression::{ExpressionFault, boolean, parse, render};
use crate::limits::{COMPONENTS, CONDITION_ROUNDS};
use crate::model::{ComponentElement, Composite, Contribution, Include, Link, Origin};
use crate::source::{Location, Text};

/// Composites in the order in which their properties count.
struct Included<'a> {
    contribution: &'a Contribution,
    all: Vec<&'a Composite>,
    /// Includes of these by a condition that is not decided.
    open: Vec<&'a Include>,
}

/// Presence of a component.
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

impl<'a> Unfolding<'a, '_, '_> {
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
        }
        let included = self.included(unit, owner);
        let names = Rc::new(self.names_in(&included, unit, owner));
        self.fleet.names[unit] = Some(Rc::clone(&names));
        names
    }

    /// The scope of expressions in a unit of these composites. What is wrong with the values of their properties is
    /// reported when the whole fleet is known.
    fn names_in(&mut self, composites: &[&'a Composite], unit: usize, owner: Option<usize>) -> Names {
        let mut dropped = Diagnostics::new();
        let report = &mut self.report.dropped(&mut dropped);
        let owner = owner.map(|owner| &self.fleet.members[owner]);
        self.parameters.declare(unit, (composites, false), owner, report);
        let component = owner.map(|owner| owner.component);
        let faulty = &self.fleet.faulty_values;
        Names::of(composites, component, faulty, &mut |name| self.parameters.taken_whole(unit, name, report))
    }

    /// The composites of a unit and of what it includes: those that are there, and in a unit that is kept away then
    /// also those that conditions keep away, whose parts name their properties.
    fn included(&mut self, unit: usize, owner: Option<usize>) -> Vec<&'a Composite> {
        let main = self.fleet.units[unit].main();
        let mut included = Included { contribution: self.fleet.contribution, all: vec![main], open: Vec::new() };
        included.follow_all(0);
        let mut absent: Vec<&'a Include> = Vec::new();
        for _ in 0..CONDITION_ROUNDS {
            let open = std::mem::take(&mut included.open);
            let (count, before) = (open.len(), included.all.len());
            if open.is_empty() {
                break;
            }
            let names = self.names_in(&included.all, unit, owner);
            for include in open {
                let Some(condition) = &include.condition else { continue };
                match parse(condition).and_then(|one| boolean(&one, &mut |name| names.value(name))) {
                    Ok(true) => included.follow(include),
                    Ok(false) => absent.push(include),
                    // It may ask for what another one declares.
                    Err(_) => included.open.push(include),
                }
            }
            if included.all.len() == before && included.open.len() == count {
                break;
            }
        }
        if self.fleet.units[unit].is_absent {
            absent.extend(std::mem::take(&mut included.open));
            let mut next = 0;
            while let Some(include) = absent.get(next).copied() {
                next += 1;
                included.follow(include);
                absent.append(&mut included.open);
            }
        }
        included.all
    }

    /// True if a condition in a unit is true.
    pub(crate) fn holds(&mut self, text: &Text, unit: usize) -> Judged<bool> {
        let names = self.names(unit);
        let holds = condition(text, &names, &mut |name| names.value(name), self.report);
        if holds.is_err() {
            self.fault(unit);
        }
        holds
    }

    /// True if an include or a wire in a unit is there. With a faulty condition it is not.
    pub(crate) fn is_there(&mut self, condition: Option<&Text>, origin: Origin, unit: usize) -> bool {
        let Some(condition) = condition else { return true };
        let holds = self.holds(condition, unit);
        if holds.is_err() {
            // Names that lead nowhere may be those of its components.
            self.miss(unit, "*".to_owned());
        }
        let is_there = holds.unwrap_or(false);
        *self.fleet.conditional.entry((origin.file(), origin.element)).or_default() |= is_there;
        is_there
    }

    /// Finds the wires of a composite that conditions keep away.
    pub(crate) fn wires(&mut self, composite: &'a Composite, unit: usize) {
        for wire in &composite.wires {
            if !self.is_there(wire.condition.as_ref(), wire.origin, unit) {
                self.fleet.absent_wires.insert((unit, wire.origin.file(), wire.origin.element));
            }
        }
    }

    /// A unit of its own for a composite that is included in `unit` and kept away.
    pub(crate) fn absent_unit(&mut self, unit: usize) -> usize {
        let Unit { scope, ref composites, hides_names, .. } = self.fleet.units[unit];
        let absent = Unit { scope, composites: composites.clone(), is_absent: true, hides_names };
        self.fleet.units.push(absent);
        self.fleet.units.len() - 1
    }

    /// Remembers that parts of a unit are not as they are meant.
    pub(crate) fn fault(&mut self, unit: usize) {
        let scope = self.fleet.units[unit].scope;
        self.fleet.scopes[scope].fault = Some(Faulty);
    }

    /// Remembers that components of a unit with names like this could not be made.
    pub(crate) fn miss(&mut self, unit: usize, pattern: String) {
        self.fault(unit);
        let scope = self.fleet.units[unit].scope;
        self.fleet.scopes[scope].missing.push(pattern);
    }

    /// Reports faults in the texts of a replica.
    pub(crate) fn faults(&mut self, names: &Names, faults: &[(Text, Vec<ExpressionFault>)]) {
        for (text, faults) in faults {
            report_faults(text, faults, names, self.report);
        }
    }

    /// True if complex values of a replicated component have faults, which are reported.
    pub(crate) fn complex(&mut self, component: &ComponentElement, instance: &Instance) -> bool {
        let Some(open) = self.open.last() else { return false };
        let texts = all_complex_texts(component, &open.composite.document).into_iter();
        let faulty = texts.filter_map(|text| Some((render(&text, &mut |name| instance.value(name)).err()?, text)));
        let faulty: Vec<_> = faulty.map(|(faults, text)| (text, faults)).collect();
        self.faults(&instance.names, &faulty);
        !faulty.is_empty()
    }

    /// True if the fleet is as large as one can be. That is reported.
    pub(crate) fn is_beyond(&mut self, component: &ComponentElement) -> bool {
        let is_beyond = self.fleet.members.len() >= COMPONENTS;
        if is_beyond {
            let message = format!("the replicas have more than {COMPONENTS} components in all");
            let help = "use fewer replicas: replicas inside a replicated composite multiply";
            self.too_large(component.name.location, message, help);
        }
        is_beyond
    }

    /// Reports that the fleet is too large, once.
    pub(crate) fn too_large(&mut self, at: Location, message: String, help: &str) {
        if !std::mem::replace(&mut self.is_full, true) {
            self.report.push(Diagnostic::new(&codes::FLEET_TOO_LARGE, at, message).help(help));
        }
    }
}

impl<'a> Included<'a> {
    /// Adds what an include leads to, with what that includes in any case.
    fn follow(&mut self, include: &'a Include) {
        let known = self.all.len();
        self.add(include);
        self.follow_all(known);
    }

    /// Adds what composites from a place on include in any case.
    fn follow_all(&mut self, mut next: usize) {
        while let Some(composite) = self.all.get(next).copied() {
            next += 1;
            for include in &composite.includes {
                match include.condition {
                    Some(_) => self.open.push(include),
                    None => self.add(include),
                }
            }
        }
    }

    fn add(&mut self, include: &Include) {
        let Some(Link::To(place)) = self.contribution.link(include.origin) else { return };
        let composite = &self.contribution.composites()[*place];
        if !self.all.iter().any(|known| std::ptr::eq(*known, composite)) {
            self.all.push(composite);
        }
    }
}
