//! The machine of SAOMS: model, load, check, assemble, bus and schedule.

pub mod assemble;
pub mod assembly;
pub mod bus;
pub mod check;
pub mod diagnostic;
pub mod expression;
pub mod format;
pub mod graph;
mod hash;
pub mod journal;
pub mod load;
pub mod model;
pub mod plugin;
pub mod registry;
pub mod report;
pub mod schedule;
pub mod schema;
pub mod source;
pub mod xml;
pub mod xsd;
