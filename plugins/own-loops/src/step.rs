//! What a loop found, and what it does about it.

use saoms_api::{Record, Recordable};

/// A symptom that leads to one action.
pub struct Step<A> {
    why: Record,
    what: Record,
    act: A,
}

/// The decision to act.
pub struct Decision<A> {
    what: Record,
    /// What to do.
    pub(crate) act: A,
}

impl<A> Step<A> {
    pub(crate) fn new(why: Record, what: Record, act: A) -> Step<A> {
        Step { why, what, act }
    }

    pub(crate) fn decide(self) -> Decision<A> {
        Decision { what: self.what, act: self.act }
    }
}

impl<A> Recordable for Step<A> {
    fn record(&self) -> Record {
        self.why
    }
}

impl<A> Recordable for Decision<A> {
    fn record(&self) -> Record {
        self.what
    }
}
