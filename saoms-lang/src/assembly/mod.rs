//! Assemblies: resolved composites, with components, their classes, values and wires.
//!
//! The checker makes an [`Assembly`], and only from input without errors; the plan and the scheduler take it as given.

mod component_places;
mod fault_subjects;
mod fleet_view;
mod placement;
mod run_policy;
mod task;
pub(crate) mod topic_list;
pub(crate) mod topic_rename;
mod traffic;
mod web;

use std::borrow::Cow;
use std::sync::Arc;
use std::time::Duration;

use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

pub use component_places::ComponentPlaces;
pub(crate) use component_places::OF_NETWORKS;
pub use fault_subjects::fault_subjects;
pub(crate) use fleet_view::class_view;
pub use fleet_view::seen;
pub use run_policy::{AlertCommand, AlertUrl, RunPolicy};
pub use task::{Loss, OF_RESTART, Overrun, Restart, TaskProperties};
pub use topic_list::TopicList;
pub use topic_rename::TopicRenames;
pub use traffic::{Pace, TopicEnd, Traffic, TrafficTopic};
pub use web::{CALL_DEADLINE, WebService, WebTarget};

use crate::registry::{ClassTopic, RegisteredClass, RegisteredLoop};

/// The components of a fleet in document order.
#[derive(Clone, Debug, Default)]
pub struct Assembly {
    /// Every component; its place here is its index.
    pub components: Vec<ComponentSpec>,
    /// The components that run in other programs; see [`Assembly::at`].
    pub elsewhere: Vec<ComponentSpec>,
    /// The node that this is the part of; empty for a whole fleet.
    pub node: SmolStr,
    /// What the outermost composites say of the run.
    pub run: RunPolicy,
    /// Where components and their settings of networks are written.
    pub places: ComponentPlaces,
}

/// One component, resolved.
#[derive(Clone, Debug)]
pub struct ComponentSpec {
    /// The identity: the path in the composite, such as `Robot001` or `hall/Robot001`.
    pub path: String,
    /// The site, with those around it, as `North` or `Plant/North`; empty outside all sites.
    pub site: SmolStr,
    /// The node that runs it; empty in a fleet without nodes.
    pub node: SmolStr,
    /// The node by which faults name it: the one above, or, in a fleet without nodes that several composites on a
    /// network make, the name of the file of its own one; otherwise empty.
    pub fault_node: SmolStr,
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
    /// Its services that are offered over the web.
    pub web: Box<[WebService]>,
}

impl ComponentSpec {
    /// The topics that its class and its loops publish, as they declare them.
    pub fn publishes(&self) -> impl Iterator<Item = &ClassTopic> {
        let of_loops = self.loops.iter().flat_map(|one| &one.class.declaration().publishes);
        self.class.declaration().publishes.iter().chain(of_loops)
    }

    /// The topics that its class and its loops read, as they declare them.
    pub fn subscribes(&self) -> impl Iterator<Item = &ClassTopic> {
        let of_loops = self.loops.iter().flat_map(|one| &one.class.declaration().subscribes);
        self.class.declaration().subscribes.iter().chain(of_loops)
    }

    /// The name on the bus of a topic that the class, or one of its loops, declares under this name: that of
    /// `topicRename`, inside the site. A new name that begins with `/` is outside all sites.
    pub fn topic<'a>(&'a self, declared: &'a str) -> Cow<'a, str> {
        let renames = self.task.as_ref().map(|task| &task.topic_rename);
        on_bus(&self.site, renames.map_or(declared, |renames| renames.name(declared)))
    }
}

/// The name on the bus of a topic that is called so in a site.
pub(crate) fn on_bus<'a>(site: &str, name: &'a str) -> Cow<'a, str> {
    match name.strip_prefix('/') {
        Some(outside) => outside.into(),
        None if site.is_empty() => name.into(),
        None => format!("{site}/{name}").into(),
    }
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
    /// Those of them that are in other programs, which follow them; see [`Assembly::at`].
    pub elsewhere: Box<[RemoteTarget]>,
    /// The services of the web that it leads to, which follow those of other programs.
    pub web: Box<[WebTarget]>,
    /// The time within which a call of those in other programs or of the web is answered, where the composite gives it.
    pub deadline: Option<Duration>,
}

impl Wire {
    /// The number of services that it leads to, wherever they are.
    pub fn ends(&self) -> usize {
        self.targets.len() + self.elsewhere.len() + self.web.len()
    }
}

/// A service of a component of another program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RemoteTarget {
    /// The provider: its path.
    pub component: String,
    /// The node that runs it.
    pub node: SmolStr,
    /// The service's name.
    pub service: String,
    /// True if it registers functions that stop hardware.
    pub stops: bool,
}

/// A service of a component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WireTarget {
    /// The provider's index in the assembly.
    pub component: usize,
    /// The service's name.
    pub service: String,
}
