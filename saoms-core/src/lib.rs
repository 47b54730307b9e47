//! The machine of SAOMS: model, load, check, assemble, bus and schedule.

pub mod diagnostic;
pub mod model;
pub mod source;
pub mod xml;
