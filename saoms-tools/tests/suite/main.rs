//! The formatter and the pictures over real files.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

#[path = "../../../saoms-lang/tests/suite/load/collection.rs"]
mod collection;
#[path = "../../../saoms-lang/tests/suite/load/files.rs"]
mod files;
mod format;
mod graph;
