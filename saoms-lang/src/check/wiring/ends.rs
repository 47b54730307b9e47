//! The ends of references: what `target`, bindings of SCA, wires, promotions and autowire give a reference.

use std::rc::Rc;

use super::Wires;
use super::target::{Target, target, uri};
use super::uri::{has_room, spread};
use crate::check::contracts::offer::{Provider, ReferenceId, parts};
use crate::check::fleet::Fleet;
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Binding, Part, ReferenceElement};
use crate::registry::InterfaceDeclaration;
use crate::source::{Location, Text};

/// The services that a reference leads to.
#[derive(Default)]
pub(super) struct Ends<'f> {
    pub(super) all: Vec<End>,
    /// Those of the web.
    pub(super) web: Vec<WebEnd<'f>>,
    /// True if a target is wrong, which is reported, or cannot be looked at: nothing more is said about the reference.
    pub(super) is_unknown: bool,
    /// The places of the targets that the component itself gives it, as far as they count.
    pub(super) written: Vec<Location>,
}

/// A service that a reference leads to, and the place that says so.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct End {
    pub(super) provider: Provider,
    pub(super) place: Location,
}

/// A service of the web that a reference leads to: a binding, and the reference that has it.
#[derive(Clone, Copy)]
pub(crate) struct WebEnd<'f> {
    pub(crate) binding: &'f Binding,
    pub(crate) reference: &'f ReferenceElement,
}

impl<'f> WebEnd<'f> {
    /// Those that a reference writes.
    pub(crate) fn of(reference: &'f ReferenceElement) -> impl Iterator<Item = WebEnd<'f>> {
        let bindings = reference.contract().bindings.iter().filter(|binding| binding.is_rest());
        bindings.map(move |binding| WebEnd { binding, reference })
    }

    /// The place of its address, or of its binding.
    pub(crate) fn place(&self) -> Location {
        self.binding.uri.as_ref().filter(|uri| !uri.is_empty()).map_or(self.binding.tag(), |uri| uri.location)
    }
}

impl Ends<'_> {
    /// True if it leads nowhere.
    fn is_empty(&self) -> bool {
        self.all.is_empty() && self.web.is_empty()
    }
}

impl<'f> Wires<'f, '_> {
    /// All ends of a reference, those of the components around it included.
    pub(super) fn ends(
        &mut self,
        place: ReferenceId<'f>,
        interface: &'f InterfaceDeclaration,
        report: &mut Report<'_>,
    ) -> Ends<'f> {
        let (fleet, promoted) = (self.fleet, Rc::clone(&self.promoted));
        let mut ends = self.level(place, Some(interface), report);
        // That the reference of a composite has too many is reported where it has them.
        ends.is_unknown |= ends.written.len() > 1
            && !fleet.members[place.0].runs()
            && fleet.multiplicity(place).is_some_and(|takes| !takes.is_many());
        // No target serves references of several interfaces.
        let is_differing = promoted.differing.contains(&place);
        let mut around = Ends { is_unknown: is_differing, ..Ends::default() };
        for outer in promoted.to.get(&place).into_iter().flatten().filter(|_| !is_differing) {
            let more = self.ends(*outer, interface, report);
            around.all.extend(more.all);
            around.web.extend(more.web);
            around.is_unknown |= more.is_unknown;
        }
        // What is around a composite that runs by itself is the domain: the components of all such composites.
        for text in promoted.outermost.get(&place).into_iter().flatten() {
            self.add(text, (0, None), true, Some(interface), &mut around, report);
        }
        around.web.extend(promoted.outermost_web.get(&place).into_iter().flatten());
        let reference = fleet.members[place.0].component.reference(place.1);
        let is_replaced = !around.is_empty() && !ends.is_empty() && !keeps_own(fleet, place, reference);
        if is_replaced {
            (ends.all, ends.web, ends.is_unknown) = (around.all, around.web, around.is_unknown);
        } else {
            ends.all.extend(around.all);
            ends.web.extend(around.web);
            ends.is_unknown |= around.is_unknown;
        }
        let has_none = ends.is_empty() && !ends.is_unknown && ends.written.is_empty();
        if has_none && self.is_autowired(place, reference) {
            return self.autowired(place, reference, interface, report);
        }
        ends
    }

    /// The ends that a component gives its reference: by `target`, by bindings of SCA, and by wires in its composite.
    pub(super) fn level(
        &self,
        (member, name): ReferenceId<'_>,
        interface: Option<&'f InterfaceDeclaration>,
        report: &mut Report<'_>,
    ) -> Ends<'f> {
        let fleet = self.fleet;
        let scope = fleet.members[member].scope;
        let wires = self.wires_from((member, name));
        // In place of the `target`, and beside other wires (SCA Assembly 1.1, ASM50034).
        let is_replaced = wires.iter().any(|wire| wire.is_replacing);
        let own = Some(member);
        let mut ends = Ends::default();
        let mut is_said = !wires.is_empty();
        if let Some(reference) = fleet.members[member].component.reference(name) {
            let by_binding =
                reference.contract().bindings.iter().filter(|binding| binding.is_sca && binding.kind == "sca");
            ends.web.extend(WebEnd::of(reference));
            is_said |= !ends.web.is_empty();
            for text in reference.targets.iter().chain(by_binding.filter_map(|binding| binding.uri.as_ref())) {
                is_said = true;
                self.add(text, (scope, own), !is_replaced, interface, &mut ends, report);
            }
        }
        for wire in wires {
            self.add(wire.target, (wire.scope, own), true, interface, &mut ends, report);
        }
        // A composite wires its references to what is around it, where the component that it implements says nothing
        // (SCA Assembly 1.1, 5.3).
        let inner = fleet.inner(member).filter(|_| !is_said);
        let declared = inner.into_iter().flat_map(|inner| inner.references()).find(|one| one.name == name);
        ends.web.extend(declared.into_iter().flat_map(WebEnd::of));
        for text in declared.map_or(&[][..], |declared| &declared.targets) {
            let is_inside = inner.is_some_and(|inner| fleet.find(inner.scope, parts(text).0).is_some());
            let help = "use `<wire>` to wire components inside the composite: the target of a composite's reference \
                is outside of it";
            report.within(Severity::Error, is_inside.then_some(help), |report| {
                self.add(text, (scope, own), true, interface, &mut ends, report);
            });
        }
        ends
    }

    /// Adds where a text leads from `own`, a component of `scope`, to what a reference is given.
    fn add(
        &self,
        text: &Text,
        (scope, own): (usize, Option<usize>),
        counts: bool,
        interface: Option<&'f InterfaceDeclaration>,
        ends: &mut Ends<'f>,
        report: &mut Report<'_>,
    ) {
        if !has_room(&self.ends_left, text, scope, self.fleet, report) {
            ends.is_unknown = true;
            return;
        }
        for (one, replica) in spread(text, scope, self.fleet) {
            // A group stands for the others.
            if replica.is_some() && replica == own {
                continue;
            }
            let found = target(&one, (scope, own), interface, (self.fleet, self.options), report);
            if !counts {
                continue;
            }
            ends.written.push(text.location);
            match found {
                Target::Service(provider) => ends.all.push(End { provider, place: text.location }),
                Target::Open | Target::Wrong => ends.is_unknown = true,
            }
        }
    }

    /// True if targets are to be found by interface: said by the reference, its component, or the composite.
    pub(super) fn is_autowired(&self, (member, _): ReferenceId<'_>, reference: Option<&ReferenceElement>) -> bool {
        let member = &self.fleet.members[member];
        let own = reference.and_then(|reference| reference.autowire);
        own.or(member.component.autowire).map_or(member.autowire, |said| said.value)
    }

    fn autowired(
        &mut self,
        place: ReferenceId<'f>,
        reference: Option<&ReferenceElement>,
        interface: &'f InterfaceDeclaration,
        report: &mut Report<'_>,
    ) -> Ends<'f> {
        let fleet = self.fleet;
        let (member, name) = place;
        let own = &fleet.members[member];
        let at = reference.map_or(own.component.name.location, |reference| reference.name.location);
        let is_many = fleet.multiplicity(place).is_some_and(|takes| takes.is_many());
        // Of those that a reference with one target cannot have together, some are named.
        let most = if is_many { usize::MAX } else { 50 };
        let (found, is_open) = self.autowire.offers((own.scope, member), most, interface, fleet);
        if found.len() > 1 && !is_many {
            let names: Vec<String> = found.iter().map(|one| uri(*one, fleet)).collect();
            let message = format!(
                "autowire finds several services for reference {} of component {}",
                quoted(name),
                quoted(&own.component.name)
            );
            let help = format!("name one as its `target`: {}", list(names.iter().map(String::as_str)));
            report.push(Diagnostic::new(&codes::AUTOWIRE_AMBIGUOUS, at, message).help(help));
            return Ends { is_unknown: true, ..Ends::default() };
        }
        let all = found.into_iter().map(|(_, provider)| End { provider, place: at });
        Ends { all: all.collect(), is_unknown: is_open, ..Ends::default() }
    }
}

/// True if the targets of a reference stay when a composite that promotes it gives others (SCA Assembly 1.1, 4.3.1):
/// only with `nonOverridable`. In SCA 1.0 those of a reference that takes several do.
fn keeps_own(fleet: &Fleet<'_>, (member, _): ReferenceId<'_>, reference: Option<&ReferenceElement>) -> bool {
    let Some(reference) = reference else { return false };
    let is_fixed = reference.non_overridable.is_some_and(|fixed| fixed.value);
    let is_many = reference.multiplicity.is_some_and(|given| given.value.is_many());
    is_fixed || is_many && !fleet.members[member].composite.version.is_1_1()
}
