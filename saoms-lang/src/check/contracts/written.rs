//! Rules on what is written, whatever implements the components: nothing here asks a class.

use super::{bindings, wired_by_implementation};
use crate::check::fleet::Fleet;
use crate::check::properties;
use crate::check::report::Report;
use crate::check::values::type_name;
use crate::check::values::value_type::Typed;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Part, Property};
use crate::source::{Location, Text};

/// Checks the properties, services and references of every composite and component.
pub(crate) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    for composite in fleet.units.iter().flat_map(|unit| &unit.composites) {
        for property in &composite.properties {
            type_and_element(property, "ASM60040", report);
            type_name::named(property, &composite.document, report);
            let typed = Typed { property, document: &composite.document };
            property.simple_values().for_each(|value| typed.check(value, &fleet.faulty_values, report));
            properties::one_value(property, composite.version, report);
        }
        wired_by_implementation::wires(composite, report);
        composite.services.iter().for_each(|one| bindings::of_service(one, report));
        for one in &composite.references {
            bindings::of_reference(one, composite.version, report);
        }
    }
    for (place, member) in fleet.members.iter().enumerate() {
        report.about(member);
        wired_by_implementation::from_outside(place, fleet, report);
        let component = member.component;
        // Most are a text alone, of no type.
        for property in component.properties.iter().filter(|property| property.only_text().is_none()) {
            type_and_element(property, "ASM50035", report);
            type_name::named(property, &member.composite.document, report);
        }
        for one in &component.services {
            bindings::of_service(one, report);
            bindings::uris(one, member.composite.version, report);
        }
        for one in &component.references {
            bindings::of_reference(one, member.composite.version, report);
            wired_by_implementation::reference(one, member.composite.version, report);
        }
    }
    report.about_all();
}

/// A place for a text that may be empty.
fn at(text: &Text, otherwise: Location) -> Location {
    if text.is_empty() { otherwise } else { text.location }
}

/// Reports a property with both a `type` and an `element`.
fn type_and_element(property: &Property, rule: &'static str, report: &mut Report<'_>) {
    if let (Some(of), Some(element)) = (property.r#type(), property.element()) {
        let message = format!("the property {} has both a `type` and an `element`", quoted(&property.name));
        let one = Diagnostic::new(&codes::TYPE_AND_ELEMENT, at(element, property.tag()), message);
        report.push(one.rule(rule).label(at(of, property.tag()), "the `type`").help("remove one of them"));
    }
}
