//! The command as a user meets it.

mod contributions;
mod ending;
mod events;
mod explain;
mod fmt;
mod graph;
mod goes_on;
mod history;
mod log;
mod memory;
mod memory_full;
mod new;
mod operation;
mod options;
mod outcomes;
mod outputs;
mod paths;
mod planted;
mod report;
mod schema;
mod service;
mod simulate;
mod state;
mod trust;
mod usage;
mod why;
