//! Rules on the bindings of one service or reference: their names, and whether they lead elsewhere than what stands beside them.

use std::collections::HashMap;

use super::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Binding, Callback, Part, Reference, Service, Version};
use crate::source::{Location, Text};
use crate::syntax::Document;

/// The ends of `wsdlElement` that say where a service is.
const ADDRESSES: &[&str] = &["#wsdl.port(", "#wsdl.service(", "#wsdl.endpoint("];

/// Checks the bindings of a service.
pub(super) fn of_service(service: &Service, report: &mut Report<'_>) {
    names("service", &service.name, service.bindings(), report);
    of_callback(service.callback(), &service.name, report);
}

/// Checks the bindings of a reference.
pub(super) fn of_reference(
    reference: &Reference,
    version: Version,
    document: &Document,
    report: &mut Report<'_>,
) {
    let bindings = reference.bindings();
    if bindings.is_empty() {
        return;
    }
    names("reference", &reference.name, bindings, report);
    of_callback(reference.callback(), &reference.name, report);
    let with_uri = || bindings.iter().filter_map(|one| Some((one, one.uri.as_ref()?)));
    let with_uri = || with_uri().filter(|(_, uri)| !uri.is_empty());
    if !version.is_1_1() {
        return one_address(reference, with_uri(), Severity::Warning, report);
    }
    if let (Some(target), Some((_, uri))) = (reference.targets.first(), with_uri().next()) {
        let message = format!(
            "reference {} has a target, and a binding that leads to {}",
            quoted(&reference.name),
            quoted(uri)
        );
        let one = Diagnostic::new(&codes::TARGET_IN_TWO_WAYS, uri.location, message).rule("ASM50026");
        report.push(one.label(target.location, "the target").help("keep one of them"));
    } else {
        one_address(reference, with_uri(), Severity::Error, report);
    }
    for (binding, uri) in with_uri() {
        let element = binding.origin.element(document);
        let Some(port) = element.attribute("wsdlElement").map(|one| one.trimmed()) else { continue };
        if ADDRESSES.iter().any(|address| port.contains(address)) {
            let message = format!(
                "binding.{} of reference {} has a `uri`, and a `wsdlElement` that says where the service is",
                binding.kind,
                quoted(&reference.name)
            );
            let one = Diagnostic::new(&codes::TARGET_IN_TWO_WAYS, uri.location, message);
            let one = one.severity(Severity::Warning).rule("ASM50015");
            report.push(one.label(port.location, "the other one").help("keep one of them"));
        }
    }
}

/// Checks that a reference that takes one target has one address.
fn one_address<'b>(
    reference: &Reference,
    with_uri: impl Iterator<Item = (&'b Binding, &'b Text)>,
    severity: Severity,
    report: &mut Report<'_>,
) {
    let Some(given) = reference.multiplicity().filter(|given| !given.value.is_many()) else { return };
    // The addresses in bindings of SCA are components, which are counted with the other targets.
    let mut addresses = with_uri.filter(|(binding, _)| !(binding.is_sca && binding.kind == "sca"));
    let (Some((_, first)), Some((_, second))) = (addresses.next(), addresses.next()) else { return };
    let message = format!(
        "reference {} takes one target, and its bindings lead to {}",
        quoted(&reference.name),
        2 + addresses.count()
    );
    let rule = if given.value.is_required() { "ASM50040" } else { "ASM50039" };
    let one = Diagnostic::new(&codes::TOO_MANY_TARGETS, second.location, message).severity(severity);
    report.push(one.rule(rule).label(first.location, "the first").help("keep one of them"));
}

fn of_callback(callback: Option<&Callback>, of: &Text, report: &mut Report<'_>) {
    if let Some(callback) = callback {
        names("the callback of", of, &callback.bindings, report);
    }
}

/// Checks that the names of bindings are their own. One without a name has that of its service or reference.
fn names(what: &str, of: &Text, bindings: &[Binding], report: &mut Report<'_>) {
    if bindings.len() < 2 {
        return;
    }
    let mut first: HashMap<&str, (&Binding, Location)> = HashMap::new();
    for binding in bindings {
        let said = binding.name.as_deref();
        let name = said.map_or(of.as_str(), |name| name.as_str());
        let place = said.filter(|name| !name.is_empty()).map_or(binding.tag(), |name| name.location);
        let Some((other, earlier)) = first.insert(name, (binding, place)) else { continue };
        let message = format!("{what} {} has two bindings {}", quoted(of), quoted(name));
        let one = match [binding, other].into_iter().find(|one| one.name.is_none()) {
            None => Diagnostic::new(&codes::BINDING_REPEATED, place, message),
            // Whoever serves them may tell them apart by their kinds.
            Some(unnamed) => {
                let message = format!("{message}: `binding.{}` without a name is called so", unnamed.kind);
                Diagnostic::new(&codes::BINDING_REPEATED, place, message).severity(Severity::Warning)
            }
        };
        report.push(one.label(earlier, "the first").help("give each its own name"));
    }
}
