//! Services and references of components, held against their classes.

use super::repeated_names::Owner;
use super::{interface, multiplicity};
use crate::check::contracts::offer::Offer;
use crate::check::fleet::Fleet;
use crate::check::report::{Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Severity, codes, quoted};
use crate::load::renaming;
use crate::model::{Binding, Multiplicity, Part, ServiceElement};
use crate::source::Text;
use crate::syntax::{Document, escaped};

/// Checks the services and references of every component.
pub(crate) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
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
        references(place, fleet, report);
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
                    swapped(service, &whose, &fleet.members[member].composite.document, report);
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

fn references(member: usize, fleet: &Fleet<'_>, report: &mut Report<'_>) {
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
            let names = fleet.reference_names(member).unwrap_or_default();
            let inner = fleet.inner(member).filter(|_| names.is_empty() && !name.is_empty());
            if let Some(inner) = inner {
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

/// Reports a service that is a reference, for which its `target` is no further mistake.
fn swapped(service: &ServiceElement, whose: &str, document: &Document, report: &mut Report<'_>) {
    let element = service.origin.element(document);
    if let Some(target) = element.attribute("target") {
        report.withdraw(&codes::UNKNOWN_ATTRIBUTE, target.name_span().in_file(document.file()));
    }
    let tag = element.prefix().map_or_else(|| "reference".to_owned(), |prefix| format!("{prefix}:reference"));
    let edits = renaming(element, element.prefix(), "reference");
    let message = format!("{} of {whose} is a reference, not a service", quoted(&service.name));
    let one = Diagnostic::new(&codes::UNKNOWN_SERVICE, service.name.location, message);
    report.push(one.suggest_edits(replacing(element.name(), &tag), edits));
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
        if binding.is_sca && binding.kind == "sca" {
            continue;
        }
        let message = format!("{} is not supported: {so}", quoted(&format!("binding.{}", binding.kind)));
        let one = Diagnostic::new(&codes::BINDING_NOT_SERVED, binding.tag(), message);
        report.push(one.help("remove it; to reach other machines, use topics and the `url` of a message broker"));
    }
}
