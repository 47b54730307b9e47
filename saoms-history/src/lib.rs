//! The history of fleets: a database of SQLite with their runs, what components saw, decided and did, alerts, reports,
//! and the tables of crates of components. `docs/history.md` has its tables.
//!
//! [`History`] is the observer that writes it while a fleet runs; [`Questions`] reads it. Both may use one file at the
//! same time, as may other programs that know SQLite: the journal of the database is a write-ahead log (WAL).

mod error;
mod history;
mod questions;
mod retention;
mod tables;
#[cfg(test)]
mod tests;
mod writer;

pub use error::HistoryError;
pub use history::{History, HistoryRun};
pub use questions::{Answer, Questions};
pub use tables::{ColumnDoc, TableDoc, table_docs};
