//! Diagnostics for machines: JSON, and SARIF for code scanning.

mod json;
mod sarif;
#[cfg(test)]
mod tests;

pub use json::json;
pub use sarif::{Sarif, sarif};
