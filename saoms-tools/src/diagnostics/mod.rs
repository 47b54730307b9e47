//! Diagnostics as texts: for people, as JSON, and as SARIF for code scanning.

mod grouping;
mod human;
mod json;
mod sarif;
#[cfg(test)]
mod tests;
mod window;

pub use human::{Human, from_folder, human, human_of};
pub use json::json;
pub use sarif::{Sarif, sarif};
