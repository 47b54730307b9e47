//! Values of composite properties from outside: what the command line says of them, and those that have to be given
//! one.

use std::collections::{BTreeSet, HashMap};

use super::{Given, Parameters};
use crate::check::Setting;
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::Property;
use crate::syntax::escaped;

impl Parameters<'_> {
    /// The places of the units of composites that run by themselves.
    fn outermost<'f>(fleet: &'f Fleet<'_>) -> impl Iterator<Item = usize> + use<'f> {
        fleet.scopes.first().into_iter().flat_map(|scope| scope.units.iter().copied())
    }

    /// Reports what is wrong with the settings of properties of the outermost composites.
    pub(super) fn set(&self, fleet: &Fleet<'_>, report: &mut Report<'_>) {
        let mut first: HashMap<&str, &Setting> = HashMap::new();
        for setting in &self.options.settings {
            if let Some(earlier) = first.insert(&setting.name, setting) {
                let message = format!("{} is set twice", quoted(&setting.name));
                let one = Diagnostic::new(&codes::SETTING_REPEATED, setting.name.location, message);
                report.push(one.label(earlier.name.location, "first set here").help("keep one of them"));
                continue;
            }
            let is_known =
                Self::outermost(fleet).any(|unit| self.units[unit].by_name.contains_key(setting.name.as_str()));
            // One that could not be read may have it.
            if !is_known && !is_any_unread(fleet, report) {
                let names = Self::outermost(fleet).flat_map(|unit| self.units[unit].by_name.keys().copied());
                let names: BTreeSet<&str> = names.collect();
                let inner = self.inner(setting);
                let message = match inner {
                    None => format!("no composite has a property {}", quoted(&setting.name)),
                    Some(_) => format!("the outermost composite has no property {}", quoted(&setting.name)),
                };
                let at = setting.name.location;
                let known = ("the properties of the composite are", names.iter().copied());
                let mut one = report.unknown(&codes::UNKNOWN_SETTING, at, message, &setting.name, known);
                if self.options.shared_settings {
                    one = one.severity(Severity::Note);
                }
                report.push(match inner {
                    Some(help) if one.suggestions.is_empty() => one.help(help),
                    _ if names.is_empty() => {
                        one.help("declare it: `<property name=\"...\">...</property>` in the composite")
                    }
                    _ => one,
                });
            }
        }
    }

    /// Help for a setting of a property that only composites inside have.
    fn inner(&self, setting: &Setting) -> Option<String> {
        // As people write the path of a component before it.
        let name = setting.name.rsplit('/').next().unwrap_or_default();
        let mut all = self.units.iter().filter_map(|unit| Some((unit.by_name.get(name)?, unit.owner?)));
        let (parameter, owner) = all.next()?;
        Some(format!(
            "the inner composite {} has this property, and component {} gives it a value: take the value from a \
            property of the outermost composite there, `<property name=\"{}\" source=\"$...\"/>`, and set that \
            property",
            quoted(&parameter.composite.name),
            quoted(&owner.name),
            escaped(name)
        ))
    }

    /// The diagnostic about a property of a unit that has to be given a value and has none.
    pub(super) fn missing(&self, unit: usize, property: &Property, assumes: bool) -> Diagnostic {
        let name = &property.name;
        let Some(owner) = self.units[unit].owner else {
            let message = format!("the property {} of the composite needs a value", quoted(name));
            let one = Diagnostic::new(&codes::COMPOSITE_PROPERTY_MISSING, name.location, message)
                .help(from_outside(property));
            // Where classes are taken as given, so is the component that this composite may implement.
            return match assumes {
                true => one
                    .severity(Severity::Warning)
                    .help("where the composite implements a component, that component gives the value"),
                false => one,
            };
        };
        let message = format!(
            "component {} must give a value to the property {} of its composite",
            quoted(&owner.name),
            quoted(name)
        );
        let missing = |at, message| {
            let one = Diagnostic::new(&codes::COMPOSITE_PROPERTY_MISSING, at, message);
            one.label(name.location, "declared here, without a value")
        };
        match self.units[unit].by_name.get(name.as_str()).and_then(|parameter| parameter.given) {
            Some(Given::Component(place, given)) => match given.source() {
                Some(source) => {
                    let one = missing(source.location, format!("{message}: its source has no value"));
                    self.supply(place.unit, source, one)
                }
                None => missing(given.name.location, message).help("write the value inside"),
            },
            _ => missing(owner.name.location, message)
                .help(format!("add `<property name=\"{}\">...</property>`", escaped(name))),
        }
    }
}

/// True if a file could not be read that may hold a composite, which is reported.
fn is_any_unread(fleet: &Fleet<'_>, report: &mut Report<'_>) -> bool {
    let composites = fleet.contribution.composites();
    let is_of_files = |one: &&Diagnostic| one.code.id.starts_with("S00") || one.code.id.starts_with("S01");
    let faults = report.diagnostics().iter().filter(|one| one.severity == Severity::Error);
    let mut files = faults.filter(is_of_files).map(|one| one.location.file);
    files.any(|file| composites.iter().all(|composite| composite.file() != file))
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
