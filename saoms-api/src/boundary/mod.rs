//! This crate's side of [the boundary to plugins](saoms_abi): exports of classes, loops and rules through its tables,
//! and the parts that the program needs, too, to call them. Loops cross it in both directions, so that most of it
//! serves both sides: contexts and knowledge that are lent, and those that come from the other side.

mod buffer;
mod component;
mod context_state;
mod convert;
mod entries;
mod guard;
mod host;
mod lease;
mod lease_cell;
mod looping;
mod null;
mod plugin;
mod remote_host;
mod rule;
mod service;
mod stop;

pub use component::class_table;
pub use convert::{Findings, PropertyViews};
pub use lease::{Lease, call, call_for_bytes, call_with_findings};
pub use looping::{import_loop, loop_class_table};
pub use null::null_in;
pub use plugin::API;
pub use rule::rule_table;
