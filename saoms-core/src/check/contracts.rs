//! What components say about their services and references, held against their classes.

use std::collections::HashMap;

use super::classes::ClassIndex;
use super::fleet::Fleet;
use super::report::{Report, escaped, replacing};
use crate::diagnostic::{Code, Diagnostic, codes, quoted};
use crate::model::{Binding, Component, Interface, InterfaceKind, Multiplicity, Part, Reference};
use crate::registry::{InterfaceDeclaration, ReferenceDeclaration};
use crate::source::{Location, Text};

/// Checks the services and references of every component.
pub(super) fn check(fleet: &Fleet<'_>, classes: &[ClassIndex<'_>], report: &mut Report<'_>) {
    for (place, member) in fleet.members.iter().enumerate() {
        let component = member.component;
        let Some(class) = fleet.class_of(place, classes) else { continue };
        if !component.services.is_empty() {
            services(component, class, report);
        }
        if !component.references.is_empty() {
            references(component, class, report);
        }
    }
}

fn services(component: &Component, class: &ClassIndex<'_>, report: &mut Report<'_>) {
    let names = component.services.iter().map(|service| &service.name);
    repeated(names, component, "service", "ASM50002", report);
    for service in &component.services {
        let name = &service.name;
        match class.services.iter().find(|known| known.name == name.as_str()) {
            Some(known) => {
                interface(service.interface.as_deref(), &known.interface, name, "ASM50004", report)
            }
            None => {
                let known = class.services.iter().map(|known| known.name.as_str());
                unknown(&codes::UNKNOWN_SERVICE, "service", name, class, known, report);
            }
        }
        bindings(&service.bindings, "the service can be called within the program alone", report);
    }
}

fn references(component: &Component, class: &ClassIndex<'_>, report: &mut Report<'_>) {
    let names = component.references.iter().map(|reference| &reference.name);
    repeated(names, component, "reference", "ASM50007", report);
    for reference in &component.references {
        let name = &reference.name;
        match class.references.iter().find(|known| known.name == name.as_str()) {
            Some(known) => {
                interface(reference.interface.as_deref(), &known.interface, name, "ASM50011", report);
                multiplicity(reference, known, class, report);
            }
            None => {
                let known = class.references.iter().map(|known| known.name.as_str());
                unknown(&codes::UNKNOWN_REFERENCE, "reference", name, class, known, report);
            }
        }
        bindings(&reference.bindings, "calls through it fail", report);
    }
}

fn repeated<'a>(
    names: impl Iterator<Item = &'a Text>,
    component: &Component,
    what: &str,
    rule: &'static str,
    report: &mut Report<'_>,
) {
    let mut seen: HashMap<&str, Location> = HashMap::new();
    for name in names.filter(|name| !name.is_empty()) {
        if let Some(first) = seen.get(name.as_str()) {
            let message = format!("component {} has two {what}s {}", quoted(&component.name), quoted(name));
            let one = Diagnostic::new(&codes::CONTRACT_REPEATED, name.location, message);
            report.push(one.rule(rule).label(*first, "the first").help("keep one of them"));
        } else {
            seen.insert(name, name.location);
        }
    }
}

fn unknown<'n>(
    code: &'static Code,
    what: &str,
    name: &Text,
    class: &ClassIndex<'_>,
    known: impl Iterator<Item = &'n str> + Clone,
    report: &mut Report<'_>,
) {
    if name.is_empty() {
        return;
    }
    let class = quoted(class.class.name());
    let message = format!("class {class} has no {what} {}", quoted(name));
    let one = report.unknown(code, name.location, message, name, (&format!("its {what}s are"), known));
    report.push(one);
}

/// Whether the interface that a file names is that of the class.
fn interface(
    given: Option<&Interface>,
    declared: &InterfaceDeclaration,
    of: &str,
    rule: &'static str,
    report: &mut Report<'_>,
) {
    let Some(given) = given else { return };
    let (of, expected) = (quoted(of), quoted(&declared.name));
    let one = match &given.interface {
        Some(name)
            if matches!(given.kind, InterfaceKind::Java | InterfaceKind::Rust | InterfaceKind::Other) =>
        {
            if name.as_str() == declared.name {
                return;
            }
            let message = format!("the interface of {of} is {expected}, not {}", quoted(name));
            Diagnostic::new(&codes::INTERFACE_DIFFERS, name.location, message).suggest(
                replacing(name, &declared.name),
                name.location,
                escaped(&declared.name),
            )
        }
        // One without its name, which is reported.
        None if matches!(given.kind, InterfaceKind::Java | InterfaceKind::Rust) => return,
        _ => {
            let message = format!("the interface of {of} is {expected}, which this element cannot name");
            Diagnostic::new(&codes::INTERFACE_DIFFERS, given.tag(), message)
                .help(format!("write `<interface.java interface=\"{}\"/>`, or leave it out", declared.name))
        }
    };
    report.push(one.rule(rule));
}

/// How many targets a reference of the class can have.
pub(super) fn of_class(declared: &ReferenceDeclaration) -> Multiplicity {
    if declared.optional { Multiplicity::ZeroOrOne } else { Multiplicity::One }
}

fn multiplicity(
    reference: &Reference,
    declared: &ReferenceDeclaration,
    class: &ClassIndex<'_>,
    report: &mut Report<'_>,
) {
    let Some(given) = &reference.multiplicity else { return };
    let own = of_class(declared);
    if given.value.narrows(own) {
        return;
    }
    let message = format!(
        "the multiplicity of {} is {} in class {}: {} does not narrow it",
        quoted(&reference.name),
        quoted(own.name()),
        quoted(class.class.name()),
        quoted(given.value.name())
    );
    let one = Diagnostic::new(&codes::MULTIPLICITY_WIDER, given.location, message);
    report.push(match own {
        Multiplicity::One => one.help("leave `multiplicity` out: `1..1` is the default"),
        _ => one.help("it can be `0..1` or `1..1`"),
    });
}

fn bindings(bindings: &[Binding], so: &str, report: &mut Report<'_>) {
    for binding in bindings {
        if binding.is_sca && binding.kind == "sca" {
            continue;
        }
        let message = format!("{} is not served: {so}", quoted(&format!("binding.{}", binding.kind)));
        let one = Diagnostic::new(&codes::BINDING_NOT_SERVED, binding.tag(), message);
        report.push(
            one.help(
                "remove it; other machines are reached through topics and the `url` of a message broker",
            ),
        );
    }
}
