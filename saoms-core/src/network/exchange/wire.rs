//! What programs say to each other beside the messages of components.

use saoms_api::Message;

/// The largest number that a program says.
pub const LARGEST_NUMBER: u64 = 1 << 62;

/// What is said beside a message, or beside several events that a component sent one after the other: their bytes stand
/// one behind the other then.
#[derive(Clone, Debug, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Envelope")]
pub struct Envelope {
    /// The program that sends them.
    pub program: u64,
    /// The component that sends them: its path.
    pub component: String,
    /// The hash of the schema of the messages.
    pub schema: u64,
    /// The number of the first message among those of the program on its topic, from 1. The others follow it.
    pub number: u64,
    /// The messages.
    pub messages: Vec<Enclosed>,
    /// The cells that a message of a state topic with a place concerns: that of its block, and the one that it left.
    pub cells: Vec<InCell>,
}

/// A cell of blocks that a message concerns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/InCell")]
pub struct InCell {
    /// Its column: that of its blocks, by 16.
    pub x: i32,
    /// Its row.
    pub y: i32,
    /// The number of the message before this one that concerned the cell, or a greater one.
    pub before: u64,
    /// True if the message before it of its component and key was in this cell, and this one is not.
    pub has_left: bool,
}

/// What an [`Envelope`] says of one message.
#[derive(Clone, Debug, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Enclosed")]
pub struct Enclosed {
    /// Number of its bytes.
    pub size: u32,
    /// The component that it is for; empty: all readers of the topic.
    pub to: String,
    /// The key of a message of a state topic that has one.
    pub key: u64,
    /// True if there is a key.
    pub has_key: bool,
    /// Wall clock of its sending, in nanoseconds since 1970.
    pub sent: u64,
    /// The record of the sender's journal with the reason; 0 is none.
    pub cause: u64,
}

/// Sign of life of a program: what it sends, and what it has received of each other one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Alive")]
pub struct Alive {
    /// The program.
    pub program: u64,
    /// The program with whose numbers its events go on: the first one that had its state folder. Without one it is the
    /// program itself.
    pub origin: u64,
    /// Greater than that of each earlier start with this state folder; 0 without one.
    pub start: u64,
    /// When it began, in nanoseconds since 1970, but greater than that of each program that was known to have begun
    /// with one of its components. Of two programs with a component, the one with the greater date has it.
    pub began: u64,
    /// Its name for people: the node, or the name of its composite.
    pub name: String,
    /// The number of this sign, from 1.
    pub number: u64,
    /// Time after which a program that says nothing is missed, in milliseconds.
    pub patience: u64,
    /// The topics on which it sends.
    pub sends: Vec<Sends>,
    /// The topics that its components read.
    pub reads: Vec<Reads>,
    /// What it has received.
    pub received: Vec<Received>,
    /// What readers receive of it first.
    pub welcomes: Vec<Welcome>,
    /// Whether it sees work left: see [`Vote`].
    pub vote: u8,
    /// True in the last sign of a program that ends.
    pub leaves: bool,
}

/// Whether a program sees work left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Vote {
    /// None of its components says.
    #[default]
    Silent = 0,
    /// Work is left.
    Open = 1,
    /// All work is done.
    Done = 2,
}

impl Vote {
    /// The vote that a sign of life says. One that this program does not know is open.
    pub fn of(number: u8) -> Vote {
        match number {
            0 => Vote::Silent,
            2 => Vote::Done,
            _ => Vote::Open,
        }
    }
}

/// A topic on which a program sends.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Sends")]
pub struct Sends {
    /// The topic.
    pub topic: String,
    /// True for a state topic: a message may be left out where a newer one of its component and key follows.
    pub is_state: bool,
    /// The number of the last message.
    pub last: u64,
    /// The number of the first message that can be sent again.
    pub oldest: u64,
    /// Of an event topic, the number of the last message of an earlier start whose numbers go on.
    pub before: u64,
    /// True for a state topic whose messages are under the keys of cells.
    pub by_cells: bool,
    /// Cells that a message after this number concerned are in `cells`.
    pub since: u64,
    /// The cells that changed.
    pub cells: Vec<CellChange>,
}

/// A cell of blocks, with the number of the last message that concerned it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/CellChange")]
pub struct CellChange {
    /// Its column.
    pub x: i32,
    /// Its row.
    pub y: i32,
    /// The number of the message.
    pub last: u64,
}

/// A topic that components of a program read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Reads")]
pub struct Reads {
    /// The topic.
    pub topic: String,
}

/// All messages of a program on a topic were received before this number.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Received")]
pub struct Received {
    /// The program that sent them.
    pub program: u64,
    /// The topic.
    pub topic: String,
    /// The number of the first message that was not received.
    pub next: u64,
}

/// A reader receives the messages of a topic from this number on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Welcome")]
pub struct Welcome {
    /// The program that reads.
    pub reader: u64,
    /// The topic.
    pub topic: String,
    /// The number of the first message for it.
    pub first: u64,
}

/// A request to send messages again.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Again")]
pub struct Again {
    /// The program that asks.
    pub reader: u64,
    /// The topic.
    pub topic: String,
    /// The number of the first message.
    pub first: u64,
    /// The number of the last message.
    pub last: u64,
}

/// The answer to a request for messages of a state topic: those of them that are not outdated, which were sent.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Covered")]
pub struct Covered {
    /// The program that answers.
    pub program: u64,
    /// The topic.
    pub topic: String,
    /// The number of the first message that was asked for.
    pub first: u64,
    /// The number of the last message of this answer.
    pub last: u64,
    /// Those that are not outdated, in order.
    pub numbers: Vec<u64>,
}

/// A request for the states that concern cells.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Look")]
pub struct Look {
    /// The program that asks.
    pub reader: u64,
    /// The topic.
    pub topic: String,
    /// The number of the request: a later one has a greater one.
    pub number: u64,
    /// The cells.
    pub cells: Vec<CellName>,
    /// The messages in these cells that it has.
    pub known: Vec<KnownState>,
}

/// A cell of blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Message)]
#[message(name = "saoms_msgs/msg/CellName")]
pub struct CellName {
    /// Its column: that of its blocks, by 16.
    pub x: i32,
    /// Its row.
    pub y: i32,
}

/// A message of a state topic that a program has.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/KnownState")]
pub struct KnownState {
    /// The component that sent it.
    pub component: String,
    /// Its key.
    pub key: u64,
    /// True if there is a key.
    pub has_key: bool,
    /// Its number.
    pub number: u64,
}

/// The answer to a [`Look`]: what the reader lacks of the first of its cells.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Around")]
pub struct Around {
    /// The program that answers.
    pub program: u64,
    /// The topic.
    pub topic: String,
    /// The number of the request.
    pub number: u64,
    /// The number of the last message of the topic: what concerns the cells up to it is in `messages`, or known.
    pub last: u64,
    /// The cells of this answer; the reader asks again for the others.
    pub cells: Vec<CellName>,
    /// The hash of the schema of the messages.
    pub schema: u64,
    /// The numbers of what is in these cells and the reader knows: what else it has there has left them.
    pub here: Vec<u64>,
    /// What the reader lacks.
    pub messages: Vec<AroundState>,
}

/// A message of an [`Around`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/AroundState")]
pub struct AroundState {
    /// Its number.
    pub number: u64,
    /// The component that sent it.
    pub component: String,
    /// The component that it is for; empty: all readers.
    pub to: String,
    /// Its key.
    pub key: u64,
    /// True if there is a key.
    pub has_key: bool,
    /// Wall clock of its sending, in nanoseconds since 1970.
    pub sent: u64,
    /// The record of the sender's journal with the reason; 0 is none.
    pub cause: u64,
    /// The cell that it is in; none if it is in none any more.
    pub cell: Option<CellName>,
    /// The message.
    pub bytes: Vec<u8>,
}

/// What a program says before its components begin, to all others; and the answer of one in which some of them run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Begins")]
pub struct Begins {
    /// The program that says it.
    pub program: u64,
    /// Its name for people.
    pub name: String,
    /// Time after which it is missed, in milliseconds.
    pub patience: u64,
    /// The components that are about to begin; of an answer, those among them that run there.
    pub components: Vec<String>,
    /// When the program began: see [`Alive`].
    pub began: u64,
    /// Of an answer, the latest such date of the programs that are known to have begun with one of the components that
    /// it was asked for; 0 for none.
    pub latest: u64,
    /// Of the answer of a router that has just begun, the time within which others connect to it, in milliseconds.
    pub settles: u64,
}

/// A call of an operation of a component, to the program that has it; or, with the number 0, a heartbeat for its
/// hardware.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Request")]
pub struct Request {
    /// The program that calls.
    pub program: u64,
    /// The line of the call: a reference of a component of that program. Its calls are one after the other.
    pub line: u64,
    /// The number of the call on its line, from 1. A call that is put again keeps it.
    pub number: u64,
    /// The component that is called: its path.
    pub component: String,
    /// Its service.
    pub service: String,
    /// The number of the operation: its place in the interface, or [`STOP`].
    pub operation: u32,
    /// The hash of the interface.
    pub interface: u64,
    /// The component that calls: its path.
    pub caller: String,
    /// The record of the caller's journal with the reason; 0 is none.
    pub cause: u64,
    /// The number of the newest sign of life that the caller has of the program.
    pub sign: u64,
    /// The time since it came, in nanoseconds.
    pub age: u64,
    /// The time for which the caller still wants the call, in nanoseconds; of a heartbeat, that to the next one.
    pub left: u64,
    /// The arguments in CDR.
    pub arguments: Vec<u8>,
}

/// The operation that stops the hardware of a component.
pub const STOP: u32 = u32::MAX;

/// The answer to a [`Request`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Reply")]
pub struct Reply {
    /// The program that answers.
    pub program: u64,
    /// The line of the call.
    pub line: u64,
    /// Its number.
    pub number: u64,
    /// What came of it: 0 a reply, 1 the component was busy, 2 it does not run, 3 it has no such operation, 4 it
    /// failed.
    pub outcome: u8,
    /// Of all but a reply, the reason.
    pub text: String,
    /// The reply in CDR.
    pub bytes: Vec<u8>,
}
