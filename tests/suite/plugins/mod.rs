//! Libraries that are loaded: the examples, components in C, and code that changes while the fleet runs.

mod c;
mod c_zones;
mod counter;
mod examples;
mod loops;
mod python;
mod reload;
mod wheels;

pub(crate) use c::library as c_library;
pub(crate) use examples::library;
