//! The contract: what the macros make, the boundary to plugins, and the helpers for C.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

mod author;
mod components;
mod declarations;
mod faults;
mod refused;
mod view;
