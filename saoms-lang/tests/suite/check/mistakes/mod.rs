//! Mistakes that people make: each is reported once, at its place, with what to write.

mod hidden;
mod meant;
mod once;
pub(crate) mod slips;
mod together;
