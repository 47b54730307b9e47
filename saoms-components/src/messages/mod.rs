//! Messages and topics of the fleet. Each message stands in the file of its subject, with its topic, which says who
//! publishes and reads it, and with its validation.

mod environment;
mod movement;
mod team;

pub use environment::*;
pub use movement::*;
pub use team::*;
