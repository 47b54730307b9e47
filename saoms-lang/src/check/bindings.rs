//! Bindings of references and of the services that they are wired to: without one in common, no message gets from one to the other.

use super::fleet::{Fleet, Kind};
use super::report::{Report, list};
use super::target::parts;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Binding, Part, Service};

/// Checks the targets of all references that say how they are bound, at components that are taken as given.
pub(super) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    for member in &fleet.members {
        report.about(member);
        for reference in member.component.references.iter().filter(|one| !one.bindings().is_empty()) {
            for target in &reference.targets {
                let (component, name) = parts(target);
                // Of a class that runs here it is told that a binding is not served.
                let found = fleet.find(member.scope, component);
                let found =
                    found.map(|found| &fleet.members[found]).filter(|found| found.kind == Kind::Given);
                let services = found.map_or(&[][..], |found| &found.component.services);
                let Some(service) = meant(services, name) else { continue };
                if service.bindings().is_empty()
                    || have_one_in_common(reference.bindings(), service.bindings())
                {
                    continue;
                }
                let message = format!(
                    "reference {} of component {} has no kind of binding in common with service {} of component {}",
                    quoted(&reference.name),
                    quoted(&member.component.name),
                    quoted(&service.name),
                    quoted(component)
                );
                let kinds = |bindings: &[Binding]| {
                    let kinds: Vec<String> =
                        bindings.iter().map(|one| format!("binding.{}", one.kind)).collect();
                    list(kinds.iter().map(String::as_str))
                };
                report.push(
                    Diagnostic::new(&codes::BINDING_MISMATCH, target.location, message)
                        .label(service.bindings()[0].tag(), "the service is bound so")
                        .help(format!(
                            "the reference has {}, the service {}: give both the same, or leave them out",
                            kinds(reference.bindings()),
                            kinds(service.bindings())
                        )),
                );
            }
        }
    }
    report.about_all();
}

/// The service of this name; where none is named, the only one that the component writes.
fn meant<'s>(services: &'s [Service], name: Option<&str>) -> Option<&'s Service> {
    match (name, services) {
        (Some(name), _) => services.iter().find(|service| service.name == name),
        (None, [only]) => Some(only),
        (None, _) => None,
    }
}

fn have_one_in_common(one: &[Binding], other: &[Binding]) -> bool {
    one.iter().any(|one| other.iter().any(|other| one.kind == other.kind && one.is_sca == other.is_sca))
}
