//! Answers from the tape.

use std::cell::RefCell;
use std::collections::{HashMap, VecDeque};

use saoms_api::host::Operation;

use crate::tape::{Act, ActKind, Step, StepKind};

/// The answers to what a component asks of its host.
#[derive(Default)]
pub(super) struct Answers {
    /// The last answer to each question.
    known: HashMap<(ActKind, u64, String), Vec<u8>>,
    /// The readings of what may be another one each time: time, date, and whether to end early.
    readings: [RefCell<Reading>; 3],
}

/// What is read several times in a step.
#[derive(Default)]
struct Reading {
    /// The number of the next reading.
    next: u64,
    present: Vec<u8>,
    /// Those that differ from the one before, by their numbers.
    later: VecDeque<(u64, Vec<u8>)>,
}

const READ: [ActKind; 3] = [ActKind::Now, ActKind::Date, ActKind::Cancelled];

impl Answers {
    /// Takes in the answers of a step.
    pub(super) fn begin(&mut self, step: &Step) {
        if step.kind == StepKind::Start {
            *self = Answers::default();
        }
        for reading in &mut self.readings {
            let reading = reading.get_mut();
            reading.next = 0;
            // Of the step before all were read, by the code of then.
            if let Some((_, last)) = reading.later.drain(..).next_back() {
                reading.present = last;
            }
        }
        self.readings[0].get_mut().present = step.time.to_le_bytes().to_vec();
        for act in step.acts.iter().filter(|act| !act.what.is_deed()) {
            match READ.iter().position(|read| *read == act.what) {
                Some(place) => self.readings[place].get_mut().later.push_back((act.other, act.bytes.clone())),
                None => {
                    self.known.insert((act.what, act.number, act.name.clone()), act.bytes.clone());
                }
            }
        }
    }

    /// The next reading of time, date, or whether to end early.
    pub(super) fn read(&self, what: ActKind) -> Vec<u8> {
        let place = READ.iter().position(|read| *read == what).unwrap_or_default();
        let mut reading = self.readings[place].borrow_mut();
        let next = reading.next;
        while reading.later.front().is_some_and(|(number, _)| *number <= next) {
            reading.present = reading.later.pop_front().map(|(_, later)| later).unwrap_or_default();
        }
        reading.next += 1;
        reading.present.clone()
    }

    /// The answer to a question; none where the tape has none.
    pub(super) fn known(&self, what: ActKind, number: u64, name: &str) -> Option<&[u8]> {
        self.known.get(&(what, number, name.to_owned())).map(Vec::as_slice)
    }

    pub(super) fn yes(&self, what: ActKind, number: u64) -> bool {
        self.known(what, number, "").is_some_and(|bytes| bytes.first().is_some_and(|byte| *byte != 0))
    }
}

/// The calls that the component made on the tape, with their answers.
#[derive(Default)]
pub(super) struct Calls {
    /// Those of the present step; one that is answered again is marked.
    present: Vec<(Act, Act, bool)>,
    /// The newest answer of each operation of a reference before.
    before: HashMap<(u64, u64), Act>,
}

impl Calls {
    /// Takes in the calls of a step.
    pub(super) fn begin(&mut self, step: &Step) {
        for (called, answer, _) in self.present.drain(..) {
            self.before.insert((called.number, called.other), answer);
        }
        let mut acts = step.acts.iter();
        while let Some(called) = acts.by_ref().find(|act| act.what == ActKind::Called) {
            if let Some(answer) = acts.as_slice().first().filter(|act| act.what == ActKind::Answer) {
                self.present.push((called.clone(), answer.clone(), false));
            }
        }
    }

    /// The answer to a call: that to the same call in this step; else to one of the same operation with other arguments
    /// in it; else the last one before.
    pub(super) fn answer(&mut self, reference: u32, operation: Operation, arguments: &[u8]) -> Option<Act> {
        let key = (u64::from(reference), u64::from(operation));
        let is_it = |called: &Act| (called.number, called.other) == key;
        let place =
            self.present.iter().position(|(called, _, taken)| !taken && is_it(called) && called.bytes == arguments);
        let place = place.or_else(|| self.present.iter().position(|(called, _, taken)| !taken && is_it(called)));
        match place {
            Some(place) => {
                self.present[place].2 = true;
                Some(self.present[place].1.clone())
            }
            None => {
                let last = self.present.iter().rev().find(|(called, ..)| is_it(called)).map(|(_, answer, _)| answer);
                last.or_else(|| self.before.get(&key)).cloned()
            }
        }
    }
}
