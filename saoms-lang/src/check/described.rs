//! Component types: held against themselves, against the classes they describe, and against the components that use them.

use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};

use saoms_api::host::PropertyValue;

use super::checked::Given;
use super::classes::ClassIndex;
use super::contracts::{narrows, of_class as of_class_reference};
use super::fleet::{Fleet, Member};
use super::given;
use super::global;
use super::parameters::{Found, is_misspelt};
use super::properties::one_value;
use super::report::Report;
use super::type_name;
use super::value_type::{self, Typed};
use super::written::type_and_element;
use crate::diagnostic::{Code, Diagnostic, Severity, codes, quoted};
use crate::model::{Component, ComponentType, Multiplicity, Part, Property, Reference, Version};
use crate::source::{Location, Text};
use crate::syntax::escaped;

impl<'a> Fleet<'a> {
    /// What a file beside the implementation of a component says about it.
    pub(super) fn component_type(&self, member: usize) -> Option<&'a ComponentType> {
        if !self.contribution.describes_any() {
            return None;
        }
        let implementation = self.members[member].component.implementation.as_ref()?;
        self.contribution.component_type(implementation.origin)
    }
}

pub(super) fn check(fleet: &Fleet<'_>, classes: &[ClassIndex<'_>], report: &mut Report<'_>) {
    for described in fleet.contribution.component_types() {
        for property in &described.properties {
            type_and_element(property, "ASM40010", report);
            global::check(property, &described.document, &codes::COMPOSITE_VALUE_TYPE, report);
            type_name::named(property, &described.document, report);
            value_type::own(Typed { property, document: &described.document }, report);
            one_value(property, described.version, report);
            two_ways(property, report);
        }
        repeated(
            described.services.iter().map(|one| &one.name),
            "service",
            "ASM40003",
            described.version,
            report,
        );
        repeated(
            described.references.iter().map(|one| &one.name),
            "reference",
            "ASM40004",
            described.version,
            report,
        );
        repeated(
            described.properties.iter().map(|one| &one.name),
            "property",
            "ASM40005",
            described.version,
            report,
        );
    }
    if !fleet.contribution.describes_any() {
        return;
    }
    for (place, member) in fleet.members.iter().enumerate() {
        report.about(member);
        if let Some(described) = fleet.component_type(place) {
            match fleet.class_of(place, classes) {
                Some(class) => {
                    of_class(described, class, report);
                    used(member, described, class, report);
                }
                None => {
                    let known = fleet.known(place);
                    known.into_iter().for_each(|known| given::contracts(member.component, known, report));
                }
            }
        } else if let Some(implementation) = &member.component.implementation
            && fleet.contribution.lacks_component_type(implementation.origin)
        {
            let message =
                format!("nothing describes what component {} offers", quoted(&member.component.name));
            let one = Diagnostic::new(&codes::COMPONENT_TYPE_MISSING, implementation.tag(), message);
            let kind = implementation.origin.element(&member.composite.document).local_name();
            report.push(one.help(format!(
                "{} does not say it by itself: write a file of its name that ends with `.componentType`",
                quoted(kind)
            )));
        }
    }
    report.about_all();
}

/// Reports a property whose value is written as an attribute and inside.
fn two_ways(property: &Property, report: &mut Report<'_>) {
    let inside = property.values().first().map(Part::tag);
    let inside = inside.or_else(|| property.text().map(|text| text.location));
    let (Some(first), Some(second)) = (property.value(), inside) else { return };
    let message = format!("the property {} is given a value in two ways", quoted(&property.name));
    let one = Diagnostic::new(&codes::VALUE_IN_TWO_WAYS, second, message);
    report.push(one.label(first.location, "the other one").help("keep one of them"));
}

fn repeated<'t>(
    names: impl Iterator<Item = &'t Text>,
    what: &str,
    rule: &'static str,
    version: Version,
    report: &mut Report<'_>,
) {
    let mut seen: HashMap<&str, Location> = HashMap::new();
    for name in names.filter(|name| !name.is_empty()) {
        if let Some(first) = seen.get(name.as_str()) {
            let message = format!("the component type has two {what}s {}", quoted(name))
                .replace("propertys", "properties");
            // SCA 1.0 leaves it open which of them counts.
            let severity = if version.is_1_1() { Severity::Error } else { Severity::Warning };
            let one = Diagnostic::new(&codes::COMPONENT_TYPE_REPEATED, name.location, message);
            let one = one.severity(severity);
            report.push(one.rule(rule).label(*first, "the first").help("give each its own name"));
        } else {
            seen.insert(name, name.location);
        }
    }
}

/// Reports what a component type says of a class that is not so.
fn of_class(described: &ComponentType, class: &ClassIndex<'_>, report: &mut Report<'_>) {
    let of = quoted(class.class.name());
    let mut unknown = |code: &'static Code, what: &str, name: &Text, known: &[&str]| {
        if !name.is_empty() && !known.contains(&name.as_str()) {
            let message = format!("class {of} has no {what} {}", quoted(name));
            let known_as = match what {
                "property" => "its properties are".to_owned(),
                _ => format!("its {what}s are"),
            };
            let known = (known_as.as_str(), known.iter().copied());
            let one = report.unknown(code, name.location, message, name, known);
            report.push(one);
        }
    };
    let services: Vec<&str> = class.services.iter().map(|one| one.name.as_str()).collect();
    let references: Vec<&str> = class.references.iter().map(|one| one.name.as_str()).collect();
    let properties: Vec<&str> = class.slots.names().collect();
    described
        .services
        .iter()
        .for_each(|one| unknown(&codes::UNKNOWN_SERVICE, "service", &one.name, &services));
    for one in &described.references {
        unknown(&codes::UNKNOWN_REFERENCE, "reference", &one.name, &references);
    }
    for one in &described.properties {
        unknown(&codes::UNKNOWN_PROPERTY, "property", &one.name, &properties);
    }
}

/// Checks a component of a class against what the file says more narrowly than the class.
fn used(member: &Member<'_>, described: &ComponentType, class: &ClassIndex<'_>, report: &mut Report<'_>) {
    supplied(member.component, described, report);
    for reference in member.component.references.iter() {
        multiplicity(reference, described, report);
    }
    let whose = format!("class {}", quoted(class.class.name()));
    for own in &described.references {
        if let Some(declared) = class.references.iter().find(|one| one.name == own.name.as_str()) {
            narrows(own, of_class_reference(declared), &whose, report);
        }
    }
}

/// Checks what a component gives for a property of its class against the type that the file says.
pub(super) fn value(described: &ComponentType, name: &str, given: Given<'_>, report: &mut Report<'_>) {
    let Some(property) = described.properties.iter().find(|one| one.name == *name) else { return };
    let declared = Typed { property, document: &described.document };
    let values = match given.value {
        PropertyValue::Many(values) => &values[..],
        one => std::slice::from_ref(one),
    };
    for (value, place) in values.iter().zip(given.places()) {
        if let PropertyValue::Text(text) = value {
            value_type::holds(declared, &Text::new(text.as_str().into(), place), &codes::VALUE_TYPE, report);
        }
    }
}

/// Reports the properties that a component has to give, and does not: those that the file says must be supplied and gives no value.
pub(super) fn supplied(component: &Component, described: &ComponentType, report: &mut Report<'_>) {
    let names = OnceCell::new();
    let is_declared = |name: &str| {
        let all = || described.properties.iter().map(|one| one.name.as_str()).collect::<HashSet<&str>>();
        names.get_or_init(all).contains(name)
    };
    for property in &described.properties {
        let must = property.must_supply().is_some_and(|must| must.value) && !property.has_value();
        let is_missing = must && component.property(&property.name).is_none();
        if is_missing && !is_misspelt(&property.name, component, is_declared) {
            let message = format!(
                "component {} lacks the property {}",
                quoted(&component.name),
                quoted(&property.name)
            );
            report.push(
                Diagnostic::new(&codes::PROPERTY_MISSING, component.name.location, message)
                    .label(property.name.location, "declared here, without a value")
                    .help(format!("add `<property name=\"{}\">...</property>`", escaped(&property.name))),
            );
        }
    }
}

/// Reports a property that has to be supplied, and is written without a value; and one that says that it need not be.
pub(super) fn lacks_value(
    (property, version): (&Property, Version),
    found: &Found<'_>,
    described: &ComponentType,
    report: &mut Report<'_>,
) {
    let declared = described.properties.iter().find(|declared| declared.name == *property.name.value);
    let Some(declared) = declared else { return };
    let Some(must) = declared.must_supply().filter(|must| must.value) else { return };
    // In SCA 1.1 a component has no such attribute.
    if let Some(said) = property.must_supply().filter(|said| !said.value && !version.is_1_1()) {
        let message =
            format!("the property {} has to be supplied, whatever a component says", quoted(&property.name));
        let one = Diagnostic::new(&codes::MUST_SUPPLY_DIFFERS, said.location, message);
        report.push(one.label(must.location, "said here").help("remove `mustSupply`"));
    }
    if found.raw.0.is_empty() && !declared.has_value() {
        let why = if property.source().is_some() { ": its source has none" } else { "" };
        let message = format!("the property {} has no value{why}", quoted(&property.name));
        let at = property.source().map_or(property.name.location, |source| source.location);
        let severity = if described.version.is_1_1() { Severity::Error } else { Severity::Warning };
        report.push(
            Diagnostic::new(&codes::PROPERTY_MISSING, at, message)
                .severity(severity)
                .label(declared.name.location, "it has to be supplied by this description")
                .help("give it a value"),
        );
    }
}

/// Checks that the multiplicity that a component gives its reference narrows that of the file.
pub(super) fn multiplicity(reference: &Reference, described: &ComponentType, report: &mut Report<'_>) {
    if let Some(own) = described.references.iter().find(|own| own.name == *reference.name.value) {
        let own = own.multiplicity().map_or(Multiplicity::One, |own| own.value);
        narrows(reference, own, &"the component type", report);
    }
}
