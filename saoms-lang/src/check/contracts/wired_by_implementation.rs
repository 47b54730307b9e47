//! References that their implementations wire, and something else as well.

use crate::check::contracts::offer::parts;
use crate::check::fleet::{Fleet, Kind, Unit};
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Composite, ReferenceElement, Version};
use crate::source::{Located, Location, Text};

/// Reports a reference whose implementation wires it and that the composite wires as well (SCA Assembly 1.1, 4.3).
pub(crate) fn reference(reference: &ReferenceElement, version: Version, report: &mut Report<'_>) {
    let Some(wired) = wired(reference) else { return };
    let uris = reference.contract().bindings.iter().filter_map(|binding| binding.uri.as_ref());
    let (at, what, rule) = if let Some(target) = reference.targets.first() {
        (target.location, "has a target", "ASM50013")
    } else if let Some(uri) = uris.into_iter().find(|uri| !uri.is_empty()) {
        (uri.location, "has a binding that leads to one", "ASM50013")
    } else if let Some(autowire) = reference.autowire.filter(|autowire| autowire.value) {
        (autowire.location, "has `autowire`", "ASM50010")
    } else {
        return;
    };
    wired_twice(&reference.name, (at, what, rule), wired.location, severity(version), report);
}

fn severity(version: Version) -> Severity {
    if version.is_1_1() { Severity::Error } else { Severity::Warning }
}

fn wired_twice(
    name: &str,
    (at, what, rule): (Location, &str, &'static str),
    said: Location,
    severity: Severity,
    report: &mut Report<'_>,
) {
    let message = format!("reference {} is wired by its implementation, but {what}", quoted(name));
    let one = Diagnostic::new(&codes::WIRED_BY_IMPLEMENTATION, at, message).severity(severity).rule(rule);
    let help = match what {
        "has a target" => "remove the target, or `wiredByImpl`",
        "starts a wire" => "remove the wire, or `wiredByImpl`",
        "has `autowire`" => "remove `autowire`, or `wiredByImpl`",
        _ => "remove the `uri` of the binding, or `wiredByImpl`",
    };
    report.push(one.label(said, "`wiredByImpl` is set here").help(help));
}

/// Reports references that implementations wire, and that the composite or its wires lead somewhere; these are few.
pub(crate) fn wires(composite: &Composite, report: &mut Report<'_>) {
    for reference in &composite.references {
        if let (Some(wired), Some(target)) = (wired(reference), reference.targets.first()) {
            let what = (target.location, "has a target", "ASM40006");
            wired_twice(&reference.name, what, wired.location, Severity::Warning, report);
        }
    }
    if composite.wires.is_empty() {
        return;
    }
    for component in &composite.components {
        for (reference, said) in component.references.iter().filter_map(|one| Some((one, wired(one)?))) {
            let is_from = |source: &&Text| {
                let end = source.split_once('/');
                end == Some((component.name.as_str(), reference.name.as_str()))
            };
            let mut sources = composite.wires.iter().filter_map(|wire| wire.source.as_ref());
            let Some(at) = sources.find(is_from) else { continue };
            let what = (at.location, "starts a wire", "ASM50010");
            wired_twice(&reference.name, what, said.location, severity(composite.version), report);
        }
    }
}

/// Reports what a component gives as targets of references that its composite, or its component type, says to be wired
/// by the implementation.
pub(crate) fn from_outside(place: usize, fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let member = &fleet.members[place];
    let inner = fleet.inner(place).into_iter().flat_map(Unit::references);
    let described = fleet.component_type(place).into_iter().flat_map(|described| &described.references);
    for reference in inner.chain(described) {
        let own = member.component.reference(&reference.name);
        let Some(said) = said(place, reference, fleet).filter(|_| own.and_then(wired).is_none()) else {
            continue;
        };
        let mut wires = member.composite.wires.iter().filter_map(|wire| wire.source.as_ref());
        let is_from = |source: &&Text| parts(source) == (member.component.name.as_str(), Some(reference.name.as_str()));
        let (at, what) = match own.and_then(|own| own.targets.first()) {
            Some(target) => (target, "has a target"),
            None => match wires.find(is_from) {
                Some(source) => (source, "starts a wire"),
                None => continue,
            },
        };
        wired_twice(&reference.name, (at.location, what, "ASM40006"), said, Severity::Warning, report);
    }
}

/// The place that says that the implementation wires a reference, or the first one that it promotes.
fn said<'f>(mut member: usize, mut reference: &'f ReferenceElement, fleet: &'f Fleet<'_>) -> Option<Location> {
    // Each step leads one composite further in.
    loop {
        if let Some(wired) = wired(reference) {
            return Some(wired.location);
        }
        let Kind::Composite(scope) = fleet.members[member].kind else { return None };
        let (component, name) = parts(reference.promote.first()?);
        let name = name?;
        member = fleet.find(scope, component)?;
        if let Some(wired) = fleet.members[member].component.reference(name).and_then(wired) {
            return Some(wired.location);
        }
        reference = fleet.inner(member)?.references().find(|one| one.name == name)?;
    }
}

/// The place that says that its implementation wires a reference.
fn wired(reference: &ReferenceElement) -> Option<Located<bool>> {
    reference.wired_by_impl.filter(|wired| wired.value)
}
