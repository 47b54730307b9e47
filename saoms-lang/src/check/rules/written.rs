//! Rules on what is written, whatever implements the components: nothing here asks a class.

use super::{bindings, service_binding_uri, type_and_element, wired_by_implementation};
use crate::check::fleet::Fleet;
use crate::check::properties;
use crate::check::report::Report;
use crate::check::values::type_name;
use crate::check::values::value_type::Typed;

/// Checks the properties, services and references of every composite and component.
pub(crate) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    for composite in fleet.units.iter().flat_map(|unit| &unit.composites) {
        for property in &composite.properties {
            type_and_element::check(property, "ASM60040", report);
            type_name::named(property, &composite.document, report);
            let typed = Typed { property, document: &composite.document };
            property.simple_values().for_each(|value| _ = typed.check(value, report));
            properties::one_value(property, composite.version, report);
        }
        wired_by_implementation::wires(composite, report);
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
            type_and_element::check(property, "ASM50035", report);
            type_name::named(property, &member.composite.document, report);
        }
        for one in &component.services {
            bindings::of_service(one, report);
            service_binding_uri::check(one, member.composite.version, report);
        }
        for one in &component.references {
            bindings::of_reference(one, member.composite.version, report);
            wired_by_implementation::reference(one, member.composite.version, report);
        }
    }
    report.about_all();
}
