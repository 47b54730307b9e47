//! Services, references and what else is written of components, as far as it can be judged before wires are resolved:
//! each rule in a file.

mod bindings;
mod component_types;
pub(crate) mod interface;
pub(crate) mod multiplicity;
mod of_classes;
pub(crate) mod offer;
pub(crate) mod repeated_names;
mod wired_by_implementation;
mod written;

use crate::check::fleet::Fleet;
use crate::check::report::Report;

/// Checks what all composites and components write.
pub(crate) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    written::check(fleet, report);
    of_classes::check(fleet, report);
    component_types::check(fleet, report);
}
