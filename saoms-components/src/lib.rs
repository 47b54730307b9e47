//! The components that ship with SAOMS: robots, masters, environment, world and message broker.
//!
//! They are the airport fleet of the manual: robots that bring luggage from one block of a grid to another, decide
//! among themselves which robot goes, avoid each other, and charge in time. Everything here uses `saoms_api` alone, as
//! a plugin does. [`messages`] are what the components send to each other, [`hardware`] is the service of the robots'
//! hardware.

pub mod broker;
pub mod console;
mod dashboard;
mod drawing;
pub mod environment;
mod gone;
pub mod grid;
pub mod hardware;
mod invariants;
pub mod manual;
pub mod master;
pub mod messages;
mod paths;
mod precedence;
mod report;
pub mod robot;
mod rules;
pub mod shift;
mod state;
pub mod text;
mod validation;
pub mod world;
pub mod zone;
