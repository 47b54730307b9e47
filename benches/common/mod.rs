//! What the benchmarks share: fleets to measure, the machine they run on, what a process uses of it, and how results are shown.
//!
//! Each benchmark is a program of its own and uses a part of this.

pub(crate) mod child;
pub(crate) mod composite;
pub(crate) mod deploy;
mod machine;
mod page;
mod process;

pub(crate) use machine::{Busy, description};
pub(crate) use page::{median, verdict, write};
pub(crate) use process::{Memory, cpu_time, memory};

/// What a benchmark returns: any failure ends it with its text.
pub(crate) type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Where results are written, relative to the root of the repository, which is where Cargo starts a benchmark.
pub(crate) const RESULTS: &str = "target/bench";
