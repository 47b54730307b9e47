//! Wiring: the resolver of references to services.
//!
//! A reference of a component of a class collects its targets from the inside out: those of its own component, and
//! those of every component around it that a composite's reference promotes it to.

mod autowire;
mod call_cycle;
mod ends;
mod misread_uri;
mod promoted;
mod promotion;
mod target;
#[cfg(test)]
mod tests;
mod too_many;
mod unwired;
mod uri;
mod useless_autowire;
mod wire;

use std::cell::RefCell;
use std::collections::{BTreeMap, HashSet};
use std::rc::Rc;

use crate::check::contracts::offer::{Provider, ReferenceId};
use crate::check::fleet::Fleet;
use crate::check::options::Options;
use crate::check::report::Report;
use crate::check::wiring::autowire::Autowire;
use crate::check::wiring::call_cycle::CallCycles;
pub(crate) use crate::check::wiring::ends::WebEnd;
use crate::check::wiring::ends::{End, Ends};
use crate::check::wiring::promotion::Promoted;
use crate::check::wiring::target::target;
use crate::check::wiring::unwired::DanglingNames;
use crate::check::wiring::useless_autowire::UselessAutowire;
use crate::check::wiring::wire::{Wire, wires};
use crate::diagnostic::Severity;
use crate::limits::{Budget, WIRE_ENDS};
use crate::registry::ReferenceDeclaration;
use crate::source::Location;

/// The targets of every reference of every component, in the order of the class; `None` for services that a fault keeps
/// from being known, which is reported, or that are taken as given.
pub(crate) type Wiring = Vec<Vec<Option<Vec<Provider>>>>;

/// The services of the web to which references of components lead, by the component and the place of the reference in
/// its class.
pub(crate) type WebEnds<'f> = BTreeMap<(usize, usize), Vec<WebEnd<'f>>>;

/// Resolves all promotions, targets and wires, and checks what they come to.
pub(crate) fn check<'f>(fleet: &'f Fleet<'_>, options: &'f Options, report: &mut Report<'_>) -> (Wiring, WebEnds<'f>) {
    let promoted = Rc::new(promotion::check(fleet, report));
    let ends_left = Budget::of(WIRE_ENDS);
    let (wires, dangling) = wires(fleet, options, &ends_left, report);
    let autowire = Autowire::default();
    let mut all = Wires {
        fleet,
        options,
        promoted,
        wires,
        dangling,
        autowire,
        ends_left,
        useless: RefCell::default(),
        web: WebEnds::default(),
    };
    let mut circles = CallCycles::default();
    let mut wiring = Wiring::with_capacity(fleet.members.len());
    for member in 0..fleet.members.len() {
        report.about(&fleet.members[member]);
        let Some(class) = fleet.class_of(member) else {
            all.given(member, report);
            wiring.push(Vec::new());
            continue;
        };
        let references = class.references.iter().enumerate().map(|(place, &declared)| {
            let ends = all.of_class((member, place), declared, report)?;
            for end in &ends {
                circles.add(member, &declared.name, end.provider, end.place, fleet);
            }
            Some(ends.into_iter().map(|end| end.provider).collect())
        });
        wiring.push(references.collect());
    }
    report.about_all();
    circles.check(fleet, report);
    (wiring, all.web)
}

struct Wires<'f, 'a> {
    fleet: &'f Fleet<'a>,
    options: &'f Options,
    promoted: Rc<Promoted<'f>>,
    wires: BTreeMap<ReferenceId<'f>, Vec<Wire<'f>>>,
    dangling: DanglingNames<'f>,
    autowire: Autowire<'f>,
    ends_left: Budget,
    useless: RefCell<UselessAutowire>,
    web: WebEnds<'f>,
}

impl<'f, 'a> Wires<'f, 'a> {
    /// The ends of a reference of a component of a class, each provider once; `None` where they are not known. What is
    /// wrong with them is reported.
    fn of_class(
        &mut self,
        (member, number): (usize, usize),
        declared: &'f ReferenceDeclaration,
        report: &mut Report<'_>,
    ) -> Option<Vec<End>> {
        let place = (member, declared.name.as_str());
        let Ends { mut all, web, is_unknown, .. } = self.ends(place, &declared.interface, report);
        let leads_to_web = !web.is_empty();
        if leads_to_web {
            self.too_many_with_web(place, &all, &web, report);
            self.web.insert((member, number), web);
        }
        if is_unknown {
            return None;
        }
        let Some(first) = all.first().copied() else {
            if leads_to_web {
                return Some(all);
            }
            return (!self.unwired(place, declared, report)).then_some(all);
        };
        let multiplicity = self.fleet.multiplicity(place).filter(|one| !one.is_many());
        // Several services, or one that is written several times.
        if let Some(one) = multiplicity.filter(|_| all.iter().any(|end| *end != first)) {
            let is_again = all.iter().all(|end| end.provider == first.provider);
            // In SCA 1.0 a warning: it leads to one service all the same.
            let is_1_1 = self.fleet.members[member].composite.version.is_1_1();
            let severity = if is_again && !is_1_1 { Severity::Warning } else { Severity::Error };
            let places: Vec<Location> = all.iter().map(|end| end.place).collect();
            self.too_many(place, &places, is_again, one, severity, report);
        }
        if all.len() > 1 {
            let mut seen: HashSet<Provider> = HashSet::new();
            all.retain(|end| seen.insert(end.provider));
        }
        Some(all)
    }

    /// Reports more targets than a reference allows where some of them are services of the web.
    fn too_many_with_web(
        &self,
        place @ (member, name): ReferenceId<'f>,
        all: &[End],
        web: &[WebEnd<'f>],
        report: &mut Report<'_>,
    ) {
        let Some(one) = self.fleet.multiplicity(place).filter(|one| !one.is_many()) else { return };
        // A target beside a binding is reported in SCA 1.1, however many it takes.
        let own = self.fleet.members[member].component.reference(name);
        let is_told = own.is_some_and(|own| !own.targets.is_empty() && WebEnd::of(own).next().is_some())
            && self.fleet.members[member].composite.version.is_1_1();
        if !is_told {
            let places = all.iter().map(|end| end.place).chain(web.iter().map(WebEnd::place));
            self.too_many(place, &places.collect::<Vec<_>>(), false, one, Severity::Error, report);
        }
    }

    /// The wires from a reference.
    fn wires_from<'s>(&'s self, place: ReferenceId<'s>) -> &'s [Wire<'f>] {
        self.wires.get(&place).map_or(&[], Vec::as_slice)
    }

    /// Checks the targets of a component that has no class: that they are there is all that can be known.
    fn given(&mut self, member: usize, report: &mut Report<'_>) {
        let fleet = self.fleet;
        let (component, version) = (fleet.members[member].component, fleet.members[member].composite.version);
        let known = fleet.reference_names(member);
        let is_given = known.is_none();
        let written = || component.references.iter().map(|one| one.name.as_str()).collect();
        for name in known.unwrap_or_else(written) {
            let place = (member, name);
            let written = self.level(place, None, report).written;
            if let Some(most) = fleet.multiplicity(place).filter(|most| !most.is_many())
                && written.len() > 1
            {
                // In SCA 1.0 a warning: another program may take the first.
                let severity = if is_given && !version.is_1_1() { Severity::Warning } else { Severity::Error };
                self.too_many(place, &written, false, most, severity, report);
            }
        }
        let wires = self.wires.range((member, "")..(member + 1, "")).filter(|_| is_given);
        for (_, wires) in wires.filter(|((_, name), _)| component.reference(name).is_none()) {
            for wire in wires {
                target(wire.target, (wire.scope, Some(member)), None, (fleet, self.options), report);
            }
        }
    }
}
