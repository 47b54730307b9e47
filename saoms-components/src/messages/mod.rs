//! Messages and topics of the fleet. Each message stands in the file of its subject, with its topic, which says who
//! publishes and reads it, and with its validation.

mod environment;
mod movement;
mod team;
mod visit;

pub use environment::*;
pub use movement::*;
pub use team::*;
pub use visit::*;
