//! Calls of other programs, which this one serves.

use std::sync::Arc;

use saoms_api::CallError;
use saoms_api::host::cdr;

use crate::network::exchange::wire::{Reply, Request};
use crate::network::exchange::{Action, Destination, Exchange};

/// Lines of one program that are served, at most: more than a fleet has references.
const MOST_LINES: usize = 65_536;
/// Bytes of an answer, at most: the last one of each line is kept.
const MOST_BYTES: usize = 1 << 20;
/// Signs of life that are remembered.
const MOST_SIGNS: usize = 256;

/// The last call of a line of another program.
#[derive(Debug)]
pub(in crate::network::exchange) struct Served {
    number: u64,
    /// `None` while it runs.
    answer: Option<Arc<[u8]>>,
}

impl Exchange {
    /// A call of another program arrived.
    pub fn take_request(&mut self, request: Request, now: u64) {
        self.pass(now);
        let is_fresh = self.is_fresh(&request);
        // One that was not heard yet is heard soon, and puts its call again.
        let Some(peer) = self.peers.get_mut(&request.program) else { return };
        if request.number == 0 {
            return self.actions.push(Action::Serve(request));
        }
        let is_full = peer.served.len() >= MOST_LINES;
        match peer.served.get(&request.line) {
            Some(known) if known.number > request.number => return,
            Some(Served { number, answer }) if *number == request.number => {
                if let Some(bytes) = answer.clone() {
                    let to = Destination::Reply(request.program);
                    self.actions.push(Action::Put { to, bytes });
                }
                return;
            }
            None if is_full => return,
            _ => {}
        }
        if is_fresh {
            peer.served.insert(request.line, Served { number: request.number, answer: None });
            self.actions.push(Action::Serve(request));
        }
    }

    /// Answers a call of another program.
    pub fn reply(&mut self, program: u64, line: u64, number: u64, answer: Result<Vec<u8>, CallError>) {
        let peer = self.peers.get_mut(&program);
        let served = peer.and_then(|peer| peer.served.get_mut(&line)).filter(|served| served.number == number);
        // Who has left, or has called again meanwhile, does not wait for it.
        let Some(served) = served else { return };
        let (outcome, text, bytes) = match answer {
            Ok(bytes) if bytes.len() > MOST_BYTES => (
                4,
                format!("its answer of {} bytes is too long for a network: {MOST_BYTES} are the most", bytes.len()),
                Vec::new(),
            ),
            Ok(bytes) => (0, String::new(), bytes),
            Err(CallError::Busy { .. }) => (1, String::new(), Vec::new()),
            Err(CallError::NotRunning { .. }) => (2, String::new(), Vec::new()),
            Err(CallError::Mismatch { message }) => (3, message, Vec::new()),
            Err(CallError::Failed { provider, failure }) if provider.is_empty() => (4, failure.to_string(), Vec::new()),
            Err(error) => (4, error.to_string(), Vec::new()),
        };
        let reply = Reply { program: self.settings.program, line, number, outcome, text, bytes };
        let bytes: Arc<[u8]> = cdr::encode(&reply).into();
        served.answer = Some(Arc::clone(&bytes));
        self.actions.push(Action::Put { to: Destination::Reply(program), bytes });
    }

    /// A call of another program has not begun, and does not any more. If its caller still wants it, it puts it again.
    pub fn unserved(&mut self, program: u64, line: u64, number: u64) {
        let served = self.peers.get_mut(&program).and_then(|peer| peer.served.get_mut(&line));
        if let Some(served) = served.filter(|served| served.number == number) {
            *served = Served { number: number - 1, answer: None };
        }
    }

    /// Notes when a sign of life was given.
    pub(in crate::network::exchange) fn note_sign(&mut self) {
        self.signs.push_back((self.sign, self.now));
        if self.signs.len() > MOST_SIGNS {
            self.signs.pop_front();
        }
    }

    /// True if its caller still wants a call: the way of a sign of life to the caller, and of the call here, did not
    /// take longer than that.
    fn is_fresh(&self, request: &Request) -> bool {
        let given = self.signs.iter().rev().find(|(number, _)| *number == request.sign);
        given.is_some_and(|(_, at)| self.now.saturating_sub(*at).saturating_sub(request.age) <= request.left)
    }
}
