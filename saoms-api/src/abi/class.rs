use std::ffi::c_void;

use crate::{Class, Properties};

use super::component::Instance;
use super::guard::guarded_construct;
use super::{
    Bytes, ComponentTable, FindingSink, LoopClassTable, PropertyView, RuleTable, Sink, Status, VERSION,
};

/// Makes a component or a loop from the values that the composite gives, which it may refuse with findings. The checker makes components that
/// never run, so it does no work, opens nothing and sends nothing.
pub type Construct = unsafe extern "C" fn(
    values: *const PropertyView,
    value_count: usize,
    made: *mut *mut c_void,
    findings: FindingSink,
    error: Sink,
) -> Status;

/// A class: how to make components of it, and their functions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ClassTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// Makes a component of it.
    pub construct: Construct,
    /// The functions of its components.
    pub component: *const ComponentTable,
}

impl ClassTable {
    /// The table of a class.
    pub const fn of<C: Class>() -> ClassTable {
        ClassTable {
            size: size_of::<ClassTable>(),
            construct: construct::<C>,
            component: &Instance::<C>::TABLE,
        }
    }
}

// SAFETY: what the pointer leads to is constant.
unsafe impl Sync for ClassTable {}

unsafe extern "C" fn construct<C: Class>(
    values: *const PropertyView,
    count: usize,
    instance: *mut *mut c_void,
    findings: FindingSink,
    error: Sink,
) -> Status {
    let make = || {
        // SAFETY: the host lends the values to this call.
        let values = unsafe { PropertyView::read(values, count) }?;
        Ok(Instance::into_pointer(C::new(C::Properties::from_values(&values)?)?))
    };
    // SAFETY: the host waits for the call with its sinks, and has a place for the pointer.
    unsafe { guarded_construct(findings, error, make, instance) }
}

/// What a library offers, each list in the order of its metadata.
#[repr(C)]
#[derive(Debug)]
pub struct PluginTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// The version of the boundary that the library was built with.
    pub version: u32,
    /// The metadata, as it also lies in its own section of the library.
    pub metadata: Bytes,
    /// The classes.
    pub classes: *const *const ClassTable,
    /// How many there are.
    pub class_count: usize,
    /// The loops.
    pub loops: *const *const LoopClassTable,
    /// How many there are.
    pub loop_count: usize,
    /// The rules over whole fleets.
    pub rules: *const *const RuleTable,
    /// How many there are.
    pub rule_count: usize,
}

// SAFETY: what the pointers lead to is constant.
unsafe impl Sync for PluginTable {}

impl PluginTable {
    /// For [`plugin!`](crate::plugin).
    #[doc(hidden)]
    pub const fn new(
        metadata: &'static [u8],
        classes: &'static [&'static ClassTable],
        loops: &'static [&'static LoopClassTable],
        rules: &'static [&'static RuleTable],
    ) -> PluginTable {
        PluginTable {
            size: size_of::<PluginTable>(),
            version: VERSION,
            metadata: Bytes::lend(metadata),
            classes: classes.as_ptr().cast(),
            class_count: classes.len(),
            loops: loops.as_ptr().cast(),
            loop_count: loops.len(),
            rules: rules.as_ptr().cast(),
            rule_count: rules.len(),
        }
    }
}
