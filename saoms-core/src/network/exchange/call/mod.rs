//! Calls of components of other programs.
//!
//! A reference of a component is a *line*. Its calls are made one after the other: the next one is put once the one
//! before has an outcome. A call has a number on its line, and is put again, under its number, until it is answered.
//! The program that serves it keeps the number of the last call of each line with its answer: so a call **runs at most
//! once**, however often it arrives, and what is kept is bounded.
//!
//! - A call is for one start of a program. If that has ended, or was begun anew, the call is [gone](Outcome::Gone): it
//!   is not put to another start, where it could run again.
//! - A call that its caller does not want any more does not begin: it says how long it is wanted from a sign of life on
//!   that the program itself has given, so that each program measures with its own clock. What a stopped program finds
//!   in its queues when it goes on is not carried out.

mod serve;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use saoms_api::host::cdr;
use saoms_api::{CallError, Failure};

pub(super) use self::serve::Served;
use super::wire::{Reply, Request};
use super::{Action, Destination, Exchange, MILLISECOND};

/// Time after which a call is put again, at first and at most.
const FIRST_PAUSE: u64 = 100 * MILLISECOND;
const LONGEST_PAUSE: u64 = 1_000 * MILLISECOND;
/// Time for which a call without a deadline is wanted, each time it is put.
const LEASE: u64 = 3_000 * MILLISECOND;
/// Calls that wait on a line, at most.
const MOST_WAITING: usize = 64;

/// A call of this program.
#[derive(Clone, Debug, Default)]
pub struct OwnCall {
    /// The reference of a component, by a number that no other one of this program has.
    pub line: u64,
    /// The name of the program that has the component.
    pub node: String,
    /// The number of that program if the call is for the start that gave earlier answers alone.
    pub program: Option<u64>,
    /// The component that is called: its path.
    pub component: String,
    /// Its service.
    pub service: String,
    /// The number of the operation.
    pub operation: u32,
    /// The hash of the interface.
    pub interface: u64,
    /// The component that calls: its path.
    pub caller: String,
    /// The record of the journal with the reason; 0 is none.
    pub cause: u64,
    /// Time within which it has to be answered, in nanoseconds; `None`: it waits.
    pub deadline: Option<u64>,
    /// True if the calls before it on its line are not wanted any more.
    pub overtakes: bool,
    /// The arguments in CDR.
    pub arguments: Vec<u8>,
}

/// What came of a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A reply.
    Reply {
        /// The program that gave it.
        program: u64,
        /// The reply in CDR.
        bytes: Vec<u8>,
    },
    /// The component did not serve it.
    Refused {
        /// The program that said so.
        program: u64,
        /// Why.
        error: CallError,
    },
    /// The program that it was for has ended, or has begun anew: it ran there, or not at all.
    Gone,
    /// No answer came within its deadline.
    Late {
        /// True if the program was there.
        was_there: bool,
    },
    /// It was not made: too many wait, or one came that overtakes it.
    Dropped,
}

/// The calls of a reference.
#[derive(Debug, Default)]
pub(super) struct Line {
    /// The number of the last call.
    last: u64,
    /// The first one is put.
    waiting: VecDeque<Waiting>,
}

#[derive(Debug)]
struct Waiting {
    number: u64,
    call: OwnCall,
    until: Option<u64>,
    /// The program that it was put to.
    program: Option<u64>,
    /// When it is put again.
    again_at: u64,
    /// Number of times that it was put.
    count: u32,
}

impl Exchange {
    /// Makes a call. Gives its number on its line; its outcome is an [`Action::Answered`].
    pub fn call(&mut self, call: OwnCall, now: u64) -> u64 {
        self.pass(now);
        let (id, now) = (call.line, self.now);
        let line = self.lines.entry(id).or_default();
        line.last += 1;
        let number = line.last;
        let dropped: Vec<u64> = match call.overtakes {
            true => line.waiting.drain(..).map(|one| one.number).collect(),
            false => line.waiting.get(MOST_WAITING).map(|_| number).into_iter().collect(),
        };
        if !dropped.contains(&number) {
            let until = call.deadline.map(|deadline| now.saturating_add(deadline));
            line.waiting.push_back(Waiting { number, call, until, program: None, again_at: 0, count: 0 });
        }
        let dropped =
            dropped.into_iter().map(|number| Action::Answered { line: id, number, outcome: Outcome::Dropped });
        self.actions.extend(dropped);
        let next = self.pursue(id);
        self.calls_at = self.calls_at.min(next);
        number
    }

    /// Tells the hardware of a component that its user is alive, and within which time it says so again, in
    /// nanoseconds. Nothing makes up for a heartbeat that is lost.
    pub fn beat(&mut self, node: &str, component: &str, caller: &str, period: u64) {
        let Some(program) = self.program_of(node) else { return };
        let request = Request {
            program: self.settings.program,
            component: component.to_owned(),
            caller: caller.to_owned(),
            left: period,
            ..Request::default()
        };
        self.put_call(program, &request);
    }

    /// Another program answers a call.
    pub fn take_reply(&mut self, reply: Reply, now: u64) {
        self.pass(now);
        let Reply { program, line: id, number, outcome, text, bytes } = reply;
        let Some(line) = self.lines.get_mut(&id) else { return };
        let is_answered = |one: &mut Waiting| (one.number, one.program) == (number, Some(program));
        let Some(Waiting { call, .. }) = line.waiting.pop_front_if(is_answered) else { return };
        let provider = call.component;
        let outcome = match outcome {
            0 => Outcome::Reply { program, bytes },
            1 => Outcome::Refused { program, error: CallError::Busy { provider } },
            2 => Outcome::Refused { program, error: CallError::NotRunning { provider } },
            3 => Outcome::Refused { program, error: CallError::Mismatch { message: text } },
            _ => Outcome::Refused { program, error: CallError::Failed { provider, failure: Failure::new(text) } },
        };
        self.actions.push(Action::Answered { line: id, number, outcome });
        let next = self.pursue(id);
        self.calls_at = self.calls_at.min(next);
    }

    /// True if calls were put that a program which is there has not answered.
    pub fn awaits_answers(&self) -> bool {
        let is_awaited =
            |program| self.peers.get(&program).is_some_and(|peer| peer.is_awaited(self.now, self.settings.linger));
        let first = self.lines.values().filter_map(|line| line.waiting.front());
        first.filter_map(|first| first.program).any(is_awaited)
    }

    /// Puts calls that are due (again), and ends those that are late or gone.
    pub(super) fn pursue_calls(&mut self) {
        if self.now < self.calls_at {
            return;
        }
        let lines: Vec<u64> = self.lines.keys().copied().collect();
        self.calls_at = lines.into_iter().map(|line| self.pursue(line)).min().unwrap_or(u64::MAX);
    }

    /// The program of this name that is there, or the last one that was: of two the one that began last, since one that
    /// was killed is missed later than its successor is heard.
    fn program_of(&self, name: &str) -> Option<u64> {
        let named = self.peers.iter().filter(|(_, peer)| &*peer.name == name);
        named
            .max_by_key(|(_, peer)| (!peer.is_over, peer.is_reachable, peer.began, peer.since))
            .map(|(program, _)| *program)
    }

    /// Pursues the calls of a line. Gives the time at which something is due next.
    fn pursue(&mut self, id: u64) -> u64 {
        let now = self.now;
        let Some(line) = self.lines.get_mut(&id) else { return u64::MAX };
        let mut waiting = std::mem::take(&mut line.waiting);
        let mut ended = Vec::new();
        waiting.retain(|one| {
            let is_late = one.until.is_some_and(|until| until <= now);
            if is_late {
                ended.push((one.number, Outcome::Late { was_there: one.program.is_some() }));
            }
            !is_late
        });
        let mut next = waiting.iter().filter_map(|one| one.until).min().unwrap_or(u64::MAX);
        while let Some(first) = waiting.front_mut() {
            let present = self.program_of(&first.call.node);
            let meant = first.program.or(first.call.program).or(present);
            if meant.is_some() && meant != present {
                ended.push((first.number, Outcome::Gone));
                waiting.pop_front();
                continue;
            }
            let reachable = |program: &u64| self.peers.get(program).is_some_and(|peer| peer.is_reachable);
            // One that is not there is heard before anything can be put to it.
            let Some(program) = meant.filter(reachable) else { break };
            if first.again_at <= now {
                self.put_again(id, first, program);
            }
            next = next.min(first.again_at);
            break;
        }
        if let Some(line) = self.lines.get_mut(&id) {
            line.waiting = waiting;
        }
        let ended = ended.into_iter().map(|(number, outcome)| Action::Answered { line: id, number, outcome });
        self.actions.extend(ended);
        next
    }

    /// Puts a call to a program, for the first time or again.
    fn put_again(&mut self, line: u64, waiting: &mut Waiting, program: u64) {
        let Some(peer) = self.peers.get(&program) else { return };
        let call = &waiting.call;
        let request = Request {
            program: self.settings.program,
            line,
            number: waiting.number,
            component: call.component.clone(),
            service: call.service.clone(),
            operation: call.operation,
            interface: call.interface,
            caller: call.caller.clone(),
            cause: call.cause,
            sign: peer.sign,
            age: self.now.saturating_sub(peer.heard),
            left: waiting.until.map_or(LEASE, |until| until.saturating_sub(self.now)),
            arguments: call.arguments.clone(),
        };
        self.put_call(program, &request);
        waiting.program = Some(program);
        waiting.again_at = self.now + (FIRST_PAUSE << waiting.count.min(10)).min(LONGEST_PAUSE);
        waiting.count += 1;
    }

    fn put_call(&mut self, program: u64, request: &Request) {
        let (to, bytes) = (Destination::Call(program), cdr::encode(request).into());
        self.actions.push(Action::Put { to, bytes });
    }
}
