//! Where the threads of a run and of a transport leave what is for the thread of a network.

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};
use std::fmt;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use saoms_api::CallError;
use saoms_api::host::SharedMessage;

use super::control::Answer;
use super::exchange::call::{Outcome, OwnCall};
use super::ticket::Ticket;
use super::transport::{Delivered, Receiver};
use crate::bus::Cell;

/// Messages of components that wait for the thread of the network, at most, and their bytes, but for those of a single
/// one.
const MOST_MESSAGES: usize = 262_144;
const MOST_MESSAGE_BYTES: usize = 256 << 20;
/// Bytes of the newest states that wait beyond these, at most: then those of new keys are lost.
const MOST_BEYOND_BYTES: usize = 64 << 20;
/// Messages that the thread which leaves them sends itself, at most: more take longer than to wake another thread.
pub(super) const MOST_AT_ONCE: usize = 16;
/// Bytes of these, at most: so many fit into one packet of a transport, for which it need not wait for room.
pub(super) const MOST_BYTES_AT_ONCE: usize = 32 << 10;
/// Bytes that wait for it from the transport, at most.
const MOST_BYTES: usize = 64 << 20;

/// What the run has for the network.
#[derive(Debug)]
pub(crate) enum FromRun {
    /// A component sent a message.
    Message {
        topic: Arc<str>,
        component: Arc<str>,
        /// The component that it is for; `None`: all readers.
        to: Option<Arc<str>>,
        is_state: bool,
        /// The hash of the schema.
        schema: u64,
        /// The number of an event in the state folder.
        number: Option<u64>,
        message: SharedMessage,
    },
    /// So many events of a topic found no room, and are lost; the last one had this number in the state folder.
    Skipped { topic: Arc<str>, count: u64, last: Option<u64> },
    /// Components publish a topic; of networks of other programs alone.
    Publishes { topic: Arc<str> },
    /// Components read a topic.
    Reads { topic: Arc<str>, is_state: bool, schema: u64 },
    /// They read these cells of it alone; `None`: all of it.
    Wants { topic: Arc<str>, cells: Option<BTreeSet<Cell>> },
    /// A component calls one of another program; its outcome goes to the ticket.
    Call { call: OwnCall, ticket: Arc<Ticket> },
    /// A component has executed that uses the hardware of a component of this node; it does so again within this time
    /// in nanoseconds.
    Beat { node: String, component: String, caller: Arc<str>, period: u64 },
    /// The answer to a call of another program.
    Reply { program: u64, line: u64, number: u64, answer: Result<Vec<u8>, CallError> },
    /// A call of another program did not begin in time, and does not any more.
    Unserved { program: u64, line: u64, number: u64 },
    /// A part of the answer to a request.
    Answer { asker: u64, answer: Answer },
}

/// A frame that arrived.
#[derive(Debug)]
pub(super) struct Frame {
    pub(super) token: u64,
    pub(super) key: String,
    pub(super) message: Vec<u8>,
    pub(super) attachment: Vec<u8>,
}

/// The state of the link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct LinkChange {
    pub(super) is_up: bool,
    pub(super) reason: String,
}

/// What is known of the link while a program enters.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LinkState {
    pub(super) is_down: bool,
    /// How often it was lost.
    pub(super) losses: usize,
}

/// Who does the work of the thread of the network at once, on the thread that brings it: to wake another thread takes
/// longer than the work. It waits neither for that thread nor for the transport.
pub(super) trait AtOnce: Send + Sync {
    /// Takes a frame; false if the thread of the network has to.
    fn take(&self, delivered: &Delivered<'_>) -> bool;

    /// Sends the messages of components that wait; false if the thread of the network has to.
    fn send(&self) -> bool;
}

/// The topic, the component and the key of a state.
type StateKey = (Arc<str>, Arc<str>, Option<u64>);

/// Messages that found no room. Until all that waits is taken, no later message waits before them.
#[derive(Default)]
struct Beyond {
    /// The newest of each state.
    states: HashMap<StateKey, FromRun>,
    /// Bytes of these, with what stands around them.
    bytes: usize,
    /// Of each topic, how many events are lost, and the number of the last one in the state folder.
    events: BTreeMap<Arc<str>, (u64, Option<u64>)>,
}

impl Beyond {
    fn is_empty(&self) -> bool {
        self.states.is_empty() && self.events.is_empty()
    }

    /// Takes a message. True if it is lost.
    fn take(&mut self, message: FromRun) -> bool {
        let FromRun::Message { topic, component, is_state, number, message: content, .. } = &message else {
            return false;
        };
        if *is_state {
            let (key, size) = ((Arc::clone(topic), Arc::clone(component), content.key()), beyond_size(&message));
            // What is known is never older than what is sent, however long it is.
            if let Some(before) = self.states.get_mut(&key) {
                self.bytes = (self.bytes + size).saturating_sub(beyond_size(before));
                *before = message;
                return false;
            }
            if self.bytes + size > MOST_BEYOND_BYTES {
                return true;
            }
            self.bytes += size;
            self.states.insert(key, message);
            return false;
        }
        let (count, last) = self.events.entry(Arc::clone(topic)).or_default();
        (*count, *last) = (*count + 1, number.or(*last));
        true
    }

    fn into_all(self) -> impl Iterator<Item = FromRun> {
        let skipped = |(topic, (count, last))| FromRun::Skipped { topic, count, last };
        self.states.into_values().chain(self.events.into_iter().map(skipped))
    }
}

/// What waits for the thread of the network.
#[derive(Default)]
pub(crate) struct Waiting {
    pub(crate) from_run: Vec<FromRun>,
    /// Bytes of the messages among it.
    message_bytes: usize,
    /// What is wanted of topics: what is said last counts.
    wants: BTreeMap<Arc<str>, Option<BTreeSet<Cell>>>,
    beyond: Beyond,
    /// Events that found no room, and states of new keys that found none beyond it.
    pub(super) lost: u64,
    pub(super) frames: VecDeque<Frame>,
    bytes: usize,
    pub(super) links: Vec<LinkChange>,
    pub(super) is_closed: bool,
    /// True if nobody is waited for then.
    pub(super) is_abandoned: bool,
    /// True once nobody takes anything any more.
    has_ended: bool,
    /// True if the thread is to look at its times again.
    is_nudged: bool,
    sleeps: bool,
    at_once: Option<Weak<dyn AtOnce>>,
}

impl Waiting {
    fn is_empty(&self) -> bool {
        self.from_run.is_empty() && self.has_no_more_than_messages()
    }

    /// True if there is nothing but messages of components.
    pub(super) fn has_no_more_than_messages(&self) -> bool {
        let are_messages = self.from_run.iter().all(|from_run| matches!(from_run, FromRun::Message { .. }));
        are_messages && self.wants.is_empty() && self.frames.is_empty() && self.links.is_empty() && !self.is_nudged
    }

    /// Takes all of it. What is known of the thread of the network stays: another one may take it while that one
    /// sleeps.
    fn take(&mut self) -> Waiting {
        let Waiting { is_closed, is_abandoned, has_ended, sleeps, ref at_once, .. } = *self;
        let at_once = at_once.clone();
        let rest = Waiting { is_closed, is_abandoned, has_ended, sleeps, at_once, ..Waiting::default() };
        let mut taken = std::mem::replace(self, rest);
        let (wants, beyond) = (std::mem::take(&mut taken.wants), std::mem::take(&mut taken.beyond));
        taken.from_run.extend(wants.into_iter().map(|(topic, cells)| FromRun::Wants { topic, cells }));
        taken.from_run.extend(beyond.into_all());
        taken
    }

    /// True if there is room for something: what is read is said once, and is no more than there are topics.
    fn has_room_for(&self, from_run: &FromRun) -> bool {
        let has_room = self.from_run.len() < MOST_MESSAGES;
        match from_run {
            FromRun::Publishes { .. } | FromRun::Reads { .. } => true,
            FromRun::Message { .. } => {
                let bytes = self.message_bytes + size(from_run);
                has_room && self.beyond.is_empty() && (bytes <= MOST_MESSAGE_BYTES || self.message_bytes == 0)
            }
            _ => has_room,
        }
    }

    /// True if there are a few short messages of components alone.
    fn is_short(&self) -> bool {
        self.from_run.len() <= MOST_AT_ONCE
            && self.has_no_more_than_messages()
            && self.message_bytes <= MOST_BYTES_AT_ONCE
    }
}

/// Number of the bytes of a message.
fn size(from_run: &FromRun) -> usize {
    match from_run {
        FromRun::Message { message, .. } => message.bytes().len(),
        _ => 0,
    }
}

/// The same with what stands around them: small states are the usual ones.
fn beyond_size(from_run: &FromRun) -> usize {
    size(from_run) + size_of::<FromRun>() + size_of::<StateKey>()
}

/// The place where the threads of a run and of a transport leave what is for the thread of a network. Nobody waits.
#[derive(Default)]
pub struct Port {
    waiting: Mutex<Waiting>,
    filled: Condvar,
}

impl fmt::Debug for Port {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Port").finish_non_exhaustive()
    }
}

impl Port {
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wake(&self, mut waiting: MutexGuard<'_, Waiting>) {
        let sleeps = std::mem::take(&mut waiting.sleeps);
        drop(waiting);
        if sleeps {
            self.filled.notify_one();
        }
    }

    /// Leaves what the run has, and has it sent.
    pub(crate) fn put(&self, all: impl Iterator<Item = FromRun>) {
        self.leave(all);
        self.send(true);
    }

    /// Leaves what the run has, in order with what others leave. [`Port::send`] has to follow.
    pub(crate) fn leave(&self, all: impl Iterator<Item = FromRun>) {
        let mut waiting = self.lock();
        for from_run in all {
            match from_run {
                FromRun::Wants { topic, cells } if !waiting.has_ended => {
                    waiting.wants.insert(topic, cells);
                }
                from_run if !waiting.has_ended && waiting.has_room_for(&from_run) => {
                    waiting.message_bytes += size(&from_run);
                    waiting.from_run.push(from_run);
                }
                FromRun::Call { ticket, .. } => ticket.fill(Outcome::Dropped),
                // Heartbeats are lost as on a network, and calls are made again.
                FromRun::Beat { .. } | FromRun::Reply { .. } | FromRun::Unserved { .. } => {}
                message @ FromRun::Message { .. } if !waiting.has_ended => {
                    let is_lost = waiting.beyond.take(message);
                    waiting.lost += u64::from(is_lost);
                }
                // Nobody takes it any more, or who asks gives up, and can ask again.
                FromRun::Message { .. } | FromRun::Skipped { .. } | FromRun::Answer { .. } => {}
                FromRun::Publishes { .. } | FromRun::Reads { .. } | FromRun::Wants { .. } => {}
            }
        }
    }

    /// Has sent what the run has left: a few messages by the caller itself if it may and the thread of the network
    /// sleeps. The caller holds no lock of the run.
    pub(crate) fn send(&self, may_send: bool) {
        let mut waiting = self.lock();
        if may_send
            && waiting.sleeps
            && waiting.is_short()
            && let Some(at_once) = waiting.at_once.as_ref().and_then(Weak::upgrade)
        {
            drop(waiting);
            if at_once.send() {
                return;
            }
            waiting = self.lock();
        }
        self.wake(waiting);
    }

    /// Ends the thread of the network; at once, or when others have received what they lack.
    pub(super) fn close(&self, is_abandoned: bool) {
        let mut waiting = self.lock();
        waiting.is_closed = true;
        waiting.is_abandoned |= is_abandoned;
        // Who knows of the end does not sleep for long, and would not wake for this.
        waiting.is_nudged |= is_abandoned;
        self.wake(waiting);
    }

    /// True once the end was asked for.
    pub(super) fn is_closed(&self) -> bool {
        self.lock().is_closed
    }

    /// The thread of the network has ended: what the run leaves from now on is lost.
    pub(super) fn end(&self) {
        let mut waiting = self.lock();
        waiting.has_ended = true;
        (waiting.wants, waiting.beyond, waiting.message_bytes) = Default::default();
        for from_run in std::mem::take(&mut waiting.from_run) {
            if let FromRun::Call { ticket, .. } = from_run {
                ticket.fill(Outcome::Dropped);
            }
        }
    }

    /// Waits until something is there, for so long at most. Who does not know yet that the end was asked for does not
    /// wait then.
    pub(super) fn wait(&self, patience: Duration, knows_end: bool) {
        let mut waiting = self.lock();
        if waiting.is_empty() && (knows_end || !waiting.is_closed) && patience > Duration::ZERO {
            waiting.sleeps = true;
            waiting = self.filled.wait_timeout(waiting, patience).unwrap_or_else(PoisonError::into_inner).0;
            waiting.sleeps = false;
        }
    }

    /// Takes what waits.
    pub(crate) fn take(&self) -> Waiting {
        self.lock().take()
    }

    /// What was said of the link, and was not taken.
    pub(super) fn link_state(&self) -> LinkState {
        let waiting = self.lock();
        let losses = waiting.links.iter().filter(|link| !link.is_up).count();
        LinkState { is_down: waiting.links.last().is_some_and(|link| !link.is_up), losses }
    }

    /// Takes the frames that wait, and leaves all else.
    pub(super) fn take_frames(&self) -> VecDeque<Frame> {
        let mut waiting = self.lock();
        waiting.bytes = 0;
        std::mem::take(&mut waiting.frames)
    }

    /// Takes what waits if it is a few short messages of components alone, and the thread of the network has not ended.
    pub(super) fn take_short(&self) -> Option<Waiting> {
        let mut waiting = self.lock();
        (waiting.is_short() && !waiting.has_ended).then(|| waiting.take())
    }

    /// Lets this one do at once what it can, while nothing waits that comes before it.
    pub(super) fn let_take(&self, at_once: Weak<dyn AtOnce>) {
        self.lock().at_once = Some(at_once);
    }

    /// Has the thread of the network look at its times again.
    pub(super) fn nudge(&self) {
        let mut waiting = self.lock();
        waiting.is_nudged = true;
        self.wake(waiting);
    }
}

impl Receiver for Port {
    fn deliver(&self, delivered: Delivered<'_>) -> bool {
        let mut waiting = self.lock();
        if waiting.frames.is_empty()
            && let Some(at_once) = waiting.at_once.as_ref().and_then(Weak::upgrade)
        {
            drop(waiting);
            if at_once.take(&delivered) {
                return true;
            }
            waiting = self.lock();
        }
        let size = delivered.message.len() + delivered.attachment.len();
        if waiting.bytes + size > MOST_BYTES {
            return false;
        }
        waiting.bytes += size;
        waiting.frames.push_back(Frame {
            token: delivered.token,
            key: delivered.key.to_owned(),
            message: delivered.message.to_vec(),
            attachment: delivered.attachment.to_vec(),
        });
        self.wake(waiting);
        true
    }

    fn link(&self, is_up: bool, reason: &str) {
        let mut waiting = self.lock();
        waiting.links.push(LinkChange { is_up, reason: reason.to_owned() });
        self.wake(waiting);
    }
}
