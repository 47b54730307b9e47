//! Values of composite properties from the command line.

use std::collections::HashMap;

use super::{Given, Parameters};
use crate::check::Setting;
use crate::check::fleet::Fleet;
use crate::check::options::Options;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::syntax::escaped;

impl<'a> Parameters<'a> {
    /// The places of the units of composites that run by themselves.
    fn outermost<'f>(fleet: &'f Fleet<'_>) -> impl Iterator<Item = usize> + use<'f> {
        fleet.scopes.first().into_iter().flat_map(|scope| scope.units.iter().copied())
    }

    /// Gives the properties of the outermost composites the values that settings say. What is wrong with settings is
    /// reported.
    pub(super) fn set(&mut self, fleet: &Fleet<'a>, options: &'a Options, report: &mut Report<'_>) {
        let mut first: HashMap<&str, &Setting> = HashMap::new();
        for setting in &options.settings {
            if let Some(earlier) = first.insert(&setting.name, setting) {
                let message = format!("{} is set twice", quoted(&setting.name));
                report.push(
                    Diagnostic::new(&codes::SETTING_REPEATED, setting.name.location, message)
                        .label(earlier.name.location, "first here")
                        .help("keep one of them"),
                );
                continue;
            }
            let mut is_known = false;
            for unit in Self::outermost(fleet) {
                if let Some(parameter) = self.units[unit].by_name.get_mut(setting.name.as_str()) {
                    parameter.given = Some(Given::Outside(&setting.value));
                    is_known = true;
                }
            }
            // One that could not be read may have it.
            if !is_known && !is_any_unread(fleet, report) {
                let mut names: Vec<&str> =
                    Self::outermost(fleet).flat_map(|unit| self.units[unit].names()).copied().collect();
                names.sort_unstable();
                names.dedup();
                let inner = self.inner(setting);
                let message = match inner {
                    None => format!("no composite has a property {}", quoted(&setting.name)),
                    Some(_) => format!("the outermost composite has no property {}", quoted(&setting.name)),
                };
                let at = setting.name.location;
                let known = ("the properties of the composite are", names.iter().copied());
                let mut one = report.unknown(&codes::UNKNOWN_SETTING, at, message, &setting.name, known);
                if options.shared_settings {
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
        let name = setting.name.as_str();
        let mut all = self.units.iter().filter_map(|unit| Some((unit.by_name.get(name)?, unit.owner?)));
        let (parameter, owner) = all.next()?;
        Some(format!(
            "the composite {} inside has one, and has its value from component {}: let that take it from a property of the outermost composite, `<property name=\"{}\" source=\"$...\"/>`, and set this one",
            quoted(&parameter.composite.name),
            quoted(&owner.name),
            escaped(name)
        ))
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
