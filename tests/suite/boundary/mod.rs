//! Plugins at their best and at their worst: real libraries, built once from `tests/plugins`, loaded by the real
//! command.

mod alike;
pub(crate) mod build;
mod crash;
mod hang;
mod hostile;
mod keeper;
mod misbehaving;
mod named;
mod process;
mod refused;
mod robots;
mod run;
mod tables;
mod together;
