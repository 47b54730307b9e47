use core::ffi::c_void;

use crate::{Bytes, FindingSink, PropertyView, Sink, Status};

/// A rule over whole fleets: finds faults that no component can see alone.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RuleTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// The first argument of `check`.
    pub state: *const c_void,
    /// Puts what it finds in a fleet.
    pub check: unsafe extern "C" fn(
        state: *const c_void,
        fleet: *const FleetList,
        findings: FindingSink,
        error: Sink,
    ) -> Status,
}

// SAFETY: what the pointer leads to is constant.
unsafe impl Sync for RuleTable {}

/// The components of a fleet.
#[repr(C)]
#[derive(Debug)]
pub struct FleetList {
    /// The components in document order; the place of one here is its index.
    pub components: *const MemberView,
    /// Their number.
    pub component_count: usize,
    /// The components that are left out for a fault of their own: the declarations of the class of each and of those
    /// that this extends; none where the class is not known.
    pub missing: *const TextList,
    /// Their number.
    pub missing_count: usize,
}

/// A list of texts.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TextList {
    /// The first.
    pub texts: *const Bytes,
    /// Their number.
    pub count: usize,
}

/// A component of a fleet.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct MemberView {
    /// Its path in the composite.
    pub path: Bytes,
    /// The name of its class, as declared.
    pub class_name: Bytes,
    /// The declaration of its class.
    pub declaration: Bytes,
    /// The declarations of the classes that its class extends, the nearest first.
    pub extends: TextList,
    /// The values of the class's own properties, presets included; an absent one takes its default.
    pub values: *const PropertyView,
    /// Their number.
    pub value_count: usize,
    /// From one execution to the next, in nanoseconds; `UINT64_MAX`: it is not periodic.
    pub period: u64,
    /// 1 if its messages go to a broker, where others may be that this fleet does not know; otherwise 0.
    pub has_broker: u32,
    /// The topics that it publishes, by their names before any `topicRename`.
    pub publishes: TextList,
    /// The classes of its loops, in their order.
    pub loops: TextList,
    /// Its references that are wired.
    pub wires: *const WireView,
    /// Their number.
    pub wire_count: usize,
    /// The topics that have another name on the bus than in the declaration of its class.
    pub renamed: *const RenamedView,
    /// Their number.
    pub renamed_count: usize,
    /// 1 if it starts with the fleet; 0 if it waits until another component schedules it.
    pub starts: u32,
}

/// A topic of a component with another name on the bus.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RenamedView {
    /// Its name in the declaration.
    pub declared: Bytes,
    /// Its name on the bus.
    pub on_bus: Bytes,
}

/// A reference of a component that is wired.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct WireView {
    /// Its name.
    pub reference: Bytes,
    /// The index of the component that it leads to.
    pub target: usize,
}
