//! Where each reference leads.

use std::collections::HashMap;

use super::circle::Circles;
use super::classes::ClassIndex;
use super::contracts::of_class;
use super::fleet::{Fleet, Member};
use super::promote::Promoted;
use super::report::{Report, list};
use super::target::{Provider, Uri, provider};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::Reference;
use crate::registry::ReferenceDeclaration;
use crate::source::{Location, Text};

/// A reference with its wires.
#[derive(Default)]
struct Ends {
    /// By `target` and by bindings of SCA.
    own: Vec<End>,
    /// By `<wire>`.
    wires: Vec<End>,
    /// By `<wire replace="true">`: in place of all others.
    replacing: Vec<End>,
    /// Whether an end is wrong: reported, so nothing more is said about the reference.
    is_wrong: bool,
}

#[derive(Clone, Copy)]
struct End {
    provider: Provider,
    place: Location,
}

/// The provider of every reference of every component, `None` for one that leads nowhere.
pub(super) type Wiring = Vec<Vec<Option<Provider>>>;

/// Resolves all targets and wires, and checks what they come to.
pub(super) fn check(
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    promoted: &Promoted,
    report: &mut Report<'_>,
) -> Wiring {
    let mut ends: Vec<Vec<Ends>> = Vec::with_capacity(fleet.members.len());
    for (place, member) in fleet.members.iter().enumerate() {
        let class = fleet.class_of(place, classes);
        let references = class.map_or(&[][..], |class| class.references);
        ends.push(
            references.iter().map(|declared| own_ends(member, declared, fleet, classes, report)).collect(),
        );
    }
    composite_wires(fleet, classes, &mut ends, report);
    let mut circles = Circles::new(fleet.members.len());
    let mut autowire = Autowire::default();
    let mut wiring = Wiring::with_capacity(ends.len());
    for (place, ends) in ends.into_iter().enumerate() {
        let Some(class) = fleet.class_of(place, classes) else {
            wiring.push(Vec::new());
            continue;
        };
        let mut providers = Vec::with_capacity(ends.len());
        for ((number, declared), ends) in class.references.iter().enumerate().zip(ends) {
            let wire = Wire { member: place, declared, number };
            let end = wire.resolve(ends, fleet, classes, promoted, &mut autowire, report);
            if let Some(end) = end {
                circles.add(place, &declared.name, end.provider, end.place, fleet, classes);
            }
            providers.push(end.map(|end| end.provider));
        }
        wiring.push(providers);
    }
    circles.check(fleet, report);
    wiring
}

fn own_ends(
    member: &Member<'_>,
    declared: &ReferenceDeclaration,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    report: &mut Report<'_>,
) -> Ends {
    let mut ends = Ends::default();
    let Some(reference) = member.component.reference(&declared.name) else { return ends };
    let by_binding = reference.bindings.iter().filter(|binding| binding.is_sca && binding.kind == "sca");
    for target in reference.targets.iter().chain(by_binding.filter_map(|binding| binding.uri.as_ref())) {
        match provider(target, &declared.interface, fleet, classes, report) {
            Some(provider) => ends.own.push(End { provider, place: target.location }),
            None => ends.is_wrong = true,
        }
    }
    ends
}

/// Adds the `<wire>` elements of all composites.
fn composite_wires(
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    ends: &mut [Vec<Ends>],
    report: &mut Report<'_>,
) {
    for wire in fleet.composites.iter().flat_map(|composite| &composite.wires) {
        let (Some(source), Some(target)) = (&wire.source, &wire.target) else { continue };
        let Some((member, number)) = source_of(source, fleet, classes, report) else { continue };
        let Some(class) = fleet.class_of(member, classes) else { continue };
        let ends = &mut ends[member][number];
        let Some(provider) = provider(target, &class.references[number].interface, fleet, classes, report)
        else {
            ends.is_wrong = true;
            continue;
        };
        let end = End { provider, place: target.location };
        match wire.replace.as_ref().is_some_and(|replace| replace.value) {
            true => ends.replacing.push(end),
            false => ends.wires.push(end),
        }
    }
}

/// The component and the place of its reference that a wire starts from.
fn source_of(
    source: &Text,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    report: &mut Report<'_>,
) -> Option<(usize, usize)> {
    let uri = Uri::of(source, 2, report)?;
    let member = uri.member(source, fleet, report)?;
    let class = fleet.class_of(member, classes)?;
    let names = || class.references.iter().map(|reference| reference.name.as_str());
    let component = quoted(uri.component);
    match (&uri.part, class.references) {
        (Some((name, at)), references) => {
            let found = references.iter().position(|reference| reference.name == *name);
            if found.is_none() {
                let at = report.part(source, at.clone());
                let message = format!("component {component} has no reference {}", quoted(name));
                let known = ("its references are", names());
                let one = report.unknown(&codes::UNKNOWN_WIRE_SOURCE, at, message, name, known);
                report.push(one);
            }
            Some((member, found?))
        }
        (None, [_]) => Some((member, 0)),
        (None, []) => {
            let message = format!("component {component} has no references");
            report.push(Diagnostic::new(&codes::UNKNOWN_WIRE_SOURCE, source.location, message));
            None
        }
        (None, _) => {
            let message = format!("component {component} has several references");
            let help = format!("name one of {}: `{source}/...`", list(names()));
            report.push(Diagnostic::new(&codes::UNKNOWN_WIRE_SOURCE, source.location, message).help(help));
            None
        }
    }
}

/// A reference of a component.
#[derive(Clone, Copy)]
struct Wire<'r> {
    member: usize,
    declared: &'r ReferenceDeclaration,
    number: usize,
}

impl Wire<'_> {
    /// The one end that counts, if the reference leads anywhere.
    fn resolve<'c>(
        self,
        ends: Ends,
        fleet: &Fleet<'_>,
        classes: &'c [ClassIndex<'_>],
        promoted: &Promoted,
        autowire: &mut Autowire<'c>,
        report: &mut Report<'_>,
    ) -> Option<End> {
        let Ends { mut own, wires, replacing, is_wrong } = ends;
        let mut all = if replacing.is_empty() {
            own.extend(wires);
            own
        } else {
            replacing
        };
        let mut seen: Vec<Provider> = Vec::new();
        all.retain(|end| {
            let is_new = !seen.contains(&end.provider);
            seen.push(end.provider);
            is_new
        });
        if is_wrong {
            return None;
        }
        let member = &fleet.members[self.member];
        let reference = member.component.reference(&self.declared.name);
        match all[..] {
            [end] => Some(end),
            [first, second, ..] => {
                self.too_many(member, first, second, all.len(), report);
                None
            }
            [] => {
                if self.is_autowired(member, reference, fleet) {
                    return self.autowire(member, reference, autowire, fleet, classes, report);
                }
                if !promoted.references.contains(&(self.member, self.number)) {
                    self.unwired(member, reference, fleet, None, report);
                }
                None
            }
        }
    }

    fn too_many(self, member: &Member<'_>, first: End, second: End, count: usize, report: &mut Report<'_>) {
        let multiplicity = of_class(self.declared);
        let message = format!(
            "reference {} of component {} takes one target, and here are {count}",
            quoted(&self.declared.name),
            quoted(&member.component.name)
        );
        report.push(
            Diagnostic::new(&codes::TOO_MANY_TARGETS, second.place, message)
                .rule(if multiplicity.is_required() { "ASM50040" } else { "ASM50039" })
                .label(first.place, "the first")
                .help("keep one of them"),
        );
    }

    /// Whether targets are to be found by interface: said by the reference, its component, or the composite.
    fn is_autowired(self, member: &Member<'_>, reference: Option<&Reference>, fleet: &Fleet<'_>) -> bool {
        let own = reference.and_then(|reference| reference.autowire());
        let said = own.or(member.component.autowire).or(fleet.composite_of(member).autowire);
        said.is_some_and(|autowire| autowire.value)
    }

    fn autowire<'c>(
        self,
        member: &Member<'_>,
        reference: Option<&Reference>,
        autowire: &mut Autowire<'c>,
        fleet: &Fleet<'_>,
        classes: &'c [ClassIndex<'_>],
        report: &mut Report<'_>,
    ) -> Option<End> {
        let interface = &self.declared.interface;
        let all = autowire.offers(&interface.name, fleet, classes);
        let fits = |provider: &&Provider| {
            provider.member != self.member
                && fleet
                    .class_of(provider.member, classes)
                    .is_some_and(|class| class.services[provider.service].interface == *interface)
        };
        let place = reference.map_or(member.component.name.location, |reference| reference.name.location);
        let mut found = all.iter().filter(fits);
        match (found.next(), found.next()) {
            (Some(provider), None) => Some(End { provider: *provider, place }),
            (None, _) => {
                self.unwired(member, reference, fleet, Some("ASM60028"), report);
                None
            }
            (Some(_), Some(_)) => {
                let names: Vec<String> =
                    all.iter().filter(fits).take(50).map(|provider| uri(*provider, fleet, classes)).collect();
                let message = format!(
                    "autowire finds several services for reference {} of component {}",
                    quoted(&self.declared.name),
                    quoted(&member.component.name)
                );
                let help = format!("name one as its `target`: {}", list(names.iter().map(String::as_str)));
                report.push(Diagnostic::new(&codes::AUTOWIRE_AMBIGUOUS, place, message).help(help));
                None
            }
        }
    }

    /// A required reference without a target: an error in SCA 1.1. In 1.0 files it is common, as in those of the manual.
    fn unwired(
        self,
        member: &Member<'_>,
        reference: Option<&Reference>,
        fleet: &Fleet<'_>,
        rule: Option<&'static str>,
        report: &mut Report<'_>,
    ) {
        let wired_elsewhere = reference.is_some_and(|reference| {
            reference.wired_by_impl().is_some_and(|wired| wired.value)
                || reference.bindings.iter().any(|binding| !(binding.is_sca && binding.kind == "sca"))
        });
        let multiplicity = reference.and_then(|reference| reference.multiplicity.as_ref());
        let is_required = of_class(self.declared).is_required()
            || multiplicity.is_some_and(|given| given.value.is_required());
        if wired_elsewhere || !is_required {
            return;
        }
        let (name, interface) = (&self.declared.name, &self.declared.interface.name);
        let (component, place) = (&member.component.name, reference.map(|reference| reference.name.location));
        let message =
            format!("reference {} of component {} leads to no service", quoted(name), quoted(component));
        let is_1_1 = fleet.composite_of(member).version.is_1_1();
        let help = format!(
            "give it a target with the interface {}: `<reference name=\"{name}\" target=\"...\"/>`",
            quoted(interface)
        );
        let one = Diagnostic::new(&codes::UNWIRED, place.unwrap_or(component.location), message)
            .severity(if is_1_1 { Severity::Error } else { Severity::Warning })
            .help(help);
        let one = match rule {
            Some(rule) => one.rule(rule).help("autowire finds no service with this interface"),
            None => one.rule("ASM50040"),
        };
        report.push(if is_1_1 { one } else { one.help("calls through it fail") });
    }
}

/// `component/service`.
fn uri(provider: Provider, fleet: &Fleet<'_>, classes: &[ClassIndex<'_>]) -> String {
    let component = &fleet.members[provider.member].component.name;
    let service =
        fleet.class_of(provider.member, classes).map_or("", |class| &class.services[provider.service].name);
    format!("{component}/{service}")
}

/// The services of a fleet by interface, collected when somebody asks.
#[derive(Default)]
struct Autowire<'c> {
    by_interface: Option<HashMap<&'c str, Vec<Provider>>>,
}

impl<'c> Autowire<'c> {
    fn offers(&mut self, interface: &str, fleet: &Fleet<'_>, classes: &'c [ClassIndex<'_>]) -> &[Provider] {
        let all = self.by_interface.get_or_insert_with(|| {
            let mut all: HashMap<&str, Vec<Provider>> = HashMap::new();
            for member in 0..fleet.members.len() {
                let services = fleet.class_of(member, classes).map_or(&[][..], |class| &class.services);
                for (service, declared) in services.iter().enumerate() {
                    all.entry(&declared.interface.name).or_default().push(Provider { member, service });
                }
            }
            all
        });
        all.get(interface).map_or(&[], Vec::as_slice)
    }
}
