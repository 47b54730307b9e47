//! The run of an [`Assembly`](saoms_lang::assembly::Assembly): plugins, the plan, the bus, the scheduler, the journal
//! and the report.

pub mod adaptation;
pub mod assemble;
pub mod bus;
pub mod fault;
mod hash;
pub mod journal;
pub mod network;
pub mod observe;
pub mod plugin;
pub mod replay;
pub mod report;
pub mod schedule;
pub mod status;
pub mod store;
pub mod tape;
pub mod web;
