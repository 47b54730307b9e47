//! What a program says to its exchange, and what the exchange has it do.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::MILLISECOND;
use super::call::Outcome;
use super::frame::Frame;
use super::incoming::Arrived;
use super::memory::{Memory, Remembered};
use super::wire::{Begins, Request};
use crate::bus::Cell;

/// Settings of a program on a network.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The number of this program, which no other one has: another one at each start.
    pub program: u64,
    /// When it began, in nanoseconds since 1970: of two programs with a component, the one that began later has it.
    pub began: u64,
    /// Its name for people.
    pub name: String,
    /// Time without a sign of life after which others miss it, in nanoseconds.
    pub patience: u64,
    /// Bytes of events that are kept for other programs, at most.
    pub limit: usize,
    /// Time for which a program that ends waits for those that give no sign of life and lack events of it, in
    /// nanoseconds.
    pub linger: u64,
    /// The components of this program that are on the network: their paths.
    pub components: BTreeSet<String>,
    /// The names of programs without which no work is done: those of the other nodes of the fleet.
    pub others: BTreeSet<String>,
    /// What it knows of its earlier starts, with a state folder.
    pub memory: Option<Memory>,
}

impl Settings {
    /// What the program says of itself before its components begin, and then; without these.
    pub fn begins(&self) -> Begins {
        Begins {
            program: self.program,
            name: self.name.clone(),
            patience: self.patience / MILLISECOND,
            began: self.began,
            ..Begins::default()
        }
    }
}

/// Where something is put for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// All programs that read a topic, of which this component sent a message; or those that read this cell of it.
    Topic(Arc<str>, Arc<str>, Option<Cell>),
    /// A message of a topic that this program asked for again.
    Again(u64, Arc<str>),
    /// All programs: an [`Alive`](super::wire::Alive) of this one.
    Alive(u64),
    /// The same, the last one of this program: it comes after all that was sent before, so that nothing of that is
    /// late.
    Leaves(u64),
    /// A program: an [`Again`](super::wire::Again).
    Ask(u64),
    /// A program: a [`Begins`](super::wire::Begins), with what this one runs.
    Runs(u64),
    /// A program: a [`Covered`](super::wire::Covered).
    Covered(u64),
    /// A program: a [`Look`](super::wire::Look).
    Look(u64),
    /// A program: an [`Around`](super::wire::Around) of a topic.
    Around(u64, Arc<str>),
    /// A program: a [`Request`].
    Call(u64),
    /// A program: a [`Reply`](super::wire::Reply).
    Reply(u64),
}

/// Messages of a topic that a program asks the network for.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Keys {
    /// All.
    All(Arc<str>),
    /// Those that are under the key of no cell.
    Elsewhere(Arc<str>),
    /// Those of a cell.
    Cell(Arc<str>, Cell),
    /// Those that this program asked for again.
    Again(Arc<str>),
    /// Answers to what it asked of cells.
    Around(Arc<str>),
}

impl Keys {
    /// The topic.
    pub fn topic(&self) -> &Arc<str> {
        match self {
            Keys::All(topic) | Keys::Elsewhere(topic) | Keys::Cell(topic, _) => topic,
            Keys::Again(topic) | Keys::Around(topic) => topic,
        }
    }
}

/// What the program has to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Action {
    /// Ask the network for messages.
    Subscribe(Keys),
    /// Ask for them no more.
    Unsubscribe(Keys),
    /// Put something on the network that the program says.
    Put {
        /// For whom.
        to: Destination,
        /// What it says.
        bytes: Arc<[u8]>,
    },
    /// Put messages of a component on the network.
    Send {
        /// For whom.
        to: Destination,
        /// The messages.
        frame: Frame,
    },
    /// Deliver a message to the readers of its topic.
    Deliver {
        /// The program that sent it.
        program: u64,
        /// The topic.
        topic: Arc<str>,
        /// The message.
        arrived: Arrived,
    },
    /// Serve a call, or a heartbeat, of another program. A call is answered by
    /// [`Exchange::reply`](super::Exchange::reply).
    Serve(Request),
    /// Give a call of this program its outcome.
    Answered {
        /// Its line.
        line: u64,
        /// Its number on this line.
        number: u64,
        /// What came of it.
        outcome: Outcome,
    },
    /// Change what outlives the program, as a whole.
    Remember(Vec<Remembered>),
    /// Tell what happened.
    Tell(News),
}

/// Something that happened to the network.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "each field is named in the doc of its variant")]
pub enum News {
    /// A program of this name is there.
    Joined { program: u64, name: Arc<str> },
    /// It was started again, and goes on from its state folder.
    GoesOn { program: u64, name: Arc<str> },
    /// It goes on from a state that is older than what was received on a topic: so many messages.
    Older { name: Arc<str>, topic: Arc<str>, after: u64 },
    /// It ended.
    Left { program: u64, name: Arc<str> },
    /// It gives no sign of life; these components were heard of it.
    Unreachable { program: u64, name: Arc<str>, components: Vec<Arc<str>> },
    /// It gives signs of life again.
    Back { program: u64, name: Arc<str> },
    /// It was away for so long that nothing is kept for it any more: it lacks so many events.
    GivenUp { program: u64, name: Arc<str>, count: u64 },
    /// It is there again, and lacks so many more events that were not kept for it meanwhile.
    NotKept { name: Arc<str>, count: u64 },
    /// Its components have begun in another program: nothing is kept for it any more.
    Replaced { name: Arc<str> },
    /// So many events of a topic did not arrive from it, and cannot be sent again.
    Lost { program: u64, name: Arc<str>, topic: Arc<str>, count: u64 },
    /// So many events of a topic did not arrive from it, which has ended: they stay in its state folder.
    Stays { name: Arc<str>, topic: Arc<str>, count: u64 },
    /// So many events of this program, which ends, were not received by another one.
    Unreceived { name: Arc<str>, topic: Arc<str>, count: u64 },
    /// So many events of this program, which ends, stay in its state folder for another one.
    Later { name: Arc<str>, topic: Arc<str>, count: u64 },
    /// A component of this program runs in another one, which began later: this one has to end.
    Superseded { component: Arc<str>, name: Arc<str> },
    /// A component runs in two programs, of which one may be this one: its messages from this program are ignored.
    Twice { component: Arc<str>, program: u64, name: Arc<str> },
    /// A component begins anew in another program; so many of its messages came from the one before.
    Anew { component: Arc<str>, program: u64, name: Arc<str>, after: u64 },
    /// A program sends messages of another schema on a topic, which are ignored; its component that was heard first.
    Differs { program: u64, name: Arc<str>, component: Arc<str>, topic: Arc<str> },
    /// So many events of this program on a topic were forgotten before all had received them.
    Overflow { topic: Arc<str>, count: u64 },
}

impl News {
    /// Number of messages that are lost with it.
    pub fn lost(&self) -> u64 {
        match self {
            News::GivenUp { count, .. }
            | News::NotKept { count, .. }
            | News::Lost { count, .. }
            | News::Unreceived { count, .. }
            | News::Overflow { count, .. } => *count,
            _ => 0,
        }
    }
}

/// A message of a component of this program.
#[derive(Clone, Debug)]
pub struct OwnMessage<'a> {
    /// The topic.
    pub topic: &'a Arc<str>,
    /// True for a state topic.
    pub is_state: bool,
    /// The component: its path.
    pub component: &'a Arc<str>,
    /// The component that it is for; `None`: all readers.
    pub to: Option<Arc<str>>,
    /// The key of a message of a state topic.
    pub key: Option<u64>,
    /// Wall clock, in nanoseconds since 1970.
    pub sent: u64,
    /// The hash of the schema.
    pub schema: u64,
    /// The record of the journal with the reason; 0 is none.
    pub cause: u64,
    /// The block of a message whose type has a place.
    pub place: Option<(i32, i32)>,
    /// The number of an event in the state folder.
    pub number: Option<u64>,
    /// The message.
    pub bytes: &'a [u8],
}
