//! Zones: passage through the blocks of a map, granted to robots.
//!
//! `docs/zones.md` describes the protocol, and why it is safe. `Ledger` is a zone's part of it, `Passage` a robot's;
//! both are state machines without clock and chance. `plan` decides which robot is granted which block.

mod asides;
mod asking;
mod beginning;
mod borders;
mod component;
mod dead_ends;
mod deadlock;
mod ground;
mod ledger;
mod maneuver;
mod memory;
mod passage;
mod plan;
mod properties;
mod spoken;
mod status;
mod territories;

#[cfg(test)]
mod explore_tests;
#[cfg(test)]
mod plan_tests;

pub use component::Zone;
pub use properties::ZoneProperties;

pub(crate) use borders::staying;
pub(crate) use passage::{Held, Link, Passage, Wish};
pub(crate) use territories::Territories;
