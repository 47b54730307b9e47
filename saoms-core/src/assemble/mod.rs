//! The difference between the fleet that runs and the fleet that is wanted.
//!
//! A [`Plan`] says what has to end, what has to start, what is replaced and what stays. A run starts with the plan from nothing to
//! its assembly and ends with the plan back to nothing, so that changing a fleet and starting it are one thing. A plan is data: making
//! it touches nothing, and needs neither a clock nor a running fleet.

mod order;
mod plan;
#[cfg(test)]
mod tests;

pub use plan::{Difference, Plan, Replacement};
