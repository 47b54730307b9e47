//! The components that ship with SAOMS: robots, masters, environment, world and message broker.
//!
//! They are the airport fleet of the manual: robots that bring luggage from one block of a grid to another, decide among themselves who
//! goes, keep clear of each other, and charge in time. Everything here is written against `saoms_api` alone, as a plugin is; what the
//! components say to each other is in [`messages`], and what they ask of hardware is in [`hardware`].

pub mod broker;
pub mod console;
pub mod environment;
pub mod grid;
pub mod hardware;
mod intake;
pub mod manual;
pub mod master;
pub mod messages;
mod paths;
mod report;
pub mod robot;
mod rules;
pub mod text;
pub mod world;
