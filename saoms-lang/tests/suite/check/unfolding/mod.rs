//! Replicas, conditions and composites in composites, and what becomes of them.

mod conditions;
mod expanded;
pub(crate) mod fleets;
mod nested;
mod several;
mod sites;
