//! Common parts of the benchmarks: fleets to measure, the machine, the usage of a process, and the output of results.
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

/// Result of a benchmark: any error ends it with its text.
pub(crate) type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Folder of the results, relative to the root of the repository, in which Cargo starts a benchmark.
pub(crate) const RESULTS: &str = "target/bench";
