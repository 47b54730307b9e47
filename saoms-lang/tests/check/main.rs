//! What the checker finds in composites, and what it makes of those without faults.

#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests, outside test functions")]

mod assemblies;
mod classes;
mod component_types;
mod conditions;
mod corpus;
mod environment;
mod escapes;
mod expanded;
mod files;
mod findings;
mod fleets;
mod given_on;
mod loop_classes;
mod loops;
mod meant;
mod mutations;
mod names;
mod nested;
mod parameters;
mod policies;
mod promotions;
mod properties;
mod reference;
mod rules;
mod several;
mod severities;
mod slips;
mod slips_of_wires;
mod support;
mod tasks;
mod together;
mod topics;
mod wires;
mod wiring;
mod written;
