//! Services and references of components, held against their classes.

use std::collections::HashSet;

use super::repeated_names::Owner;
use super::{interface, multiplicity};
use crate::check::contracts::offer::{Offer, parts};
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::check::report::swapped::swapped;
use crate::diagnostic::{Code, Diagnostic, Severity, codes, quoted};
use crate::model::{Binding, Multiplicity, Part};
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// Checks the services and references of every component.
pub(crate) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let mut told = Told::new();
    for (place, member) in fleet.members.iter().enumerate() {
        report.about(member);
        let component = member.component;
        let owner = Owner {
            name: &|| format!("component {}", quoted(&component.name)),
            code: &codes::CONTRACT_REPEATED,
            severity: Severity::Error,
            help: "keep one of them",
        };
        owner.check("services", "ASM50002", component.services.iter().map(|one| &one.name), report);
        services(place, fleet, report);
        owner.check("references", "ASM50007", component.references.iter().map(|one| &one.name), report);
        references(place, fleet, &mut told, report);
    }
    report.about_all();
}

/// The implementation of a component, for messages.
fn whose(member: usize, fleet: &Fleet<'_>) -> Option<String> {
    match fleet.class_of(member) {
        Some(class) => Some(format!("class {}", quoted(class.class.name()))),
        None => {
            let inner = fleet.inner(member).filter(|inner| !inner.hides_names)?;
            Some(format!("composite {}", quoted(&inner.main().name)))
        }
    }
}

fn services(member: usize, fleet: &Fleet<'_>, report: &mut Report<'_>) {
    for service in &fleet.members[member].component.services {
        let Some(whose) = whose(member, fleet) else { return };
        let name = &service.name;
        match fleet.offer(member, name) {
            Offer::Service(provider) => {
                if let Some(declared) = fleet.interface_of(provider) {
                    interface::check(service.contract().interface.as_ref(), declared, name, "ASM50004", report);
                }
            }
            Offer::Open => {}
            Offer::Missing => {
                let is_reference = fleet.reference_names(member).is_some_and(|names| names.contains(&name.as_str()));
                if is_reference {
                    let document = &fleet.members[member].composite.document;
                    let written = (service.origin.element(document), &**document);
                    let kinds = ("service", "reference");
                    swapped((&codes::UNKNOWN_SERVICE, name), written, kinds, &whose, report);
                    continue;
                }
                let names = fleet.service_names(member).unwrap_or_default();
                unknown(&codes::UNKNOWN_SERVICE, ("service", "services"), name, &whose, &names, report);
            }
        }
        if fleet.class_of(member).is_some() {
            bindings(&service.contract().bindings, "the service can be called only inside this program", report);
        }
    }
}

/// References of composites that are reported as missing.
type Told<'f> = HashSet<(Location, &'f str)>;

fn references<'f>(member: usize, fleet: &'f Fleet<'_>, told: &mut Told<'f>, report: &mut Report<'_>) {
    let class = fleet.class_of(member);
    for reference in &fleet.members[member].component.references {
        let name = &reference.name;
        let declared = class.and_then(|class| class.references.iter().find(|known| known.name == name.as_str()));
        // Most say only where they lead.
        if declared.is_some() && reference.contract.is_none() && reference.multiplicity.is_none() {
            continue;
        }
        let Some(whose) = whose(member, fleet) else { return };
        let inner = fleet.inner(member).and_then(|inner| inner.references().find(|known| known.name == *name.value));
        if let Some(declared) = declared {
            interface::check(reference.contract().interface.as_ref(), &declared.interface, name, "ASM50011", report);
            multiplicity::check(reference, multiplicity::of_class(declared), &whose, report);
            bindings(&reference.contract().bindings, "calls through it fail", report);
        } else if let Some(inner) = inner {
            let own = inner.multiplicity.map_or(Multiplicity::One, |own| own.value);
            multiplicity::check(reference, own, &whose, report);
        } else {
            if class.is_some_and(|class| class.table.place(name).is_some()) {
                let document = &fleet.members[member].composite.document;
                let written = (reference.origin.element(document), &**document);
                let kinds = ("reference", "property");
                swapped((&codes::UNKNOWN_REFERENCE, name), written, kinds, &whose, report);
                continue;
            }
            let names = fleet.reference_names(member).unwrap_or_default();
            // A service of this name that promotes a reference is reported.
            if promotes_reference(member, name, fleet) {
                continue;
            }
            let inner = fleet.inner(member).filter(|_| names.is_empty() && !name.is_empty());
            if let Some(inner) = inner {
                // One line in the composite mends it for all of its uses.
                if !told.insert((inner.main().name.location, name.as_str())) {
                    continue;
                }
                let message = format!("{whose} has no reference {}", quoted(name));
                let one = Diagnostic::new(&codes::UNKNOWN_REFERENCE, name.location, message);
                let promoting = format!("`<reference name=\"{}\" promote=\"COMPONENT/reference\"/>`", escaped(name));
                let help = format!("a composite has only the references that it promotes: write {promoting} in it");
                report.push(one.label(inner.main().name.location, "the composite").help(help));
                continue;
            }
            unknown(&codes::UNKNOWN_REFERENCE, ("reference", "references"), name, &whose, &names, report);
        }
    }
}

/// True if the composite of a component has a service of this name that promotes a reference.
fn promotes_reference(member: usize, name: &str, fleet: &Fleet<'_>) -> bool {
    let Some(inner) = fleet.inner(member) else { return false };
    let of_service = inner.services().find(|one| one.name == name).and_then(|one| one.promote.as_ref());
    let (component, Some(part)) = of_service.map_or(("", None), |promote| parts(promote)) else { return false };
    let first = || fleet.group(inner.scope, component).and_then(|group| group.first().copied());
    let promoted = fleet.find(inner.scope, component).or_else(first);
    promoted.and_then(|promoted| fleet.reference_names(promoted)).is_some_and(|names| names.contains(&part))
}

/// Reports the name of a part that is not among those of a kind, which are called `all`.
pub(crate) fn unknown(
    code: &'static Code,
    (what, all): (&str, &str),
    name: &Text,
    whose: &str,
    known: &[&str],
    report: &mut Report<'_>,
) {
    if name.is_empty() || known.contains(&name.as_str()) {
        return;
    }
    let message = format!("{whose} has no {what} {}", quoted(name));
    let known = (&*format!("its {all} are"), known.iter().copied());
    let one = report.unknown(code, name.location, message, name, known);
    report.push(one);
}

fn bindings(bindings: &[Binding], so: &str, report: &mut Report<'_>) {
    for binding in bindings {
        if binding.is_sca && binding.kind == "sca" || binding.is_rest() {
            continue;
        }
        let kind = quoted(&format!("binding.{}", binding.kind));
        if binding.kind == "rest" {
            let message = format!("{kind} of another namespace is for another runtime, and not supported: {so}");
            let one = Diagnostic::new(&codes::BINDING_NOT_SERVED, binding.tag(), message);
            report.push(one.help(
                "remove it; if SAOMS is to serve it, write `<saoms:binding.rest .../>` in its place, with a path as `uri` \
                 of a service, and an address of HTTP as that of a reference",
            ));
            continue;
        }
        let message = format!("{kind} is not supported: {so}");
        let one = Diagnostic::new(&codes::BINDING_NOT_SERVED, binding.tag(), message);
        report.push(one.help(
            "remove it; to reach other machines, use `binding.rest`, or topics and the `url` of a message broker",
        ));
    }
}
