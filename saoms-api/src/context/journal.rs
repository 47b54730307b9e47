//! What a component writes to the journal.

use crate::host::Phase;
use crate::{Cause, Context, Record, Value};

impl Context<'_> {
    /// Tells what follows from what: the next symptom of the present loop comes from this, such as from the
    /// [cause](crate::Header::cause) of a message. In a component without loops, all that it writes and sends from here
    /// on does, until the next `because` or the end of the execution.
    pub fn because(&mut self, cause: Cause) {
        self.host.because(cause);
    }

    /// The cause that a message sent now would carry: the newest record of the present loop in this execution. If there
    /// is none yet, the cause set by [`because`](Context::because), so that a component that only passes a message on
    /// keeps the chain of causes.
    pub fn cause(&self) -> Cause {
        self.host.cause()
    }

    /// Writes to the journal what a component without loops saw: the beginning of a chain, such as an event that no
    /// other component caused, or what it makes of a message that it named with [`because`](Context::because). The
    /// findings of loops are written automatically.
    ///
    /// Each call is a record: write changes, and not the state in each execution.
    pub fn symptom(&mut self, record: Record) {
        self.host.journal(Phase::Symptom, &record);
    }

    /// Writes to the journal what a component without loops decided, because of its last [`symptom`](Context::symptom).
    /// The decisions of loops are written by themselves.
    pub fn decision(&mut self, record: Record) {
        self.host.journal(Phase::Decision, &record);
    }

    /// Writes to the journal what the present loop, or a component without loops, did, beyond the entries of the
    /// knowledge that it changed: those are written by themselves.
    pub fn effect(&mut self, record: Record) {
        self.host.journal(Phase::Effect, &record);
    }

    pub(crate) fn journal(&mut self, phase: Phase, record: &Record) {
        self.host.journal(phase, record);
    }

    /// Writes to the journal that an entry of the knowledge changed by itself, such as a measured level. What a loop
    /// changes in its plan and execution is written by itself.
    pub fn changed(&mut self, entry: &'static str, before: impl Into<Value>, after: impl Into<Value>) {
        self.host.changed(entry, before.into(), after.into());
    }

    pub(crate) fn enter_loop(&mut self, place: u32) {
        self.host.enter_loop(Some(place));
    }

    pub(crate) fn name_loop(&mut self, place: u32, name: &str) {
        self.host.name_loop(place, name);
    }

    pub(crate) fn leave_loops(&mut self) {
        self.host.enter_loop(None);
    }
}
