//! The form in which the memory of a fleet stands in its state folder. Names of entries have line breaks, which paths
//! of components have not.

use saoms_api::Message;

/// The run: one entry; and something more while an operator pauses it.
pub(super) const RUN: &str = "(run)\n";
pub(super) const PRESENT: u64 = 0;
pub(super) const PAUSED: u64 = 1;
/// A component, by its path: what it saved, what the engine knows of it, the time of its first execution as long as
/// that is to come, and something more of one that has failed for good.
pub(super) const COMPONENT: &str = "(component)\n";
pub(super) const SAVED: u64 = 0;
pub(super) const KNOWN: u64 = 1;
pub(super) const DELAYED: u64 = 2;
pub(super) const FAILED: u64 = 3;
/// The types of what components saved, by their hashes.
pub(super) const SCHEMAS: &str = "(schemas)\n";
/// What a state topic retains of a publisher, by the topic and the path of the publisher; the keys are those of the
/// messages.
pub(super) const STATES: &str = "(states)\n";
/// What waits: events for their readers, and what comes from outside at a later time.
pub(super) const WAITING: &str = "(waiting)\n";
pub(super) const EVENTS: u64 = 0;
pub(super) const INPUTS: u64 = 1;
/// What components contribute to the report, by the hashes of the paths.
pub(super) const REPORT: &str = "(report)\n";
/// What was received of other programs, by the url of the network.
pub(super) const RECEIVED: &str = "(received)\n";
/// The paths of all components that there ever were, by their numbers, which messages and saved states name; those of
/// this program, and those of others.
pub(super) const NAMES: &str = "(names)\n";
pub(super) const NAMES_ELSEWHERE: &str = "(names elsewhere)\n";
/// What the program beside the engine has counted.
pub(super) const COUNTERS: &str = "(counters)\n";
/// What the program beside the engine has written.
pub(super) const TEXTS: &str = "(texts)\n";

/// All names that an entry of the memory may begin with.
const ALL: [&str; 11] =
    [RUN, COMPONENT, SCHEMAS, STATES, WAITING, REPORT, RECEIVED, NAMES, NAMES_ELSEWHERE, COUNTERS, TEXTS];

/// True for the name of an entry of the memory.
pub(crate) fn is_of_memory(entry: &str) -> bool {
    ALL.iter().any(|prefix| entry.starts_with(prefix))
}

/// The run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedRun")]
pub(super) struct RunForm {
    /// Time of the run, in nanoseconds.
    pub(super) time: u64,
    /// Number of the last record of the journal.
    pub(super) records: u64,
    /// Why the run ended; empty while it goes on.
    pub(super) end: String,
}

/// What a component saved, without the type.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedState")]
pub(super) struct StateForm {
    /// The hash of the type.
    pub(super) schema: u64,
    pub(super) message: Vec<u8>,
}

/// The same as [`Saved`](saoms_api::Saved) has it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Saved")]
pub(super) struct SavedForm {
    pub(super) schema: String,
    pub(super) message: Vec<u8>,
}

/// What the engine knows of a component.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedComponent")]
pub(super) struct ComponentForm {
    pub(super) class: String,
    pub(super) site: String,
    /// True if it is scheduled, and until when.
    pub(super) is_scheduled: bool,
    pub(super) until: u64,
    /// Its period and its phase in it.
    pub(super) period: u64,
    pub(super) phase: u64,
    /// True if it is stopped in an emergency.
    pub(super) is_stopped: bool,
    /// True if it has voted, whether it sees work left, and whether it gave up some.
    pub(super) has_voted: bool,
    pub(super) sees_work: bool,
    pub(super) gave_up: bool,
    /// Number of instances so far.
    pub(super) instances: u64,
    /// The values that operators have set.
    pub(super) set: Vec<SetForm>,
    /// The alerts that it has raised.
    pub(super) alerts: Vec<AlertForm>,
}

/// A value that an operator has set.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedValue")]
pub(crate) struct SetForm {
    pub(crate) property: String,
    pub(crate) value: String,
    /// The hash of the value of the composite: if that is another one, the composite was changed since.
    pub(crate) instead_of: u64,
}

/// An alert that is not over.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedAlert")]
pub(crate) struct AlertForm {
    pub(crate) kind: String,
    pub(crate) subject: String,
    pub(crate) text: String,
}

/// A message of a topic.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedMessage")]
pub(super) struct MessageForm {
    /// The path of the component that sent it.
    pub(super) sender: String,
    /// The path of the only component that receives it; empty: all readers.
    pub(super) to: String,
    pub(super) sent: u64,
    pub(super) cause: u64,
    pub(super) bytes: Vec<u8>,
}

/// The events that wait for readers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedEvents")]
pub(super) struct EventsForm {
    pub(super) messages: Vec<MessageForm>,
    pub(super) unread: Vec<UnreadForm>,
    /// What was sent, and waits for its commit.
    pub(super) held: Vec<HeldForm>,
}

/// The events of a topic that wait for a component.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedUnread")]
pub(super) struct UnreadForm {
    pub(super) component: String,
    pub(super) topic: String,
    /// Places among the messages.
    pub(super) messages: Vec<u32>,
}

/// A message that waits for its commit.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedHeld")]
pub(super) struct HeldForm {
    pub(super) component: String,
    pub(super) topic: String,
    /// Place among the messages.
    pub(super) message: u32,
}

/// What comes from outside and waits.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedInputs")]
pub(crate) struct InputsForm {
    pub(crate) inputs: Vec<InputForm>,
}

/// A message, event or order from outside that waits for its time.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedInput")]
pub(crate) struct InputForm {
    pub(crate) at: u64,
    /// Its line; of an order, the order itself.
    pub(crate) text: String,
    pub(crate) is_order: bool,
    /// True if it is an event, which may have several messages.
    pub(crate) is_event: bool,
    pub(crate) messages: Vec<InputMessage>,
}

/// A message of one of these.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedInputMessage")]
pub(crate) struct InputMessage {
    pub(crate) topic: String,
    /// The path of the only component that receives it; empty: all readers.
    pub(crate) to: String,
    pub(crate) bytes: Vec<u8>,
}

/// How far the events of another program on a topic were received.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedReceipt")]
pub(super) struct ReceivedForm {
    pub(super) topic: String,
    /// The first start of the program.
    pub(super) origin: u64,
    /// The number of the first event that was not.
    pub(super) next: u64,
}

/// A part of the report.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/RememberedPart")]
pub(super) struct PartForm {
    pub(super) path: String,
    pub(super) is_count: bool,
    /// In JSON.
    pub(super) value: String,
}
