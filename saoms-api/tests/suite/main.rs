//! The contract: what the macros make, the boundary to plugins, and its header.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

mod components;
mod declarations;
mod header;
mod layout;
mod refused;
