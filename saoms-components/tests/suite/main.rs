//! Whole fleets of the shipped components in virtual time.

#![expect(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod crash;
mod emergency;
mod host;
mod safe;
