//! Task properties: settings of every periodic component, whatever its class.

use std::sync::LazyLock;
use std::time::Duration;

use saoms_api::host::{PropertyValue, WriteProperties};
use saoms_api::{Failure, Properties, PropertyField, Secret};
use smol_str::SmolStr;

use super::topic_list::TopicList;
use super::topic_rename::TopicRenames;
use crate::registry::{ClassDeclaration, PropertyDeclaration};

/// The task properties of a component: how it runs. All others take them from here.
///
/// `ID` and `period` are required, the rest have defaults.
#[derive(Clone, Debug, PartialEq, Properties, WriteProperties)]
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
    /// The account at the broker. It holds for all components of the program with this `url`.
    pub user: Option<String>,
    /// The account's password, or `$NAME` for the environment variable `NAME`.
    pub password: Option<Secret>,
    /// The path of a file with the account's password, which no other user can read: from the folder of the composite.
    pub password_file: Option<String>,
    /// The path of a file (PEM) with the certificates of those who vouch for the broker, for a `url` with `tls://`;
    /// without one, those that the world trusts.
    pub tls_ca: Option<String>,
    /// The path of the program's own certificate (PEM), where the broker asks for one.
    pub tls_certificate: Option<String>,
    /// The path of the private key of this certificate (PEM), which no other user can read.
    pub tls_key: Option<String>,
    /// Topics to rename: `OLD,new::OLD2,new2`.
    pub topic_rename: TopicRenames,
    /// What happens to executions that could not start before the next one was due.
    #[property(default = "skip")]
    pub overrun: Overrun,
    /// What happens after a failure.
    #[property(default = "never")]
    pub restart: Restart,
    /// The pause before the first restart; it doubles with each further one.
    #[property(default = "100ms", range = "1ms"..="1h")]
    pub restart_backoff: Duration,
    /// How many restarts there may be in a run.
    #[property(default = 5, range = 1..=1000000)]
    pub restart_limit: u32,
    /// How long after its due time an execution has to be finished.
    #[property(range = "1us"..="24h")]
    pub deadline: Option<Duration>,
    /// Topics whose messages the component reacts to at once, instead of in its next execution: names that its class
    /// subscribes to, separated by blanks.
    pub trigger: TopicList,
    /// The least time from one reaction to the next.
    #[property(default = "1ms", range = "1us"..="24h")]
    pub minimum: Duration,
    /// How many messages may wait in each queue of an event topic. By default 1024, or 16 for each component that uses
    /// the topic, if that is more.
    #[property(range = 1..=1000000, unit = "messages")]
    pub queue: Option<usize>,
    /// What an overflow of such a queue means for the run.
    #[property(default = "fail")]
    pub loss: Loss,
}

/// Treatment of executions that could not start before the next one was due.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PropertyField)]
pub enum Overrun {
    /// They are left out and counted as missed; the grid of due times stays.
    Skip,
    /// They follow one after the other without a pause.
    CatchUp,
    /// The component is stopped and the run fails.
    Stop,
}

/// Treatment of a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PropertyField)]
pub enum Restart {
    /// The component stays stopped and the run fails.
    Never,
    /// A new one takes its place.
    OnFailure,
}

/// Effect of an overflow of an event queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PropertyField)]
pub enum Loss {
    /// The run fails; it goes on to its end first.
    Fail,
    /// It is counted, nothing more.
    Accept,
}

/// The properties that say more about `restart`: without it they have no effect, and with it `expand` writes them.
pub const OF_RESTART: [&str; 2] = ["restartBackoff", "restartLimit"];

#[expect(clippy::expect_used, reason = "the declaration is a constant, which every test of the checker reads")]
static DECLARATIONS: LazyLock<Vec<PropertyDeclaration>> = LazyLock::new(|| {
    // Proof: the derive writes the text while this compiles, from the struct above, and no input reaches it; any test
    // that checks a periodic component reads it.
    serde_json::from_str(TaskProperties::DECLARATION).expect("the task properties declare themselves in JSON")
});

/// The same for classes that alternate with others.
static ALTERNATING: LazyLock<Vec<PropertyDeclaration>> = LazyLock::new(|| {
    let mut all = DECLARATIONS.clone();
    for delay in all.iter_mut().filter(|one| one.name == "delay") {
        delay.default = None;
        delay.doc.push_str(" By default half of the `period`.");
    }
    all
});

/// Least number of messages that may wait in a queue whose length nobody gave.
const QUEUE: usize = 1024;

/// Number of messages that may wait in such a queue for each component that uses the topic: several may answer at once.
const QUEUE_FOR_EACH: usize = 16;

impl TaskProperties {
    /// How many messages may wait in a queue whose length nobody gave, of a topic that so many components use.
    pub fn default_queue(users: usize) -> usize {
        users.saturating_mul(QUEUE_FOR_EACH).max(QUEUE)
    }

    /// The declarations of the task properties, in order.
    pub fn declarations() -> &'static [PropertyDeclaration] {
        &DECLARATIONS
    }

    /// The declarations of the task properties as they are for components of a class; none if it is passive.
    pub fn declarations_of(class: &ClassDeclaration) -> &'static [PropertyDeclaration] {
        match class {
            _ if !class.is_periodic() => &[],
            _ if class.alternates => &ALTERNATING,
            _ => &DECLARATIONS,
        }
    }

    /// The delay of a component for which the composite gives none, by its period and whether its class alternates with
    /// others.
    pub fn usual_delay(period: Duration, alternates: bool) -> Duration {
        if alternates { period / 2 } else { Duration::ZERO }
    }

    /// Reads the values that a composite gives. Those that have no effect count as not given: empty texts, and what
    /// only a restart needs. `renames` are those of `topicRename`, where somebody read that already.
    ///
    /// # Errors
    /// A value is missing or wrong.
    pub(crate) fn read(mut values: Vec<(SmolStr, PropertyValue)>, renames: TopicRenames) -> Result<Self, Failure> {
        let on_failure = Restart::OnFailure.to_value();
        let restarts = values.iter().any(|(name, value)| name == "restart" && Some(value) == on_failure.as_ref());
        values.retain(|(name, value)| {
            let is_read = !renames.0.is_empty() && name == "topicRename";
            let is_in_vain = !restarts && OF_RESTART.contains(&name.as_str());
            !is_read && !is_in_vain && value.as_text().is_none_or(|text| !text.is_empty())
        });
        let task = Self::from_values(&values)?;
        let topic_rename = if renames.0.is_empty() { task.topic_rename } else { renames };
        Ok(Self { topic_rename, ..task })
    }

    /// How many restarts there may be in a run.
    pub fn restarts(&self) -> u32 {
        match self.restart {
            Restart::Never => 0,
            Restart::OnFailure => self.restart_limit,
        }
    }
}

#[cfg(test)]
mod tests {
    use saoms_api::host::WriteProperties;

    use super::*;

    fn read(values: &[(&str, &str)]) -> String {
        let values = values.iter().map(|(name, value)| ((*name).into(), (*value).into())).collect();
        let values = TaskProperties::read(values, TopicRenames::default()).unwrap().to_values();
        format!("{values:?}")
    }

    #[test]
    fn what_has_no_effect_counts_as_not_given() {
        let task = |more: &[(&str, &str)]| read(&[&[("ID", "a"), ("period", "1000")], more].concat());
        assert_eq!(task(&[("url", ""), ("topicRename", ""), ("restartLimit", "7")]), task(&[]));
        assert_ne!(task(&[("restartLimit", "7"), ("restart", "onFailure")]), task(&[("restart", "onFailure")]));
    }
}
