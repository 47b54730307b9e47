//! What the benchmarks share: the machine they ran on, and what a process used of it.

mod machine;
mod process;

pub(crate) use machine::{Busy, description};
pub(crate) use process::{Memory, cpu_time, memory};

/// What a benchmark returns: any failure ends it with its text.
pub(crate) type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Where results are written, relative to the root of the repository, which is where Cargo starts a benchmark.
pub(crate) const RESULTS: &str = "target/bench";
