//! Rules that stand alone: each looks at a fleet whose parts are resolved, and none asks what another one found.

pub(crate) mod bindings;
pub(crate) mod component_types;
pub(crate) mod constructors;
pub(crate) mod contracts;
pub(crate) mod interface;
pub(crate) mod multiplicity;
pub(crate) mod plugin_rules;
pub(crate) mod repeated_names;
pub(crate) mod traffic;
pub(crate) mod unique_values;
pub(crate) mod wired_by_implementation;
pub(crate) mod written;
