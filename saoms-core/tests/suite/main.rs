//! Fleets of scripted components, as text in and text out: see [`fleet`] and [`actor`] for the two little languages.

#![allow(clippy::unwrap_used, clippy::panic, dead_code, reason = "tests, and helpers of tests")]

mod actor;
mod bus;
mod busy;
mod change;
mod change_hang;
mod change_leave;
mod change_plan;
mod chaos;
mod effects;
mod emergency;
mod endings;
mod events;
mod failures;
mod fault;
mod fleet;
mod goes_on;
mod hold;
mod inject;
mod journal;
mod kept;
mod memory;
mod nodes;
mod observer;
mod order;
mod orders;
mod reaction;
mod real_time;
mod regions;
mod replay;
mod sample;
mod services;
mod speakers;
mod standstill;
mod start;
mod status;
mod stop;
mod store;
mod tasks;
mod trace;
