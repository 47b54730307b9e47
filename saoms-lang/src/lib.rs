//! From the text of composites to an [`Assembly`](assembly::Assembly), or to the diagnostics that say why there is
//! none.
//!
//! Nothing here knows a clock, a thread or a network.

pub mod assembly;
pub mod check;
pub mod contribution;
pub mod diagnostic;
pub mod expression;
mod limits;
pub mod load;
pub mod model;
pub mod project;
pub mod source;
pub mod syntax;

pub use saoms_registry::{OperationSchema, event, registry, ros, schema};
