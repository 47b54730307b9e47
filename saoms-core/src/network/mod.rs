//! Networks: how the programs of a fleet exchange messages.
//!
//! A transport is a library that carries bytes as well as it can. What a fleet rests on is made here, above it, so that
//! it is the same over each transport: [`exchange`] numbers what is sent, finds out what is missing, asks for it again,
//! and knows which programs are there.

mod client;
pub mod control;
pub mod exchange;
mod fleet;
pub mod key;
mod port;
pub mod rights;
mod ticket;
mod told;
mod topics;
pub mod transport;

/// The component that messages come from which no component of the fleet sends. A program adds its number.
pub(crate) const FROM_OUTSIDE: &str = "(outside)";
/// The kind of alerts of links.
const LINK: &str = "link";

pub use client::{Client, Entered, Entrance, Entry, Refused};
pub use fleet::{Fleet, Membership, Undelivered};
pub(crate) use port::FromRun;
pub use port::Port;
pub(crate) use ticket::Ticket;
pub use topics::{TopicFleet, TopicMembership};
