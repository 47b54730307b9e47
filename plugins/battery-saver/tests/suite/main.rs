//! The loop in a fleet, with the plugin's code linked in, and alone.

#![expect(clippy::unwrap_used, reason = "helpers of tests, outside test functions")]

mod fleet;
mod saver;
