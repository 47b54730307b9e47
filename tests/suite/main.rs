//! Tests that cross crates, most of them with the real command.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

mod boundary;
mod check;
mod command;
mod control;
mod fleets;
mod lsp;
mod network;
mod peers;
mod plugins;
mod project;
mod scenarios;
mod support;
