//! Wiring: the resolver of references to services.
//!
//! A reference of a component of a class collects its targets from the inside out: those of its own component, and those of
//! every component around it that a composite's reference promotes it to.

pub(crate) mod autowire;
pub(crate) mod budget;
pub(crate) mod call_cycle;
pub(crate) mod cycles;
pub(crate) mod dangling_names;
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
pub(crate) mod wire;

use std::collections::{HashMap, HashSet};

use crate::check::fleet::Fleet;
use crate::check::fleet::classes::ClassIndex;
use crate::check::report::{Report, list};
use crate::check::rules::contracts::of_class;
use crate::check::wiring::autowire::Autowire;
use crate::check::wiring::budget::WireBudget;
use crate::check::wiring::call_cycle::CallCycles;
use crate::check::wiring::dangling_names::DanglingNames;
use crate::check::wiring::multiplicity::keeps_own;
use crate::check::wiring::promotion::{Promoted, ReferenceId};
use crate::check::wiring::target::{Provider, Target, parts, spread, target, uri};
use crate::check::wiring::wire::{Wire, wires};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Multiplicity, ReferenceElement};
use crate::registry::{InterfaceDeclaration, ReferenceDeclaration};
use crate::source::{Location, Text};
use too_many::TooMany;

/// The services that a reference leads to.
#[derive(Default)]
struct Ends {
    all: Vec<End>,
    /// True if a target is wrong, which is reported, or cannot be looked at: nothing more is said about the reference.
    is_unknown: bool,
}

#[derive(Clone, Copy)]
struct End {
    provider: Provider,
    place: Location,
}

/// The providers of every reference of every component, in the order of the class.
pub(crate) struct Wiring(Vec<Vec<Vec<Provider>>>);

impl Wiring {
    /// The providers of each reference of a component.
    pub(crate) fn of(&self, member: usize) -> &[Vec<Provider>] {
        &self.0[member]
    }
}

/// Resolves all targets and wires, and checks what they come to.
pub(crate) fn check(
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    promoted: &Promoted<'_>,
    report: &mut Report<'_>,
) -> Wiring {
    let room = WireBudget::default();
    let (mut wires, dangling) = wires(fleet, classes, &room, report);
    // They are looked up by the names of their references.
    wires.values_mut().for_each(|wires| wires.sort_by_key(|wire| wire.name));
    let autowire = Autowire::default();
    let mut all = Wires { fleet, classes, promoted, wires, dangling, autowire, room };
    let mut circles = CallCycles::default();
    let mut wiring = Vec::with_capacity(fleet.members.len());
    for member in 0..fleet.members.len() {
        report.about(&fleet.members[member]);
        let Some(class) = fleet.class_of(member, classes) else {
            all.given(member, report);
            wiring.push(Vec::new());
            continue;
        };
        let references = class.references.iter().map(|&declared| {
            let ends = all.of_class(member, declared, report);
            for end in &ends {
                circles.add(member, &declared.name, end.provider, end.place, fleet, classes);
            }
            ends.into_iter().map(|end| end.provider).collect()
        });
        wiring.push(references.collect());
    }
    report.about_all();
    circles.check(fleet, report);
    Wiring(wiring)
}

struct Wires<'f, 'a> {
    fleet: &'f Fleet<'a>,
    classes: &'f [ClassIndex<'a>],
    promoted: &'f Promoted<'f>,
    wires: HashMap<usize, Vec<Wire<'f>>>,
    dangling: DanglingNames<'f>,
    autowire: Autowire<'f>,
    room: WireBudget,
}

impl<'f, 'a> Wires<'f, 'a> {
    /// The ends of a reference of a component of a class, each provider once. What is wrong with them is reported.
    fn of_class(
        &mut self,
        member: usize,
        declared: &'f ReferenceDeclaration,
        report: &mut Report<'_>,
    ) -> Vec<End> {
        let place = (member, declared.name.as_str());
        let Ends { mut all, is_unknown } = self.ends(place, &declared.interface, report);
        if is_unknown {
            return Vec::new();
        }
        let multiplicity = self.multiplicity(place, declared);
        match all[..] {
            [] => self.unwired(place, declared, report),
            [first, second, ..] if !multiplicity.is_many() && is_several(&all) => {
                let is_again = all.iter().all(|end| end.provider == first.provider);
                // In SCA 1.0 a warning: it leads to one service all the same.
                let is_1_1 = self.fleet.members[member].composite.version.is_1_1();
                let severity = if is_again && !is_1_1 { Severity::Warning } else { Severity::Error };
                let places = (first.place, second.place);
                let told = TooMany { place, places, count: all.len(), is_again };
                self.too_many(told, multiplicity, severity, report);
            }
            _ => {}
        }
        if all.len() > 1 {
            let mut seen: HashSet<Provider> = HashSet::new();
            all.retain(|end| seen.insert(end.provider));
        }
        all
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

    /// Looks at the targets of a component that has no class: whether they are there is all that can be known.
    fn given(&mut self, member: usize, report: &mut Report<'_>) {
        let fleet = self.fleet;
        let Some(names) = fleet.reference_names(member, self.classes) else {
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
                    let told = TooMany { place, places, count: written.count, is_again: false };
                    self.too_many(told, most, severity, report);
                }
            }
            for wire in self.wires_of(member).iter().filter(|wire| component.reference(wire.name).is_none()) {
                target(wire.target, (wire.scope, Some(member)), None, fleet, self.classes, report);
            }
            return;
        };
        for name in names {
            let ends = self.level((member, name), None, report);
            let multiplicity = fleet.multiplicity_of((member, name));
            if let Some(places) = ends.written.first_two
                && !multiplicity.is_many()
            {
                let told =
                    TooMany { place: (member, name), places, count: ends.written.count, is_again: false };
                self.too_many(told, multiplicity, Severity::Error, report);
            }
        }
    }

    /// All ends of a reference, those of the components around it included.
    fn ends(
        &mut self,
        place: ReferenceId<'f>,
        interface: &'f InterfaceDeclaration,
        report: &mut Report<'_>,
    ) -> Ends {
        let level = self.level(place, Some(interface), report);
        let mut ends = level.ends;
        // That the reference of a composite has too many is told where it has them.
        ends.is_unknown |= level.written.count > 1
            && !self.fleet.members[place.0].runs()
            && !self.fleet.multiplicity_of(place).is_many();
        let (fleet, promoted) = (self.fleet, self.promoted);
        let outer = promoted.to.get(&place).map_or(&[][..], Vec::as_slice);
        // No target serves references of several interfaces.
        let is_differing = self.promoted.differing.contains(&place);
        let mut around = Ends { is_unknown: is_differing, ..Ends::default() };
        for outer in outer.iter().filter(|_| !is_differing) {
            let more = self.ends(*outer, interface, report);
            around.all.extend(more.all);
            around.is_unknown |= more.is_unknown;
        }
        // What is around a composite that runs by itself is the domain: the components of all such composites.
        let mut domain = Level::default();
        for text in promoted.outermost.get(&place).into_iter().flatten() {
            self.add(text, (0, None), true, Some(interface), &mut domain, report);
        }
        around.all.extend(domain.ends.all);
        around.is_unknown |= domain.ends.is_unknown;
        let reference = fleet.members[place.0].component.reference(place.1);
        if !around.all.is_empty() && !ends.all.is_empty() && !keeps_own(fleet, place, reference) {
            ends = around;
        } else {
            ends.all.extend(around.all);
            ends.is_unknown |= around.is_unknown;
        }
        let has_none = ends.all.is_empty() && !ends.is_unknown && level.written.count == 0;
        if has_none && self.is_autowired(place, reference) {
            return self.autowired(place, reference, interface, report);
        }
        ends
    }

    /// The ends that a component gives its reference: by `target`, by bindings of SCA, and by wires in its composite.
    fn level(
        &self,
        (member, name): ReferenceId<'_>,
        interface: Option<&'f InterfaceDeclaration>,
        report: &mut Report<'_>,
    ) -> Level {
        let fleet = self.fleet;
        let scope = fleet.members[member].scope;
        let wires = self.wires_from((member, name));
        // In place of the `target`, and beside other wires (SCA Assembly 1.1, ASM50034).
        let is_replaced = wires.iter().any(|wire| wire.is_replacing);
        let own = Some(member);
        let mut level = Level::default();
        let mut is_said = !wires.is_empty();
        if let Some(reference) = fleet.members[member].component.reference(name) {
            let by_binding =
                reference.bindings().iter().filter(|binding| binding.is_sca && binding.kind == "sca");
            for text in reference.targets.iter().chain(by_binding.filter_map(|binding| binding.uri.as_ref()))
            {
                is_said = true;
                self.add(text, (scope, own), !is_replaced, interface, &mut level, report);
            }
        }
        for wire in wires {
            self.add(wire.target, (wire.scope, own), true, interface, &mut level, report);
        }
        // A composite wires its references to what is around it, where the component that it implements says nothing (SCA Assembly 1.1, 5.3).
        let inner = fleet.inner(member).filter(|_| !is_said);
        let declared = inner.into_iter().flat_map(|inner| inner.references()).find(|one| one.name == name);
        for text in declared.map_or(&[][..], |declared| &declared.targets) {
            let known = report.diagnostics().len();
            self.add(text, (scope, own), true, interface, &mut level, report);
            let is_inside = || inner.is_some_and(|inner| fleet.find(inner.scope, parts(text).0).is_some());
            if report.diagnostics().len() > known && is_inside() {
                report.diagnostics().adjust(known, |one| {
                    one.help.push(
                        "what the composite's reference targets stands around the composite; inside, its components are wired with `<wire>`".to_owned(),
                    );
                });
            }
        }
        level
    }

    /// Adds where a text leads from `own`, a component of `scope`, to what a reference is given.
    fn add(
        &self,
        text: &Text,
        (scope, own): (usize, Option<usize>),
        counts: bool,
        interface: Option<&'f InterfaceDeclaration>,
        level: &mut Level,
        report: &mut Report<'_>,
    ) {
        if !self.room.take(text, scope, self.fleet, report) {
            level.ends.is_unknown = true;
            return;
        }
        for (one, replica) in spread(text, scope, self.fleet) {
            // A group stands for the others.
            if replica.is_some() && replica == own {
                continue;
            }
            match target(&one, (scope, own), interface, self.fleet, self.classes, report) {
                Target::Service(provider) => {
                    if counts {
                        level.ends.all.push(End { provider, place: text.location });
                    }
                }
                Target::Open | Target::Wrong => level.ends.is_unknown |= counts,
            }
            if counts {
                level.written.add(text.location);
            }
        }
    }

    /// True if targets are to be found by interface: said by the reference, its component, or the composite.
    fn is_autowired(&self, (member, _): ReferenceId<'_>, reference: Option<&ReferenceElement>) -> bool {
        let member = &self.fleet.members[member];
        let own = reference.and_then(|reference| reference.autowire());
        own.or(member.component.autowire()).map_or(member.autowire, |said| said.value)
    }

    fn autowired(
        &mut self,
        place: ReferenceId<'f>,
        reference: Option<&ReferenceElement>,
        interface: &'f InterfaceDeclaration,
        report: &mut Report<'_>,
    ) -> Ends {
        let (fleet, classes) = (self.fleet, self.classes);
        let (member, name) = place;
        let own = &fleet.members[member];
        let at = reference.map_or(own.component.name.location, |reference| reference.name.location);
        let is_many = match fleet.class_of(member, classes) {
            Some(class) => {
                let declared = class.references.iter().find(|declared| declared.name == name);
                declared.is_some_and(|declared| self.multiplicity(place, declared).is_many())
            }
            None => fleet.multiplicity_of(place).is_many(),
        };
        // Of those that a reference with one target cannot have together, some are named.
        let most = if is_many { usize::MAX } else { 50 };
        let (found, is_open) = self.autowire.offers((own.scope, member), most, interface, fleet, classes);
        if found.len() > 1 && !is_many {
            let code = &codes::AUTOWIRE_AMBIGUOUS;
            if report.skip(code, code.severity, at) {
                return Ends { all: Vec::new(), is_unknown: true };
            }
            let names: Vec<String> = found.iter().map(|one| uri(*one, fleet, classes)).collect();
            let message = format!(
                "autowire finds several services for reference {} of component {}",
                quoted(name),
                quoted(&own.component.name)
            );
            let help = format!("name one as its `target`: {}", list(names.iter().map(String::as_str)));
            report.push(Diagnostic::new(code, at, message).help(help));
            return Ends { all: Vec::new(), is_unknown: true };
        }
        let all = found.into_iter().map(|(_, provider)| End { provider, place: at });
        Ends { all: all.collect(), is_unknown: is_open }
    }
}

/// True if ends are of several services, or of one that is written several times.
fn is_several(ends: &[End]) -> bool {
    ends.iter().any(|end| (end.provider, end.place) != (ends[0].provider, ends[0].place))
}

/// The targets that one component gives its reference.
#[derive(Default)]
struct Level {
    ends: Ends,
    /// The targets that count.
    written: Targets,
}

/// The number of targets are written for a reference, and where.
#[derive(Default)]
struct Targets {
    count: usize,
    first: Option<Location>,
    first_two: Option<(Location, Location)>,
}

impl Targets {
    fn add(&mut self, place: Location) {
        self.count += 1;
        match self.first {
            None => self.first = Some(place),
            Some(first) => _ = self.first_two.get_or_insert((first, place)),
        }
    }
}
