use saoms_api::host::SharedMessage;
use saoms_api::{Cause, Departed, Field, Header, Message, Time};

/// One call of a component's code: what the component got in it, and what it did.
#[derive(Clone, Debug, PartialEq, Message)]
#[message(name = "saoms_msgs/msg/Step")]
pub struct Step {
    /// Its number among the steps of its component, from 0. One that is missing was lost.
    pub number: u64,
    /// What was called.
    pub kind: StepKind,
    /// When it began, in nanoseconds of the run.
    pub time: u64,
    /// When it was due.
    pub due: u64,
    /// The number of the execution of its instance, from 0.
    pub execution: u64,
    /// The record of the journal because of which somebody called it; 0 is none.
    pub cause: u64,
    /// The messages that it could read, by subscription, the oldest first.
    pub heard: Vec<Heard>,
    /// What else it got and what it did, in order.
    pub acts: Vec<Act>,
    /// Why it failed, if it did.
    pub failure: Option<String>,
}

/// What is called in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
pub enum StepKind {
    /// It is constructed and initialized, and goes on from a state where one was saved.
    Start,
    /// An execution.
    Execute,
    /// A reaction to messages.
    React,
    /// A call of one of its services.
    Serve,
    /// It takes new values of properties.
    Update,
    /// It shuts down.
    Shutdown,
    /// Nothing: a change of the fleet put an instance in its place whose start is not on the tape.
    Replaced,
}

/// A message that a component could read, or one that left the region of its subscription.
#[derive(Clone, Debug, PartialEq, Field)]
pub struct Heard {
    /// The number of the subscription.
    pub subscription: u32,
    /// The sender's index in the fleet.
    pub sender: u32,
    /// When it was sent, in nanoseconds of the run.
    pub sent: u64,
    /// The record of the journal with its reason; 0 is none.
    pub cause: u64,
    /// Its key.
    pub key: Option<u64>,
    /// True if it left the region: then it has no bytes.
    pub has_left: bool,
    /// The message.
    pub bytes: Vec<u8>,
}

/// Something that a component got or did in a step. What `number`, `other`, `name` and `bytes` are, its kind says.
#[derive(Clone, Debug, PartialEq, Field)]
pub struct Act {
    /// The kind.
    pub what: ActKind,
    /// A number.
    pub number: u64,
    /// Another number.
    pub other: u64,
    /// A name.
    pub name: String,
    /// A text or bytes.
    pub bytes: Vec<u8>,
}

/// Kinds of acts: first what a component gets, then what it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Field)]
pub enum ActKind {
    /// The class and the index of the component.
    Class,
    /// The values of its properties.
    Values,
    /// A loop, by its name: class and values.
    Loop,
    /// Bytes that it kept before it began, by their number.
    Kept,
    /// The state that it goes on from.
    Restored,
    /// The service that is called, with the number of the operation and the arguments.
    Service,
    /// This execution fails by fault injection: its code does not run.
    Fault,
    /// Its source of chance, before it draws.
    Chance,
    /// The answer to its call before: 0 and the reply, or the number of an error with its texts.
    Answer,
    /// The host refused what it did before.
    Refused,
    /// The time now, at the reading of this number in the step.
    Now,
    /// The date, at the reading of this number; no bytes where there is none.
    Date,
    /// Whether it should end early, at the question of this number.
    Cancelled,
    /// Its period.
    Period,
    /// The name of a sender.
    NameOf,
    /// It became a publisher of the topic of this name, under a number; the bytes are the schema.
    Publisher,
    /// The same of a subscription.
    Subscription,
    /// The handle of a reference of this name; the bytes are the interface.
    Reference,
    /// Whether a reference leads somewhere.
    IsWired,
    /// The number of targets of a reference.
    Targets,
    /// The publishers of a topic.
    Publishers,
    /// Who speaks with a number in messages of a topic.
    Speaker,
    /// Whether somebody wants lines of a level.
    Listens,
    /// Whether it goes on from a saved state: 0, 1, or 2 if that is of an earlier program.
    GoesOn,
    /// Whether what it kept is of an earlier program.
    KeptByEarlier,
    /// What others kept.
    KeptByOthers,
    /// It wrote a symptom to the journal, with the number of the record and its digest; the name is that of the loop.
    Symptom,
    /// The same of a decision.
    Decision,
    /// The same of an effect.
    Effect,
    /// The same of a change of its knowledge.
    Changed,
    /// It sent a message on a topic, with the key and the cause.
    Sent,
    /// It called through a reference, with the handle, the operation and the arguments.
    Called,
    /// It answered a call, as an answer.
    Replied,
    /// It let an event happen.
    Raised,
    /// It kept bytes under a number.
    Keeps,
    /// It set the region of a subscription.
    Region,
    /// It raised an alert of a kind, or ended it.
    Alert,
    /// It set a value of the report.
    Reported,
    /// It added to a number of the report.
    Counted,
    /// It voted on the end of the run.
    Voted,
}

impl ActKind {
    /// True if it is something that a component does.
    pub fn is_deed(self) -> bool {
        self >= ActKind::Symptom
    }

    /// True if it is a record of the journal.
    pub fn is_record(self) -> bool {
        matches!(self, ActKind::Symptom | ActKind::Decision | ActKind::Effect | ActKind::Changed)
    }
}

impl Act {
    /// An act without bytes.
    pub fn new(what: ActKind, number: u64, name: &str) -> Act {
        Act { what, number, other: 0, name: name.to_owned(), bytes: Vec::new() }
    }

    /// The same with another number.
    #[must_use]
    pub fn other(self, other: u64) -> Act {
        Act { other, ..self }
    }

    /// The same with bytes.
    #[must_use]
    pub fn with(self, bytes: impl Into<Vec<u8>>) -> Act {
        Act { bytes: bytes.into(), ..self }
    }

    /// Its bytes as text.
    pub fn text(&self) -> std::borrow::Cow<'_, str> {
        String::from_utf8_lossy(&self.bytes)
    }
}

impl Heard {
    /// A message.
    pub(crate) fn of(subscription: u32, message: &SharedMessage) -> Heard {
        let Header { sender, sent, cause } = message.header();
        let (sent, cause, key) = (sent.as_nanos(), cause.0, message.key());
        Heard { subscription, sender, sent, cause, key, has_left: false, bytes: message.bytes().to_vec() }
    }

    /// A message that left the region of a subscription.
    pub(crate) fn left(subscription: u32, departed: &Departed) -> Heard {
        let Departed { sender, key } = *departed;
        let (sent, cause, bytes) = (0, 0, Vec::new());
        Heard { subscription, sender, sent, cause, key: Some(key), has_left: true, bytes }
    }

    /// The message again.
    pub(crate) fn message(&self) -> SharedMessage {
        let header = Header { sender: self.sender, sent: Time::from_nanos(self.sent), cause: Cause(self.cause) };
        SharedMessage::from_bytes(header, self.key, self.bytes.clone())
    }
}

impl Step {
    /// Its size in memory, without much effort.
    pub(crate) fn size(&self) -> usize {
        let heard: usize = self.heard.iter().map(|one| size_of::<Heard>() + one.bytes.len()).sum();
        let acts: usize = self.acts.iter().map(|one| size_of::<Act>() + one.name.len() + one.bytes.len()).sum();
        size_of::<Step>() + heard + acts
    }

    /// The first act of a kind.
    pub fn act(&self, what: ActKind) -> Option<&Act> {
        self.acts.iter().find(|act| act.what == what)
    }
}
