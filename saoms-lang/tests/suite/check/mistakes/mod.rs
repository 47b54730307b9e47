//! Mistakes that people make: each is reported once, at its place, with what to write.

mod meant;
pub(crate) mod slips;
mod together;
