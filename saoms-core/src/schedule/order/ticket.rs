use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Weak};
use std::time::Duration;

use serde_json::Value;

use super::OrderError;

/// The answer of an order that was accepted, on its way.
#[derive(Debug)]
pub struct OrderTicket {
    answer: Receiver<Result<Value, OrderError>>,
    /// The other end, for as long as somebody can answer.
    sender: Weak<Sender<Result<Value, OrderError>>>,
    state: Arc<AtomicU8>,
}

/// The way to withdraw an order while somebody else waits for its answer.
#[derive(Clone, Debug)]
pub struct OrderWithdrawal {
    sender: Weak<Sender<Result<Value, OrderError>>>,
    state: Arc<AtomicU8>,
}

/// The order waits to begin.
const WAITING: u8 = 0;
/// It has begun.
const BEGUN: u8 = 1;
/// Nobody wants it any more.
const WITHDRAWN: u8 = 2;

/// Where the answer goes.
#[derive(Debug)]
pub(super) struct Answering {
    answer: Arc<Sender<Result<Value, OrderError>>>,
    state: Arc<AtomicU8>,
}

/// A ticket and its other end.
pub(super) fn ticket() -> (OrderTicket, Answering) {
    let ((sender, answer), state) = (channel(), Arc::new(AtomicU8::new(WAITING)));
    let other = Answering { answer: Arc::new(sender), state: Arc::clone(&state) };
    (OrderTicket { answer, sender: Arc::downgrade(&other.answer), state }, other)
}

impl OrderTicket {
    /// Waits for the answer. An order without one within this time is withdrawn, unless it has begun.
    ///
    /// # Errors
    /// The order was refused, or has no answer yet.
    pub fn wait(&self, time: Duration) -> Result<Value, OrderError> {
        match self.answer.recv_timeout(time) {
            Ok(answer) => answer,
            Err(RecvTimeoutError::Disconnected) => Err(OrderError::Ending),
            Err(RecvTimeoutError::Timeout) => {
                let before = self.state.compare_exchange(WAITING, WITHDRAWN, Ordering::SeqCst, Ordering::SeqCst);
                let late = if before == Err(BEGUN) { OrderError::Begun } else { OrderError::NotYet };
                // It may have come meanwhile.
                self.answer.try_recv().unwrap_or(Err(late))
            }
        }
    }
}

impl OrderTicket {
    /// The way to withdraw the order from elsewhere.
    pub fn withdrawal(&self) -> OrderWithdrawal {
        OrderWithdrawal { sender: Weak::clone(&self.sender), state: Arc::clone(&self.state) }
    }
}

impl OrderWithdrawal {
    /// Withdraws the order, unless it has begun: who waits for its answer gets [`OrderError::NotYet`] at once. True if
    /// it has no effect.
    pub fn withdraw(&self) -> bool {
        let is_withdrawn = self.state.compare_exchange(WAITING, WITHDRAWN, Ordering::SeqCst, Ordering::SeqCst).is_ok();
        if let Some(sender) = self.sender.upgrade().filter(|_| is_withdrawn) {
            // Nobody may wait.
            let _ = sender.send(Err(OrderError::NotYet));
        }
        is_withdrawn
    }
}

impl Answering {
    /// Gives the answer. Gives the error back that nobody waits for.
    pub(super) fn give(self, answer: Result<Value, OrderError>) -> Option<OrderError> {
        self.answer.send(answer).err().and_then(|unsent| unsent.0.err())
    }

    pub(super) fn is_cancelled(&self) -> bool {
        self.state.load(Ordering::SeqCst) == WITHDRAWN
    }

    /// The order begins: it is not withdrawn any more. False if it was.
    pub(super) fn begin(&self) -> bool {
        self.state.compare_exchange(WAITING, BEGUN, Ordering::SeqCst, Ordering::SeqCst).is_ok()
    }
}
