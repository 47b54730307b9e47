//! What the declarations of classes, loops and messages say, for whoever has to know classes without running them.
//!
//! It is built from texts alone, which linked crates and libraries bring. What reads composites uses it, and what tests
//! a single component.

pub mod event;
mod operation;
pub mod registry;
pub mod ros;
pub mod schema;

use saoms_api::rule::Code;

pub use operation::OperationSchema;

/// Codes of diagnostics that belong to a linked crate itself: no rule over fleets may have one of them.
pub struct ReservedCodes(pub &'static [&'static Code]);

/// For crates that submit [`ReservedCodes`].
#[doc(hidden)]
pub use inventory;

inventory::collect!(ReservedCodes);
