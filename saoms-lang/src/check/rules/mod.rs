//! Rules over the resolved fleet, each in a file: they run last, and those of components run code of these.

mod constructors;
mod languages;
mod networks;
mod only_read;
mod plugin_rules;
mod similar_names;
pub(crate) mod traffic;

use crate::check::component::ComponentCheck;
use crate::check::fleet::Fleet;
use crate::check::options::Options;
use crate::check::report::Report;
use crate::check::tasks::unique_values::RepeatedValues;
use crate::check::wiring::Wiring;
use crate::registry::Registry;

/// Runs the rules of constructors and of crates of components.
pub(crate) fn check(
    fleet: &Fleet<'_>,
    (checks, wiring): (&[ComponentCheck<'_>], &Wiring),
    repeated: &RepeatedValues,
    (registry, options): (&Registry, &Options),
    report: &mut Report<'_>,
) {
    only_read::check(fleet, checks, options, report);
    constructors::check_all(fleet, checks, repeated, options, report);
    networks::check(fleet, checks, report);
    let rules = registry.rules().iter();
    let rules = rules.filter(|rule| !rule.is_only_read() && (!options.without_plugin_code || rule.origin().is_none()));
    plugin_rules::check(fleet, checks, wiring, repeated, rules, report);
}
