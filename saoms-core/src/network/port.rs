//! Where the threads of a run and of a transport leave what is for the thread of a network.

use std::collections::{BTreeSet, VecDeque};
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

/// Messages of components that wait for the thread of the network, at most.
const MOST_MESSAGES: usize = 262_144;
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

/// Who does the work of the thread of the network at once, on the thread that brings it: to wake another thread takes
/// longer than the work. It waits neither for that thread nor for the transport.
pub(super) trait AtOnce: Send + Sync {
    /// Takes a frame; false if the thread of the network has to.
    fn take(&self, delivered: &Delivered<'_>) -> bool;

    /// Sends the messages of components that wait; false if the thread of the network has to.
    fn send(&self) -> bool;
}

/// What waits for the thread of the network.
#[derive(Default)]
pub(crate) struct Waiting {
    pub(crate) from_run: Vec<FromRun>,
    /// Messages that found no room.
    pub(super) lost: u64,
    pub(super) frames: VecDeque<Frame>,
    bytes: usize,
    pub(super) links: Vec<LinkChange>,
    pub(super) is_closed: bool,
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
        are_messages && self.frames.is_empty() && self.links.is_empty() && !self.is_nudged
    }

    /// Takes all of it. What is known of the thread of the network stays: another one may take it while that one
    /// sleeps.
    fn take(&mut self) -> Waiting {
        let Waiting { is_closed, has_ended, sleeps, ref at_once, .. } = *self;
        let rest = Waiting { is_closed, has_ended, sleeps, at_once: at_once.clone(), ..Waiting::default() };
        std::mem::replace(self, rest)
    }

    /// True if there are a few short messages of components alone.
    fn is_short(&self) -> bool {
        let size = |from_run: &FromRun| match from_run {
            FromRun::Message { message, .. } => message.bytes().len(),
            _ => 0,
        };
        self.from_run.len() <= MOST_AT_ONCE
            && self.has_no_more_than_messages()
            && self.from_run.iter().map(size).sum::<usize>() <= MOST_BYTES_AT_ONCE
    }
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
                // What is read is said once; it is no more than there are topics.
                from_run
                    if !waiting.has_ended
                        && (waiting.from_run.len() < MOST_MESSAGES || matches!(from_run, FromRun::Reads { .. })) =>
                {
                    waiting.from_run.push(from_run);
                }
                FromRun::Call { ticket, .. } => ticket.fill(Outcome::Dropped),
                // Heartbeats are lost as on a network, and calls are made again.
                FromRun::Beat { .. } | FromRun::Reply { .. } | FromRun::Unserved { .. } => {}
                FromRun::Message { .. } | FromRun::Reads { .. } | FromRun::Wants { .. } => waiting.lost += 1,
                // Who asks gives up, and can ask again.
                FromRun::Answer { .. } => {}
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

    /// Ends the thread of the network.
    pub(super) fn close(&self) {
        let mut waiting = self.lock();
        waiting.is_closed = true;
        self.wake(waiting);
    }

    /// The thread of the network has ended: what the run leaves from now on is lost.
    pub(super) fn end(&self) {
        let mut waiting = self.lock();
        waiting.has_ended = true;
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

#[cfg(test)]
mod tests {
    use std::thread;
    use std::time::Instant;

    use super::*;

    /// Longest time for something that has to happen at once.
    const LONGEST: Duration = Duration::from_secs(60);

    #[test]
    fn what_components_read_is_never_lost() {
        let port = Port::default();
        let beat = || FromRun::Beat { node: String::new(), component: String::new(), caller: "".into(), period: 0 };
        port.put((0..=MOST_MESSAGES).map(|_| beat()));
        port.put([FromRun::Reads { topic: "TOPIC".into(), is_state: false, schema: 0 }].into_iter());
        let waiting = port.take();
        assert_eq!((waiting.from_run.len(), waiting.lost), (MOST_MESSAGES + 1, 0));
        assert!(matches!(waiting.from_run.last(), Some(FromRun::Reads { .. })));
    }

    #[test]
    fn who_sleeps_is_woken_after_another_thread_has_taken_what_waited() {
        let port = Port::default();
        let begin = Instant::now();
        thread::scope(|scope| {
            scope.spawn(|| port.wait(LONGEST, false));
            while !port.lock().sleeps && begin.elapsed() < LONGEST {
                thread::yield_now();
            }
            port.take();
            port.nudge();
        });
        assert!(begin.elapsed() < LONGEST / 2);
    }
}
