use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use serde_json::Value;

use super::OrderError;

/// The answer of an order that was accepted, on its way.
#[derive(Debug)]
pub struct OrderTicket {
    answer: Receiver<Result<Value, OrderError>>,
    is_cancelled: Arc<AtomicBool>,
}

/// Where the answer goes.
#[derive(Debug)]
pub(super) struct Answering {
    answer: Sender<Result<Value, OrderError>>,
    is_cancelled: Arc<AtomicBool>,
}

/// A ticket and its other end.
pub(super) fn ticket() -> (OrderTicket, Answering) {
    let ((answering, answer), is_cancelled) = (channel(), Arc::<AtomicBool>::default());
    let other = Answering { answer: answering, is_cancelled: Arc::clone(&is_cancelled) };
    (OrderTicket { answer, is_cancelled }, other)
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
                self.is_cancelled.store(true, Ordering::SeqCst);
                // It may have come meanwhile.
                self.answer.try_recv().unwrap_or(Err(OrderError::NotYet))
            }
        }
    }
}

impl Answering {
    /// Gives the answer. Gives the error back that nobody waits for.
    pub(super) fn give(self, answer: Result<Value, OrderError>) -> Option<OrderError> {
        self.answer.send(answer).err().and_then(|unsent| unsent.0.err())
    }

    pub(super) fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::SeqCst)
    }
}
