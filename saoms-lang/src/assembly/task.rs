//! What a composite can say about every periodic component, whatever its class.

use std::sync::LazyLock;
use std::time::Duration;

use saoms_api::host::PropertyValue;
use saoms_api::{Failure, Properties, PropertyField};
use smol_str::SmolStr;

use super::{Loss, Overrun, Restart, TaskSettings};
use crate::registry::PropertyDeclaration;

/// The task properties.
///
/// The original required all but the last four; here `ID` and `period` are required and the rest have defaults.
#[derive(Clone, Debug, PartialEq, Properties)]
pub struct TaskProperties {
    /// The name of the task, for people.
    #[property(name = "ID", required_text)]
    pub id: String,
    /// From one due execution to the next; a number without a unit is in ms.
    #[property(range = "100us"..="24h")]
    pub period: Duration,
    /// From the start to the first due execution.
    #[property(default = "0ms", range = "0ms"..="24h")]
    pub delay: Duration,
    /// Whether the task is scheduled when the fleet starts, or waits for a call of its TaskInterface.
    #[property(default = true)]
    pub run_on_startup: bool,
    /// Whether unscheduling asks a running execution to end early.
    #[property(default = true)]
    pub may_interrupt_if_running: bool,
    /// Whether the task may publish and subscribe.
    #[property(name = "useJMS", default = true)]
    pub use_jms: bool,
    /// The message broker, `host:port`; without one messages stay inside the process.
    pub url: Option<String>,
    /// The account at the broker.
    pub user: Option<String>,
    /// The account's password.
    pub password: Option<String>,
    /// Topics to rename: `OLD,new::OLD2,new2`.
    pub topic_rename: Option<String>,
    /// What happens to executions that could not start before the next one was due.
    #[property(default = "skip")]
    pub overrun: Overrun,
    /// What happens after a failure.
    #[property(default = "never")]
    pub restart: RestartPolicy,
    /// The pause before the first restart; it doubles with each further one.
    #[property(default = "100ms", range = "1ms"..="1h")]
    pub restart_backoff: Duration,
    /// How many restarts there may be in a run.
    #[property(default = 5, range = 1..=1000000)]
    pub restart_limit: u32,
    /// How long after its due time an execution has to be finished.
    #[property(range = "1us"..="24h")]
    pub deadline: Option<Duration>,
    /// How many messages may wait in each queue of an event topic.
    #[property(default = 1024, range = 1..=1000000, unit = "messages")]
    pub queue: u32,
    /// What an overflow of such a queue means for the run.
    #[property(default = "fail")]
    pub loss: Loss,
}

/// What happens after a failure, as the property `restart` says it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PropertyField)]
pub enum RestartPolicy {
    /// The component stays stopped and the run fails.
    Never,
    /// A new one takes its place.
    OnFailure,
}

#[expect(
    clippy::expect_used,
    reason = "the declaration is a constant, which every test of the checker reads"
)]
static DECLARATIONS: LazyLock<Vec<PropertyDeclaration>> = LazyLock::new(|| {
    // Proof: the derive writes the text while this compiles, from the struct above, and no input reaches it; any test that checks a
    // periodic component reads it.
    serde_json::from_str(TaskProperties::DECLARATION).expect("the task properties declare themselves in JSON")
});

impl TaskProperties {
    /// The declarations of the task properties, in order.
    pub fn declarations() -> &'static [PropertyDeclaration] {
        &DECLARATIONS
    }
}

impl TaskSettings {
    /// The settings that these values of task properties make, `topic_rename` read into pairs.
    ///
    /// # Errors
    /// A value is missing or wrong.
    pub fn from_values(
        values: &[(SmolStr, PropertyValue)],
        topic_rename: Vec<(String, String)>,
    ) -> Result<Self, Failure> {
        let task = TaskProperties::from_values(values)?;
        let given = |text: Option<String>| text.filter(|text| !text.is_empty());
        Ok(Self {
            id: task.id,
            period: task.period,
            delay: task.delay,
            run_on_startup: task.run_on_startup,
            may_interrupt_if_running: task.may_interrupt_if_running,
            use_jms: task.use_jms,
            url: given(task.url),
            user: given(task.user),
            password: given(task.password),
            topic_rename,
            overrun: task.overrun,
            restart: match task.restart {
                RestartPolicy::Never => Restart::Never,
                RestartPolicy::OnFailure => {
                    Restart::OnFailure { backoff: task.restart_backoff, limit: task.restart_limit }
                }
            },
            deadline: task.deadline,
            queue: task.queue as usize,
            loss: task.loss,
        })
    }
}
