//! The machine of SAOMS: model, load, check, assemble, bus and schedule.

pub mod assembly;
pub mod diagnostic;
pub mod load;
pub mod model;
pub mod registry;
pub mod source;
pub mod xml;
