//! Classes, loops and rules of a library, called through the tables of the boundary.

mod component;
mod implementation;
mod looping;
mod rule;
mod status;

pub use component::ImportedClass;
pub(super) use implementation::Implementation;
pub use looping::ImportedLoopClass;
pub use rule::ImportedRule;
