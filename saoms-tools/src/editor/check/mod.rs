//! Checks for editors: which fleets the open files belong to, what is wrong in each, and how it is mended.

mod checker;
mod classes;
mod diagnostic;
mod fixes;
mod fleets;
#[cfg(test)]
mod tests;

pub use checker::{CheckOptions, CheckUpdate, Checker};
pub use classes::{ClassCache, PluginSearch};
pub use diagnostic::{EditorDiagnostic, Fix, RangeEdit, RelatedPlace};
pub use fixes::{FixAction, fix_all, fixes, touching};
