//! Rules on what is written, whatever implements the components: nothing here asks a class.

use super::bindings;
use crate::check::fleet::Fleet;
use crate::check::properties;
use crate::check::report::Report;
use crate::check::values::global_element;
use crate::check::values::type_name;
use crate::check::values::value_type::{self, Typed};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Composite, Part, Property, ReferenceElement, ServiceElement, Version};
use crate::source::{Location, Text};

/// Checks the properties, services and references of every composite and component.
pub(crate) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    for composite in fleet.units.iter().flat_map(|unit| &unit.composites) {
        for property in &composite.properties {
            type_and_element(property, "ASM60040", report);
            global_element::check(property, &composite.document, &codes::COMPOSITE_VALUE_TYPE, report);
            type_name::named(property, &composite.document, report);
            value_type::own(Typed { property, document: &composite.document }, report);
            properties::one_value(property, composite.version, report);
        }
        if !composite.wires.is_empty() {
            wired_by_wires(composite, report);
        }
        composite.services.iter().for_each(|one| bindings::of_service(one, report));
        for one in &composite.references {
            bindings::of_reference(one, composite.version, report);
        }
    }
    for member in &fleet.members {
        report.about(member);
        let component = member.component;
        // Types and elements are among the details of a property, and few have any.
        for property in component.properties.iter().filter(|property| property.details.is_some()) {
            type_and_element(property, "ASM50035", report);
            global_element::check(property, &member.composite.document, &codes::VALUE_TYPE, report);
            type_name::named(property, &member.composite.document, report);
        }
        component.services.iter().for_each(|one| service(one, member.composite.version, report));
        for one in &component.references {
            bindings::of_reference(one, member.composite.version, report);
            reference(one, member.composite.version, report);
        }
    }
    report.about_all();
}

fn service(service: &ServiceElement, version: Version, report: &mut Report<'_>) {
    bindings::of_service(service, report);
    // In SCA 1.0 it is where the service can be reached from outside.
    let of_sca = service.bindings().iter().filter(|binding| binding.is_sca && binding.kind == "sca");
    for binding in of_sca.filter(|_| version.is_1_1()) {
        if let Some(uri) = &binding.uri {
            let message = format!("`binding.sca` of service {} has a `uri`", quoted(&service.name));
            let one = Diagnostic::new(&codes::SERVICE_BINDING_URI, at(uri, binding.tag()), message);
            report.push(one.help("remove it: a service is where its component is, and references name that"));
        }
    }
}

/// Reports a reference whose implementation wires it and that the composite wires as well (SCA Assembly 1.1, 4.3).
fn reference(reference: &ReferenceElement, version: Version, report: &mut Report<'_>) {
    let Some(wired) = reference.wired_by_impl().filter(|wired| wired.value) else { return };
    let uris = reference.bindings().iter().filter_map(|binding| binding.uri.as_ref());
    let (at, what, rule) = if let Some(target) = reference.targets.first() {
        (target.location, "has a target", "ASM50013")
    } else if let Some(uri) = uris.into_iter().find(|uri| !uri.is_empty()) {
        (uri.location, "has a binding that leads to one", "ASM50013")
    } else if let Some(autowire) = reference.autowire().filter(|autowire| autowire.value) {
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
fn wired_by_wires(composite: &Composite, report: &mut Report<'_>) {
    for component in &composite.components {
        let wired = |one: &&ReferenceElement| one.wired_by_impl().is_some_and(|wired| wired.value);
        for reference in component.references.iter().filter(wired) {
            let is_from = |source: &&Text| {
                let end = source.split_once('/');
                end == Some((component.name.as_str(), reference.name.as_str()))
            };
            let mut sources = composite.wires.iter().filter_map(|wire| wire.source.as_ref());
            let (Some(at), Some(said)) = (sources.find(is_from), reference.wired_by_impl()) else { continue };
            let what = (at.location, "starts a wire", "ASM50010");
            wired_twice(reference, what, said.location, composite.version, report);
        }
    }
}

/// A place for a text that may be empty.
fn at(text: &Text, otherwise: Location) -> Location {
    if text.is_empty() { otherwise } else { text.location }
}

pub(crate) fn type_and_element(property: &Property, rule: &'static str, report: &mut Report<'_>) {
    if let (Some(of), Some(element)) = (property.r#type(), property.element()) {
        let message = format!("the property {} has both a `type` and an `element`", quoted(&property.name));
        let one = Diagnostic::new(&codes::TYPE_AND_ELEMENT, at(element, property.tag()), message);
        report.push(one.rule(rule).label(at(of, property.tag()), "the other one").help("remove one of them"));
    }
}
