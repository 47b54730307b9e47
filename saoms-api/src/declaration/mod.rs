//! What a class says about itself, as text.
mod rule;
mod text;

pub use rule::{PropertyKind, Rule, Scalar, parse_scalar};
pub use text::{Text, text};

pub use crate::property::PropertyShape;
