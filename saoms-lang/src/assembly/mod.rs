//! What a composite asks for once everything in it is resolved: which components of which classes, with which values, wired how.
//!
//! The checker makes an [`Assembly`], and only from input without errors; the plan and the scheduler take it as given.

mod expanded;
mod task;
mod traffic;

use std::sync::Arc;
use std::time::Duration;

use saoms_api::PropertyField;
use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

pub use expanded::expanded;
pub use task::{RestartPolicy, TaskProperties};
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
    /// What it is an instance of.
    pub class: Arc<RegisteredClass>,
    /// The library that a composite names for the class: a path from the folder of the first composite, or an absolute one. `None` where
    /// none is named.
    pub library: Option<String>,
    /// The values of the class's own properties, presets included; what is absent takes its default.
    pub values: Vec<(SmolStr, PropertyValue)>,
    /// How a periodic component runs; `None` for a passive one.
    pub task: Option<TaskSettings>,
    /// The class's references in the order of its declaration, with the services each leads to.
    pub references: Vec<Wire>,
    /// Its loops in their order; components share those that their class gives them.
    pub loops: Arc<[LoopSpec]>,
}

/// One loop of a component, resolved.
#[derive(Clone, Debug)]
pub struct LoopSpec {
    /// What it is called within the component.
    pub name: String,
    /// What it is an instance of.
    pub class: Arc<RegisteredLoop>,
    /// Its values; what is absent takes its default.
    pub values: Vec<(SmolStr, PropertyValue)>,
}

/// Where a reference leads.
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

/// How a periodic component runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskSettings {
    /// The task's name for people, `ID` in the composite.
    pub id: String,
    /// From one due execution to the next.
    pub period: Duration,
    /// From the start to the first due execution.
    pub delay: Duration,
    /// Whether it is scheduled when the fleet starts, or waits for a call.
    pub run_on_startup: bool,
    /// Whether unscheduling asks a running execution to end early.
    pub may_interrupt_if_running: bool,
    /// Whether it may publish and subscribe.
    pub use_jms: bool,
    /// The message broker, `host:port`; `None` is inside the process.
    pub url: Option<String>,
    /// The account at the broker.
    pub user: Option<String>,
    /// Its password.
    pub password: Option<String>,
    /// Topic names to replace, as (declared name, name on the bus).
    pub topic_rename: Vec<(String, String)>,
    /// What happens to executions that could not start in time.
    pub overrun: Overrun,
    /// What happens after a failure.
    pub restart: Restart,
    /// How long after its due time an execution has to be finished.
    pub deadline: Option<Duration>,
    /// How many messages wait in each of its event queues.
    pub queue: usize,
    /// What an overflow of such a queue means for the run.
    pub loss: Loss,
}

/// What happens to executions that could not start before the next one was due.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PropertyField)]
pub enum Overrun {
    /// They are left out and counted as missed; the grid of due times stays.
    Skip,
    /// They follow one after the other without a pause.
    CatchUp,
    /// The component is stopped and the run fails.
    Stop,
}

/// What happens after a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restart {
    /// The component stays stopped and the run fails.
    Never,
    /// A new one takes its place.
    OnFailure {
        /// The pause before the first restart; it doubles with each further one.
        backoff: Duration,
        /// How many restarts there may be.
        limit: u32,
    },
}

/// What an overflow of an event queue means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PropertyField)]
pub enum Loss {
    /// The run fails; it goes on to its end first.
    Fail,
    /// It is counted, nothing more.
    Accept,
}
