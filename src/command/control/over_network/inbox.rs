//! What arrives from a network, for a command that waits for it.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

use saoms_core::network::transport::{Delivered, Receiver};

/// Messages that wait to be looked at, at most: what is left out is sent again.
const MOST: usize = 65_536;

/// Messages that have arrived, each with the token of its subscription.
#[derive(Debug, Default)]
pub(super) struct Inbox {
    waiting: Mutex<VecDeque<(u64, Vec<u8>)>>,
    filled: Condvar,
}

impl Inbox {
    /// The next message, if there is one within this time.
    pub(super) fn next(&self, patience: Duration) -> Option<(u64, Vec<u8>)> {
        let waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let filled = self.filled.wait_timeout_while(waiting, patience, |waiting| waiting.is_empty());
        filled.unwrap_or_else(PoisonError::into_inner).0.pop_front()
    }
}

impl Receiver for Inbox {
    fn deliver(&self, delivered: Delivered<'_>) -> bool {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting.len() >= MOST {
            return false;
        }
        waiting.push_back((delivered.token, delivered.message.to_vec()));
        self.filled.notify_one();
        true
    }

    fn link(&self, _is_up: bool, _reason: &str) {}
}
