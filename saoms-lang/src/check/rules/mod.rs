//! Rules that stand alone, each in a file. A new one is called from here, in the place where it runs.

mod bindings;
mod component_types;
mod constructors;
mod contracts;
pub(crate) mod interface;
pub(crate) mod multiplicity;
mod plugin_rules;
pub(crate) mod repeated_names;
pub(crate) mod traffic;
pub(crate) mod unique_values;
mod wired_by_implementation;
mod written;

use super::component::ComponentCheck;
use super::fleet::Fleet;
use super::options::Options;
use super::report::Report;
use super::wiring::Wiring;
use crate::registry::Registry;
use unique_values::RepeatedValues;

/// Runs the rules over what is written, before it is known where wires lead.
pub(crate) fn check_written(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    written::check(fleet, report);
    contracts::check(fleet, report);
    component_types::check(fleet, report);
}

/// Runs the rules over the resolved fleet, which are the expensive ones: they run code of components.
pub(crate) fn check_resolved(
    fleet: &Fleet<'_>,
    (checks, wiring): (&[ComponentCheck<'_>], &Wiring),
    repeated: &RepeatedValues,
    (registry, options): (&Registry, &Options),
    report: &mut Report<'_>,
) {
    constructors::check_all(fleet, checks, repeated, options, report);
    let rules = registry.rules().iter();
    let rules = rules.filter(|rule| !options.without_plugin_code || rule.origin().is_none());
    plugin_rules::check(fleet, checks, wiring, repeated, rules, report);
}
