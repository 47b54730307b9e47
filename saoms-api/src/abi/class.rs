use std::ffi::c_void;

use crate::{Class, Properties};

use super::component::Instance;
use super::guard::guarded;
use super::{Bytes, ComponentTable, LoopClassTable, PropertyView, Sink, Status, VERSION};

/// A class: how to make components of it, and their functions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ClassTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// Makes a component from the values that the composite gives: a list and its length, where the component goes, where an error goes.
    pub construct: unsafe extern "C" fn(*const PropertyView, usize, *mut *mut c_void, Sink) -> Status,
    /// The functions of its components.
    pub component: ComponentTable,
}

impl ClassTable {
    /// The table of a class.
    pub const fn of<C: Class>() -> ClassTable {
        ClassTable {
            size: size_of::<ClassTable>(),
            construct: construct::<C>,
            component: Instance::<C>::TABLE,
        }
    }
}

unsafe extern "C" fn construct<C: Class>(
    values: *const PropertyView,
    count: usize,
    instance: *mut *mut c_void,
    error: Sink,
) -> Status {
    // SAFETY: the host lends the values to this call, and a place for the pointer.
    unsafe {
        guarded(error, || {
            let values = PropertyView::read(values, count)?;
            *instance = Instance::into_pointer(C::new(C::Properties::from_values(&values)?)?);
            Ok(())
        })
    }
}

/// What a library offers, in the order of its metadata.
#[repr(C)]
#[derive(Debug)]
pub struct PluginTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// [`VERSION`] of the library.
    pub version: u32,
    /// The metadata, as it also lies in its own section of the library.
    pub metadata: Bytes,
    /// The classes.
    pub classes: *const ClassTable,
    /// How many there are.
    pub class_count: usize,
    /// The loops.
    pub loops: *const LoopClassTable,
    /// How many there are.
    pub loop_count: usize,
}

// SAFETY: what the pointers lead to is constant.
unsafe impl Sync for PluginTable {}

impl PluginTable {
    /// For [`plugin!`](crate::plugin).
    #[doc(hidden)]
    pub const fn new(
        metadata: &'static [u8],
        classes: &'static [ClassTable],
        loops: &'static [LoopClassTable],
    ) -> PluginTable {
        PluginTable {
            size: size_of::<PluginTable>(),
            version: VERSION,
            metadata: Bytes::lend(metadata),
            classes: classes.as_ptr(),
            class_count: classes.len(),
            loops: loops.as_ptr(),
            loop_count: loops.len(),
        }
    }
}
