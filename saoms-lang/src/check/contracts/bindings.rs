//! Rules on the bindings of one service or reference: their names, and addresses where there must be none.

use std::collections::HashMap;

use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Binding, Callback, Part, ReferenceElement, ServiceElement, Version};
use crate::source::{Location, Text};

/// Checks the bindings of a service.
pub(crate) fn of_service(service: &ServiceElement, report: &mut Report<'_>) {
    names("service", &service.name, &service.contract().bindings, report);
    of_callback(service.contract().callback.as_ref(), &service.name, report);
}

/// Checks the bindings of a reference.
pub(crate) fn of_reference(reference: &ReferenceElement, version: Version, report: &mut Report<'_>) {
    let bindings = &reference.contract().bindings;
    if bindings.is_empty() {
        return;
    }
    names("reference", &reference.name, bindings, report);
    of_callback(reference.contract().callback.as_ref(), &reference.name, report);
    let mut uris = bindings.iter().filter_map(|one| one.uri.as_ref()).filter(|uri| !uri.is_empty());
    if let (true, Some(target), Some(uri)) = (version.is_1_1(), reference.targets.first(), uris.next()) {
        let message = format!("reference {} has a target, and a binding to {}", quoted(&reference.name), quoted(uri));
        let one = Diagnostic::new(&codes::TARGET_IN_TWO_WAYS, uri.location, message).rule("ASM50026");
        report.push(one.label(target.location, "the target").help("keep one of them"));
    }
}

/// Reports a `uri` of `binding.sca`. In SCA 1.0 it is where the service can be reached from outside.
pub(crate) fn uris(service: &ServiceElement, version: Version, report: &mut Report<'_>) {
    let of_sca = service.contract().bindings.iter().filter(|binding| binding.is_sca && binding.kind == "sca");
    for binding in of_sca.filter(|_| version.is_1_1()) {
        if let Some(uri) = &binding.uri {
            let message = format!("`binding.sca` of service {} has a `uri`", quoted(&service.name));
            let at = if uri.is_empty() { binding.tag() } else { uri.location };
            let one = Diagnostic::new(&codes::SERVICE_BINDING_URI, at, message);
            report.push(one.help("remove it: references find a service by the name of its component"));
        }
    }
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
        let said = binding.name.as_ref();
        let name = said.map_or(of.as_str(), |name| name.as_str());
        let place = said.filter(|name| !name.is_empty()).map_or(binding.tag(), |name| name.location);
        let Some((other, earlier)) = first.insert(name, (binding, place)) else { continue };
        let message = format!("{what} {} has two bindings {}", quoted(of), quoted(name));
        let one = match [binding, other].into_iter().find(|one| one.name.is_none()) {
            None => Diagnostic::new(&codes::BINDING_REPEATED, place, message),
            // Whoever serves them may tell them apart by their kinds.
            Some(unnamed) => {
                let message = format!("{message}: this is the default name of `binding.{}`", unnamed.kind);
                Diagnostic::new(&codes::BINDING_REPEATED, place, message).severity(Severity::Warning)
            }
        };
        report.push(one.label(earlier, "the first").help("give each its own name"));
    }
}
