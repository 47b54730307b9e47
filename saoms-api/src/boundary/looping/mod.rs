//! Loops across the boundary, in both directions: a component of a library can have loops of the program.

mod exported;
mod imported;

pub(super) use exported::export_loop;
pub use exported::loop_class_table;
pub use imported::import_loop;
