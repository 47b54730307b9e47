//! Wiring: the resolver of references to services.
//!
//! A reference of a component of a class collects its targets from the inside out: those of its own component, and
//! those of every component around it that a composite's reference promotes it to.

pub(crate) mod autowire;
pub(crate) mod budget;
pub(crate) mod call_cycle;
pub(crate) mod cycles;
pub(crate) mod dangling_names;
mod ends;
pub(crate) mod misread_uri;
pub(crate) mod multiplicity;
pub(crate) mod offer;
pub(crate) mod promoted_interface;
pub(crate) mod promoted_multiplicity;
pub(crate) mod promotion;
pub(crate) mod replica_index;
pub(crate) mod target;
#[cfg(test)]
mod tests;
pub(crate) mod too_many;
pub(crate) mod unwired;
pub(crate) mod uri;
pub(crate) mod wire;

use std::collections::{HashMap, HashSet};

use crate::check::fleet::Fleet;
use crate::check::options::Options;
use crate::check::report::Report;
use crate::check::rules::multiplicity::of_class;
use crate::check::wiring::autowire::Autowire;
use crate::check::wiring::budget::WireBudget;
use crate::check::wiring::call_cycle::CallCycles;
use crate::check::wiring::dangling_names::DanglingNames;
use crate::check::wiring::ends::{End, Ends, is_several};
use crate::check::wiring::promotion::{Promoted, ReferenceId};
use crate::check::wiring::target::{Provider, target};
use crate::check::wiring::wire::{Wire, wires};
use crate::diagnostic::Severity;
use crate::model::Multiplicity;
use crate::registry::ReferenceDeclaration;
use too_many::TooMany;

/// The targets of a reference.
pub(crate) enum Targets {
    /// These services.
    Known(Vec<Provider>),
    /// Services that a fault keeps from being known, which is reported, or that are taken as given.
    Unknown,
}

impl Targets {
    /// The services that are known.
    pub(crate) fn providers(&self) -> &[Provider] {
        match self {
            Self::Known(providers) => providers,
            Self::Unknown => &[],
        }
    }

    /// True if its services are not known.
    pub(crate) fn is_unknown(&self) -> bool {
        matches!(self, Self::Unknown)
    }
}

/// The targets of every reference of every component, in the order of the class.
pub(crate) struct Wiring(Vec<Vec<Targets>>);

impl Wiring {
    /// The targets of each reference of a component.
    pub(crate) fn of(&self, member: usize) -> &[Targets] {
        &self.0[member]
    }
}

/// Resolves all targets and wires, and checks what they come to.
pub(crate) fn check(fleet: &Fleet<'_>, promoted: &Promoted<'_>, options: &Options, report: &mut Report<'_>) -> Wiring {
    let room = WireBudget::default();
    let (mut wires, dangling) = wires(fleet, options, &room, report);
    // They are looked up by the names of their references.
    wires.values_mut().for_each(|wires| wires.sort_by_key(|wire| wire.name));
    let autowire = Autowire::default();
    let mut all = Wires { fleet, options, promoted, wires, dangling, autowire, room };
    let mut circles = CallCycles::default();
    let mut wiring = Vec::with_capacity(fleet.members.len());
    for member in 0..fleet.members.len() {
        report.about(&fleet.members[member]);
        let Some(class) = fleet.class_of(member) else {
            all.given(member, report);
            wiring.push(Vec::new());
            continue;
        };
        let references = class.references.iter().map(|&declared| {
            let Some(ends) = all.of_class(member, declared, report) else { return Targets::Unknown };
            for end in &ends {
                circles.add(member, &declared.name, end.provider, end.place, fleet);
            }
            Targets::Known(ends.into_iter().map(|end| end.provider).collect())
        });
        wiring.push(references.collect());
    }
    report.about_all();
    circles.check(fleet, report);
    Wiring(wiring)
}

struct Wires<'f, 'a> {
    fleet: &'f Fleet<'a>,
    options: &'f Options,
    promoted: &'f Promoted<'f>,
    wires: HashMap<usize, Vec<Wire<'f>>>,
    dangling: DanglingNames<'f>,
    autowire: Autowire<'f>,
    room: WireBudget,
}

impl<'f, 'a> Wires<'f, 'a> {
    /// The ends of a reference of a component of a class, each provider once; `None` where they are not known. What is
    /// wrong with them is reported.
    fn of_class(
        &mut self,
        member: usize,
        declared: &'f ReferenceDeclaration,
        report: &mut Report<'_>,
    ) -> Option<Vec<End>> {
        let place = (member, declared.name.as_str());
        let Ends { mut all, is_unknown } = self.ends(place, &declared.interface, report);
        if is_unknown {
            return None;
        }
        let multiplicity = self.multiplicity(place, declared);
        match all[..] {
            [] if self.unwired(place, declared, report) => return None,
            [first, second, ..] if !multiplicity.is_many() && is_several(&all) => {
                let is_again = all.iter().all(|end| end.provider == first.provider);
                // In SCA 1.0 a warning: it leads to one service all the same.
                let is_1_1 = self.fleet.members[member].composite.version.is_1_1();
                let severity = if is_again && !is_1_1 { Severity::Warning } else { Severity::Error };
                let places = (first.place, second.place);
                let found = TooMany { place, places, count: all.len(), is_again };
                self.too_many(found, multiplicity, severity, report);
            }
            _ => {}
        }
        if all.len() > 1 {
            let mut seen: HashSet<Provider> = HashSet::new();
            all.retain(|end| seen.insert(end.provider));
        }
        Some(all)
    }

    /// The wires from the references of a component.
    fn wires_of(&self, member: usize) -> &[Wire<'f>] {
        self.wires.get(&member).map_or(&[], Vec::as_slice)
    }

    /// The wires from a reference.
    fn wires_from(&self, (member, name): ReferenceId<'_>) -> &[Wire<'f>] {
        let all = self.wires_of(member);
        let from = all.partition_point(|wire| wire.name < name);
        let count = all[from..].partition_point(|wire| wire.name == name);
        &all[from..from + count]
    }

    /// The number of targets a reference of a component of a class can have.
    fn multiplicity(&self, (member, name): ReferenceId<'_>, declared: &ReferenceDeclaration) -> Multiplicity {
        let reference = self.fleet.members[member].component.reference(name);
        let given = reference.and_then(|reference| reference.multiplicity());
        given.map_or(of_class(declared), |given| given.value)
    }

    /// Checks the targets of a component that has no class: that they are there is all that can be known.
    fn given(&mut self, member: usize, report: &mut Report<'_>) {
        let fleet = self.fleet;
        let Some(names) = fleet.reference_names(member) else {
            let component = fleet.members[member].component;
            for reference in &component.references {
                let place = (member, reference.name.as_str());
                let written = self.level(place, None, report).written;
                let most = reference.multiplicity().map(|given| given.value);
                if let (Some(places), Some(most)) = (written.first_two, most)
                    && !most.is_many()
                {
                    // In SCA 1.0 a warning: another program may take the first.
                    let is_1_1 = fleet.members[member].composite.version.is_1_1();
                    let severity = if is_1_1 { Severity::Error } else { Severity::Warning };
                    let found = TooMany { place, places, count: written.count, is_again: false };
                    self.too_many(found, most, severity, report);
                }
            }
            for wire in self.wires_of(member).iter().filter(|wire| component.reference(wire.name).is_none()) {
                target(wire.target, (wire.scope, Some(member)), None, (fleet, self.options), report);
            }
            return;
        };
        for name in names {
            let ends = self.level((member, name), None, report);
            let multiplicity = fleet.multiplicity_of((member, name));
            if let Some(places) = ends.written.first_two
                && !multiplicity.is_many()
            {
                let found = TooMany { place: (member, name), places, count: ends.written.count, is_again: false };
                self.too_many(found, multiplicity, Severity::Error, report);
            }
        }
    }
}
