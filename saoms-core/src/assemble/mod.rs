//! The difference between the fleet that runs and the fleet that is wanted.
//!
//! A [`ChangePlan`] names the components that end, that start, that are replaced, that take new values and that stay. A
//! run starts with the plan from nothing to its assembly and ends with the plan back to nothing, so that changing a
//! fleet and starting it are one thing. A plan is data: making it touches nothing, and needs neither a clock nor a
//! running fleet.

mod fingerprint;
mod order;
mod plan;
#[cfg(test)]
mod tests;

pub use fingerprint::fingerprint;
pub(crate) use order::providers_first;
pub(crate) use plan::value;
pub use plan::{ChangePlan, Difference, LiveUpdate, Replacement};

use saoms_lang::assembly::{Assembly, ComponentSpec};

/// The components of a fleet by their numbers, to which wires lead; `None` is a number that is not in use.
pub type Members<'a> = [Option<&'a ComponentSpec>];

/// The components of an assembly by their places.
pub fn members(assembly: &Assembly) -> Vec<Option<&ComponentSpec>> {
    assembly.components.iter().map(Some).collect()
}
