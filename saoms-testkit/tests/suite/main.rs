//! What the testkit says of runs and of components.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

mod comply;
mod run;
