//! Properties of composites that have to be given a value.

use super::{Given, Parameters};
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::Property;
use crate::syntax::escaped;

impl<'a> Parameters<'a> {
    /// Finds out what components give properties that nobody took: it has to be right all the same, and there where it
    /// has to be.
    pub(super) fn follow_all(&mut self, fleet: &Fleet<'a>, report: &mut Report<'_>) {
        for (place, unit) in fleet.units.iter().enumerate().filter(|(_, unit)| !unit.is_absent) {
            for property in unit.composites.iter().flat_map(|composite| &composite.properties) {
                let name = property.name.as_str();
                let is_open = self.units[place].by_name.get(name).is_some_and(|parameter| {
                    matches!(parameter.given, Some(Given::Component(..))) && parameter.whole.is_none()
                });
                if !is_open {
                    continue;
                }
                let owner = fleet.scopes[unit.scope].owner;
                owner.into_iter().for_each(|owner| report.about(&fleet.members[owner]));
                let _ = self.whole(place, name, report);
                report.about_all();
            }
        }
    }

    /// The diagnostic about a property of a unit that has to be given a value and has none.
    pub(super) fn missing(&self, unit: usize, property: &Property, assumes: bool) -> Diagnostic {
        let name = &property.name;
        let Some(owner) = self.units[unit].owner else {
            let message = format!("the property {} of the composite has to be given a value", quoted(name));
            let one = Diagnostic::new(&codes::COMPOSITE_PROPERTY_MISSING, name.location, message)
                .help(from_outside(property));
            // Where classes are taken as given, so is the component that this composite may implement.
            return match assumes {
                true => one
                    .severity(Severity::Warning)
                    .help("as an implementation, it takes the value that its component gives it"),
                false => one,
            };
        };
        let message = format!(
            "component {} has to give the property {} of its composite a value",
            quoted(&owner.name),
            quoted(name)
        );
        let told = |at, message| {
            let one = Diagnostic::new(&codes::COMPOSITE_PROPERTY_MISSING, at, message);
            one.label(name.location, "declared here, without a value")
        };
        match self.units[unit].by_name.get(name.as_str()).and_then(|parameter| parameter.given) {
            Some(Given::Component(place, given)) => match given.source() {
                Some(source) => {
                    let one = told(source.location, format!("{message}: its source has none"));
                    self.supply(place.unit, source, one)
                }
                None => told(given.name.location, message).help("write the value inside"),
            },
            _ => told(owner.name.location, message)
                .help(format!("add `<property name=\"{}\">...</property>`", escaped(name))),
        }
    }
}

/// True if a property has to be given a value from outside.
pub(super) fn is_asked_for(property: &Property) -> bool {
    property.must_supply().is_some_and(|must| must.value) && !property.has_value()
}

/// Help: ways to give a value to a property of a composite that runs by itself.
pub(super) fn from_outside(property: &Property) -> String {
    let name = &property.name;
    match property.env() {
        Some(variable) => {
            format!("write it in the file, give `--set {name}=...`, or set {} in the environment", quoted(variable))
        }
        None => format!("write it in the file, or give `--set {name}=...`"),
    }
}
