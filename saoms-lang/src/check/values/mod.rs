//! Values as composites give them: where they come from, which parts paths lead to, and the types of XML Schema.

pub(crate) mod expression_scope;
pub(crate) mod faulty_values;
pub(crate) mod path;
pub(crate) mod raw;
pub(crate) mod replica;
pub(crate) mod shared_values;
pub(crate) mod type_name;
pub(crate) mod value_type;
