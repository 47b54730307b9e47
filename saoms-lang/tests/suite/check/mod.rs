//! Diagnostics of the checker, and assemblies of composites without faults.

mod assemblies;
mod classes;
mod component_types;
mod corpus;
mod escapes;
mod events;
mod loop_classes;
mod loops;
mod mistakes;
mod mutations;
mod names;
mod namespaces;
mod placement;
mod policies;
mod report;
mod run_settings;
mod support;
mod tasks;
mod unfolding;
mod values;
mod web;
mod wiring;
mod written;
