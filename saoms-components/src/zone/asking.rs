use std::collections::BTreeSet;

use saoms_api::{Context, KnownPublisher};

use crate::messages::GRANT_REQUEST;

/// Number of executions after which the zone asks again.
const REPEAT: u64 = 4;

/// Number of executions after which a zone says for whom it waits, and asks less often.
const LONG: u64 = 20;

/// The same as [`REPEAT`] from then on, for a zone that grants nothing: each time all robots answer.
const ASK_AGAIN: u64 = 40;

/// The question to all robots where they are, since a zone began a term.
#[derive(Debug)]
pub(super) struct Asking {
    /// Components whose robots have answered.
    heard: BTreeSet<u32>,
    /// Robots that somebody took off the floor meanwhile.
    gone: BTreeSet<u32>,
    /// Number of executions since it was put.
    executions: u64,
    /// True if somebody has answered, or is gone, since it was looked who has not.
    is_changed: bool,
}

impl Default for Asking {
    fn default() -> Asking {
        Asking { heard: BTreeSet::new(), gone: BTreeSet::new(), executions: 0, is_changed: true }
    }
}

impl Asking {
    /// A robot has answered.
    pub(super) fn note_heard(&mut self, component: u32) {
        self.is_changed |= self.heard.insert(component);
    }

    /// Somebody took a robot off the floor.
    pub(super) fn note_gone(&mut self, robot: u32) {
        self.is_changed |= self.gone.insert(robot);
    }

    /// The components whose robots have not answered, of those that were ever scheduled; `None` while it need not be
    /// looked, since all publishers have to be: nobody has answered, and the question is not due.
    pub(super) fn unheard(&mut self, context: &Context<'_>, is_due: bool) -> Option<Vec<KnownPublisher>> {
        if !(std::mem::take(&mut self.is_changed) || is_due || self.has_become_long()) {
            return None;
        }
        let begun = context.publishers(&GRANT_REQUEST).into_iter().filter(|publisher| publisher.has_begun);
        let is_gone = |number: Option<u32>| number.is_some_and(|robot| self.gone.contains(&robot));
        Some(begun.filter(|one| !self.heard.contains(&one.sender) && !is_gone(one.number)).collect())
    }

    /// Counts an execution. True if the question is to be put again. A zone that grants does so ever more rarely: the
    /// blocks of a robot that does not answer stay held, and a fleet has to be quiet at last.
    pub(super) fn is_due(&mut self, grants: bool) -> bool {
        let number = self.executions;
        self.executions += 1;
        match number {
            ..=LONG => number.is_multiple_of(REPEAT),
            _ if grants => number.is_power_of_two(),
            _ => number.is_multiple_of(ASK_AGAIN),
        }
    }

    /// True once, in the first execution in which it is put again.
    pub(super) fn has_lasted(&self) -> bool {
        self.executions == REPEAT
    }

    /// True once, in the execution after which it has lasted for long.
    pub(super) fn has_become_long(&self) -> bool {
        self.executions == LONG + 1
    }
}
