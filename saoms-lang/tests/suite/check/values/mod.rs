//! Properties and their values: written, given on, from files and from outside.

mod environment;
pub(crate) mod files;
mod findings;
mod given_on;
mod parameters;
mod paths;
pub(crate) mod properties;
