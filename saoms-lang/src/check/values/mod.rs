//! Values as composites give them: where they come from, which parts paths lead to, and the types of XML Schema.

pub(crate) mod global_element;

pub(crate) mod parameters;
pub(crate) mod path;
pub(crate) mod path_index;
pub(crate) mod raw;
pub(crate) mod shared_values;
pub(crate) mod simple_type;
pub(crate) mod type_match;
pub(crate) mod type_name;
pub(crate) mod value_type;
