//! Names in component types: held against each other, against the classes that they describe, and against the
//! components that use them.

use crate::check::contracts::of_classes::unknown;
use crate::check::contracts::repeated_names::Owner;
use crate::check::fleet::Fleet;
use crate::check::fleet::class_index::ClassIndex;
use crate::check::properties::foreign;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{ComponentType, Part};

pub(crate) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    for described in fleet.contribution.component_types() {
        let owner = Owner {
            name: &|| "the component type".to_owned(),
            code: &codes::COMPONENT_TYPE_REPEATED,
            // SCA 1.0 leaves it open which of them counts.
            severity: if described.version.is_1_1() { Severity::Error } else { Severity::Warning },
            help: "give each its own name",
        };
        let ComponentType { services, references, properties, .. } = described;
        owner.check("services", "ASM40003", services.iter().map(|one| &one.name), report);
        owner.check("references", "ASM40004", references.iter().map(|one| &one.name), report);
        owner.check("properties", "ASM40005", properties.iter().map(|one| &one.name), report);
    }
    if !fleet.contribution.describes_any() {
        return;
    }
    for (place, member) in fleet.members.iter().enumerate() {
        report.about(member);
        if let Some(described) = fleet.component_type(place) {
            match fleet.class_of(place) {
                Some(class) => of_class(described, class, report),
                None => {
                    let known = fleet.known(place);
                    known.into_iter().for_each(|known| foreign::contracts(member.component, known, report));
                }
            }
        } else if let Some(implementation) = &member.component.implementation
            && fleet.contribution.lacks_component_type(implementation.origin)
        {
            let message = format!(
                "the services, references and properties of component {} are unknown",
                quoted(&member.component.name)
            );
            let one = Diagnostic::new(&codes::COMPONENT_TYPE_MISSING, implementation.tag(), message);
            let kind = implementation.origin.element(&member.composite.document).local_name();
            report.push(one.help(format!(
                "{} does not declare them: write them in a component type, a file with the same name and the ending \
                `.componentType`",
                quoted(kind)
            )));
        }
    }
    report.about_all();
}

/// Reports what a component type says of a class that is not so.
fn of_class(described: &ComponentType, class: &ClassIndex<'_>, report: &mut Report<'_>) {
    let of = format!("class {}", quoted(class.class.name()));
    let names: Vec<&str> = class.services.iter().map(|one| one.name.as_str()).collect();
    for one in &described.services {
        unknown(&codes::UNKNOWN_SERVICE, ("service", "services"), &one.name, &of, &names, report);
    }
    let names: Vec<&str> = class.references.iter().map(|one| one.name.as_str()).collect();
    for one in &described.references {
        unknown(&codes::UNKNOWN_REFERENCE, ("reference", "references"), &one.name, &of, &names, report);
    }
    let names: Vec<&str> = class.table.names().collect();
    for one in &described.properties {
        unknown(&codes::UNKNOWN_PROPERTY, ("property", "properties"), &one.name, &of, &names, report);
    }
}
