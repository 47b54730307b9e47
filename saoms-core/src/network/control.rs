//! What operators ask the programs of a network, and what these answer.
//!
//! A request is for all programs, or for one. It is carried out once, however often it arrives: who asks repeats it
//! until the answer is there, and says how much of that it has.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use saoms_api::Message;

use super::port::{FromRun, Port};

/// Time after which nobody waits for an answer any more, unless the request is repeated, in nanoseconds.
const FORGOTTEN_AFTER: u64 = 10_000_000_000;
/// Requests that are known at once, and that are not carried out again, at most.
const MOST: usize = 64;
const MOST_DONE: usize = 4_096;
/// Parts of an answer that are kept until they were received, at most.
const MOST_PARTS: usize = 1_024;

/// A request to the programs of a network.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Ask")]
pub struct Ask {
    /// Who asks: a number that nobody else has.
    pub asker: u64,
    /// The number of the request among those of the asker.
    pub number: u64,
    /// The program that is asked; 0 is all.
    pub to: u64,
    /// The number of parts of the answer that the asker has.
    pub have: u32,
    /// The method, as `GET`.
    pub method: String,
    /// The path, as `/v1/status`.
    pub path: String,
    /// The body.
    pub body: String,
}

/// A part of the answer to a request.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Answer")]
pub struct Answer {
    /// The program that answers.
    pub program: u64,
    /// Its name for people: the node, or the name of its composite.
    pub name: String,
    /// The number of the request.
    pub number: u64,
    /// The number of this part, from 0.
    pub part: u32,
    /// The status, as in HTTP.
    pub status: u32,
    /// True if no other part follows.
    pub is_last: bool,
    /// The other programs that this one knows, whether they give signs of life or not.
    pub others: Vec<Other>,
    /// The text of this part.
    pub body: String,
}

/// A program that another one knows.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Other")]
pub struct Other {
    /// The program.
    pub program: u64,
    /// Its name for people.
    pub name: String,
}

/// A request to the fleet of this program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ControlRequest {
    /// The method, as `GET`.
    pub method: String,
    /// The path, as `/v1/status`.
    pub path: String,
    /// The body.
    pub body: String,
}

/// Where the answer to a request goes.
#[derive(Clone, Debug)]
pub struct Reply {
    pub(super) port: Arc<Port>,
    asker: u64,
    number: u64,
    is_wanted: Arc<AtomicBool>,
}

impl Reply {
    /// Sends a part of the answer. False: nobody waits for it any more.
    pub fn part(&self, status: u16, body: String, is_last: bool) -> bool {
        let is_wanted = self.is_wanted();
        if is_wanted {
            let answer = Answer { number: self.number, status: status.into(), is_last, body, ..Answer::default() };
            self.port.put(std::iter::once(FromRun::Answer { asker: self.asker, answer }));
        }
        is_wanted
    }

    /// True while somebody waits for the answer.
    pub fn is_wanted(&self) -> bool {
        self.is_wanted.load(Ordering::Relaxed)
    }
}

/// What a program has to do for a request that arrived.
#[derive(Debug)]
pub(super) enum Asked {
    /// Carry it out.
    New(ControlRequest, Reply),
    /// Send these parts of its answer again.
    Again(Vec<Answer>),
}

/// The requests to a program.
#[derive(Debug, Default)]
pub(super) struct Requests {
    open: BTreeMap<(u64, u64), Open>,
    /// Those that were carried out and forgotten.
    done: VecDeque<(u64, u64)>,
}

#[derive(Debug)]
struct Open {
    heard: u64,
    is_wanted: Arc<AtomicBool>,
    /// The number of the next part of the answer.
    next: u32,
    /// Parts that may not have been received.
    kept: VecDeque<Answer>,
}

impl Requests {
    /// Takes a request that arrived at a program.
    pub(super) fn take(&mut self, ask: Ask, program: u64, port: &Arc<Port>, now: u64) -> Option<Asked> {
        let Ask { asker, number, to, have, method, path, body } = ask;
        if to != 0 && to != program || self.done.contains(&(asker, number)) {
            return None;
        }
        if let Some(open) = self.open.get_mut(&(asker, number)) {
            open.heard = now;
            if to == program {
                while open.kept.pop_front_if(|answer| answer.part < have).is_some() {}
            }
            return Some(Asked::Again(open.kept.iter().cloned().collect()));
        }
        if self.open.len() >= MOST {
            return None;
        }
        let is_wanted = Arc::new(AtomicBool::new(true));
        let reply = Reply { port: Arc::clone(port), asker, number, is_wanted: Arc::clone(&is_wanted) };
        self.open.insert((asker, number), Open { heard: now, is_wanted, next: 0, kept: VecDeque::new() });
        Some(Asked::New(ControlRequest { method, path, body }, reply))
    }

    /// Numbers a part of an answer, and keeps it; `None` if nobody waits for it any more.
    pub(super) fn answer(
        &mut self,
        asker: u64,
        answer: Answer,
        (program, name): (u64, &str),
        others: Vec<Other>,
    ) -> Option<Answer> {
        let open = self.open.get_mut(&(asker, answer.number))?;
        let answer = Answer { program, name: name.to_owned(), part: open.next, others, ..answer };
        open.next += 1;
        if open.kept.len() >= MOST_PARTS {
            open.kept.pop_front();
        }
        open.kept.push_back(answer.clone());
        Some(answer)
    }

    /// Forgets requests whose askers are gone.
    pub(super) fn forget(&mut self, now: u64) {
        for (key, open) in self.open.extract_if(.., |_, open| now.saturating_sub(open.heard) > FORGOTTEN_AFTER) {
            open.is_wanted.store(false, Ordering::Relaxed);
            if self.done.len() >= MOST_DONE {
                self.done.pop_front();
            }
            self.done.push_back(key);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROGRAM: u64 = 7;

    fn ask(to: u64, have: u32) -> Ask {
        Ask { asker: 1, number: 2, to, have, path: "/v1/status".to_owned(), ..Ask::default() }
    }

    fn part(body: &str, is_last: bool) -> Answer {
        Answer { number: 2, status: 200, body: body.to_owned(), is_last, ..Answer::default() }
    }

    #[test]
    fn a_request_is_carried_out_once_and_its_answer_sent_until_it_is_there() {
        let (mut requests, port) = (Requests::default(), Arc::<Port>::default());
        assert!(requests.take(ask(8, 0), PROGRAM, &port, 0).is_none(), "it is for another program");
        let Some(Asked::New(_, reply)) = requests.take(ask(0, 0), PROGRAM, &port, 0) else { panic!("it is new") };
        for (number, body) in (0..).zip(["a", "b", "c"]) {
            let answer = requests.answer(1, part(body, body == "c"), (PROGRAM, "hall"), Vec::new()).unwrap();
            assert_eq!((answer.part, answer.program), (number, PROGRAM));
        }
        let again = |requests: &mut Requests, to, have| match requests.take(ask(to, have), PROGRAM, &port, 1_000) {
            Some(Asked::Again(parts)) => parts.iter().map(|one| one.body.clone()).collect::<String>(),
            _ => panic!("it is known"),
        };
        assert_eq!(again(&mut requests, 0, 0), "abc");
        assert_eq!(again(&mut requests, PROGRAM, 2), "c");
        assert_eq!(again(&mut requests, PROGRAM, 3), "");
        requests.forget(FORGOTTEN_AFTER);
        assert!(reply.is_wanted());
        requests.forget(FORGOTTEN_AFTER + 2_000);
        assert!(!reply.part(200, String::new(), true));
        assert!(requests.take(ask(0, 0), PROGRAM, &port, 0).is_none(), "a late copy of it");
    }
}
