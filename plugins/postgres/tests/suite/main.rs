//! Histories brought to a PostgreSQL server of Debian, by the program itself. Without one, the tests are skipped with a
//! word; `SAOMS_PEERS=required`, which `.ci/run` sets, makes them fail then.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

mod broken;
mod copies;
mod encrypted;
mod following;
mod history;
mod server;
mod wrong;
