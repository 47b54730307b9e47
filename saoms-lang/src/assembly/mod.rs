//! Assemblies: resolved composites, with components, their classes, values and wires.
//!
//! The checker makes an [`Assembly`], and only from input without errors; the plan and the scheduler take it as given.

mod task;
pub(crate) mod topic_rename;
mod traffic;

use std::sync::Arc;

use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

pub(crate) use task::OF_RESTART;
pub use task::{Loss, Overrun, Restart, TaskProperties};
pub use topic_rename::TopicRenames;
pub use traffic::{Pace, TopicEnd, Traffic, TrafficTopic};

use crate::registry::{RegisteredClass, RegisteredLoop};

/// The components of a fleet in document order.
#[derive(Clone, Debug, Default)]
pub struct Assembly {
    /// Every component; its place here is its index.
    pub components: Vec<ComponentSpec>,
}

/// One component, resolved.
#[derive(Clone, Debug)]
pub struct ComponentSpec {
    /// The identity: the path in the composite, such as `Robot001` or `hall/Robot001`.
    pub path: String,
    /// The class.
    pub class: Arc<RegisteredClass>,
    /// The library that a composite names for the class: a path from the folder of the first composite, or an absolute
    /// one. `None` where none is named.
    pub library: Option<String>,
    /// The values of the class's own properties, presets included; what is absent takes its default.
    pub values: Vec<(SmolStr, PropertyValue)>,
    /// The same as the composite writes them.
    pub written: Written,
    /// The task of a periodic component; `None` for a passive one.
    pub task: Option<TaskProperties>,
    /// The class's references in the order of its declaration, with the services each leads to.
    pub references: Vec<Wire>,
    /// Its loops in their order; components share those that their class gives them.
    pub loops: Arc<[LoopSpec]>,
}

/// One loop of a component, resolved.
#[derive(Clone, Debug)]
pub struct LoopSpec {
    /// The name within the component.
    pub name: String,
    /// The class.
    pub class: Arc<RegisteredLoop>,
    /// Its values; what is absent takes its default.
    pub values: Vec<(SmolStr, PropertyValue)>,
    /// The same as the composite writes them.
    pub written: Written,
}

/// Values with the texts that a composite gives; `None` where each is the usual text of its value.
pub type Written = Option<Box<[(SmolStr, PropertyValue)]>>;

/// The target of a reference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wire {
    /// The reference's name.
    pub reference: String,
    /// The name of the interface.
    pub interface: String,
    /// The services it is wired to: at most one unless its class declares it as `many`.
    pub targets: Vec<WireTarget>,
}

/// A service of a component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WireTarget {
    /// The provider's index in the assembly.
    pub component: usize,
    /// The service's name.
    pub service: String,
}
