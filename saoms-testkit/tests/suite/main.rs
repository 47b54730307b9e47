//! Tests of the testkit on runs and components.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

mod busy;
mod comply;
mod events;
mod faults;
mod loops;
mod planted;
mod problem;
mod records;
mod run;
mod start;
