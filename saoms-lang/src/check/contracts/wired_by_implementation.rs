//! References that their implementations wire, and something else as well.

use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Composite, ReferenceElement, Version};
use crate::source::{Location, Text};

/// Reports a reference whose implementation wires it and that the composite wires as well (SCA Assembly 1.1, 4.3).
pub(crate) fn reference(reference: &ReferenceElement, version: Version, report: &mut Report<'_>) {
    let Some(wired) = reference.wired_by_impl.filter(|wired| wired.value) else { return };
    let uris = reference.contract().bindings.iter().filter_map(|binding| binding.uri.as_ref());
    let (at, what, rule) = if let Some(target) = reference.targets.first() {
        (target.location, "has a target", "ASM50013")
    } else if let Some(uri) = uris.into_iter().find(|uri| !uri.is_empty()) {
        (uri.location, "has a binding that leads to one", "ASM50013")
    } else if let Some(autowire) = reference.autowire.filter(|autowire| autowire.value) {
        (autowire.location, "asks for one by `autowire`", "ASM50010")
    } else {
        return;
    };
    wired_twice(reference, (at, what, rule), wired.location, version, report);
}

fn wired_twice(
    reference: &ReferenceElement,
    (at, what, rule): (Location, &str, &'static str),
    said: Location,
    version: Version,
    report: &mut Report<'_>,
) {
    let message = format!("reference {} is wired by its implementation, and {what}", quoted(&reference.name));
    let severity = if version.is_1_1() { Severity::Error } else { Severity::Warning };
    let one = Diagnostic::new(&codes::WIRED_BY_IMPLEMENTATION, at, message).severity(severity).rule(rule);
    report.push(one.label(said, "said here").help("remove the target, or `wiredByImpl`"));
}

/// Reports wires that start from references that their implementations wire, which are few.
pub(crate) fn wires(composite: &Composite, report: &mut Report<'_>) {
    if composite.wires.is_empty() {
        return;
    }
    for component in &composite.components {
        let wired = |one: &&ReferenceElement| one.wired_by_impl.is_some_and(|wired| wired.value);
        for reference in component.references.iter().filter(wired) {
            let is_from = |source: &&Text| {
                let end = source.split_once('/');
                end == Some((component.name.as_str(), reference.name.as_str()))
            };
            let mut sources = composite.wires.iter().filter_map(|wire| wire.source.as_ref());
            let (Some(at), Some(said)) = (sources.find(is_from), reference.wired_by_impl) else { continue };
            let what = (at.location, "starts a wire", "ASM50010");
            wired_twice(reference, what, said.location, composite.version, report);
        }
    }
}
