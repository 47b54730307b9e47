//! Fault injection: faults that are put into a run on purpose, to test how a fleet handles them.
//!
//! The engine looks for them at two places only: when an execution begins, and when messages go from their sender to
//! their topic. An empty list costs one comparison there. In virtual time a run with faults is as deterministic as one
//! without.

#[cfg(test)]
mod tests;

use std::time::Duration;

use saoms_api::Time;

/// A list of faults.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// Faults of messages. Of several that apply to one message, the first counts.
    pub messages: Vec<MessageFault>,
    /// Faults of components. Of several that apply to one execution, the first counts.
    pub tasks: Vec<TaskFault>,
}

/// A fault of the messages on a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MessageFault {
    /// The topic, by the name that it has after renaming.
    pub topic: String,
    /// The first instant at which messages are affected.
    pub from: Time,
    /// The first instant at which they are not affected any more.
    pub until: Time,
    /// Kind of the fault.
    pub kind: MessageFaultKind,
}

/// Kinds of faults of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageFaultKind {
    /// They reach no reader.
    Lost,
    /// They reach their topic later by this duration.
    Late(Duration),
    /// They reach their topic twice.
    Duplicated,
}

/// A fault of one execution of a component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskFault {
    /// The path of the component.
    pub component: String,
    /// The first execution that starts at this time or later is affected.
    pub at: Time,
    /// Kind of the fault.
    pub kind: TaskFaultKind,
}

/// Kinds of faults of executions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskFaultKind {
    /// It returns an error.
    Fails,
    /// It panics.
    Panics,
    /// It takes longer by this duration: on the machine's clock, or in virtual time on that of the run. Meanwhile it is
    /// busy for callers, and its due executions are late.
    Stalls(Duration),
}

impl Faults {
    /// True if there is no fault left.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.messages.is_empty() && self.tasks.is_empty()
    }

    /// The fault of a message that is sent on this topic at this time.
    pub(crate) fn of_message(&self, topic: &str, now: Time) -> Option<MessageFaultKind> {
        let applies = |fault: &&MessageFault| fault.topic == topic && (fault.from..fault.until).contains(&now);
        self.messages.iter().find(applies).map(|fault| fault.kind)
    }

    /// The fault of an execution that starts at this time. Each comes once.
    pub(crate) fn take_of_execution(&mut self, component: &str, now: Time) -> Option<TaskFaultKind> {
        let place = self.tasks.iter().position(|fault| fault.component == component && fault.at <= now)?;
        Some(self.tasks.remove(place).kind)
    }
}
