//! One component between the engine and its own code: its body, the host of its context, and calls to others.

mod as_bytes;
pub(super) mod body;
mod call;
pub(crate) mod collection;
mod declared;
mod effects;
pub(super) mod estate;
mod host;
pub(super) mod lasting;
pub(super) mod library;
pub(super) mod part;
pub(super) mod remote;
pub(super) mod spent;
mod steps;
pub(super) mod stored;
mod taped;
mod unheard;
mod web;
