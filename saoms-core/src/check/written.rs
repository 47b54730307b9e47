//! Rules on what is written, whatever implements the components: nothing here asks a class.

use std::collections::HashMap;

use super::fleet::Fleet;
use super::global;
use super::report::Report;
use super::value_type;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Binding, Part, Property, Reference, Service, Version};
use crate::source::{Location, Text};

/// Checks the properties, services and references of every composite and component.
pub(super) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    for composite in fleet.units.iter().flat_map(|unit| &unit.composites) {
        for property in &composite.properties {
            type_and_element(property, "ASM60040", report);
            global::check(property, &composite.document, &codes::COMPOSITE_VALUE_TYPE, report);
            value_type::named(property, &composite.document, report);
            value_type::own(property, report);
        }
        composite
            .services
            .iter()
            .for_each(|service| bindings("service", &service.name, service.bindings(), report));
        for reference in &composite.references {
            bindings("reference", &reference.name, reference.bindings(), report);
        }
    }
    for member in &fleet.members {
        report.about(member);
        let component = member.component;
        for property in &component.properties {
            type_and_element(property, "ASM50035", report);
            global::check(property, &member.composite.document, &codes::VALUE_TYPE, report);
            value_type::named(property, &member.composite.document, report);
        }
        component.services.iter().for_each(|one| service(one, member.composite.version, report));
        component.references.iter().for_each(|one| reference(one, member.composite.version, report));
    }
    report.about_all();
}

fn service(service: &Service, version: Version, report: &mut Report<'_>) {
    bindings("service", &service.name, service.bindings(), report);
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

fn reference(reference: &Reference, version: Version, report: &mut Report<'_>) {
    bindings("reference", &reference.name, reference.bindings(), report);
    if reference.wired_by_impl().is_some_and(|wired| wired.value)
        && let Some(target) = reference.targets.first()
    {
        let message =
            format!("reference {} is wired by its implementation, and has a target", quoted(&reference.name));
        let severity = if version.is_1_1() { Severity::Error } else { Severity::Warning };
        let mut one = Diagnostic::new(&codes::WIRED_BY_IMPLEMENTATION, target.location, message)
            .severity(severity)
            .help("remove the target, or `wiredByImpl`");
        if let Some(wired) = reference.wired_by_impl() {
            one = one.label(wired.location, "said here");
        }
        report.push(one);
    }
}

/// A place for a text that may be empty.
fn at(text: &Text, otherwise: Location) -> Location {
    if text.is_empty() { otherwise } else { text.location }
}

fn bindings(what: &str, name: &Text, bindings: &[Binding], report: &mut Report<'_>) {
    if bindings.len() < 2 {
        return;
    }
    let mut first: HashMap<&str, Location> = HashMap::new();
    for given in bindings.iter().filter_map(|binding| binding.name.as_deref()) {
        let Some(earlier) = first.insert(given, given.location) else { continue };
        let message = format!("{what} {} has two bindings {}", quoted(name), quoted(given));
        let one = Diagnostic::new(&codes::BINDING_REPEATED, at(given, earlier), message);
        report.push(one.label(earlier, "the first").help("give each its own name"));
    }
}

pub(super) fn type_and_element(property: &Property, rule: &'static str, report: &mut Report<'_>) {
    if let (Some(of), Some(element)) = (property.r#type(), property.element()) {
        let message = format!("the property {} has both a `type` and an `element`", quoted(&property.name));
        let one = Diagnostic::new(&codes::TYPE_AND_ELEMENT, at(element, property.tag()), message);
        report.push(one.rule(rule).label(at(of, property.tag()), "the other one").help("remove one of them"));
    }
}
