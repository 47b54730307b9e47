use std::mem;

use super::extras::Writable;
use crate::{Context, Failure, Knowledge, Value};

/// The entries of a knowledge before a loop acts, to find its changes. The memory is reused.
#[derive(Debug, Default)]
pub struct Snapshot {
    before: Vec<Value>,
    after: Vec<Value>,
    writable: Writable,
    is_disabled: bool,
}

impl Snapshot {
    /// A snapshot that stays empty, for the loops of a plugin: the host compares the entries.
    pub(crate) fn disabled() -> Snapshot {
        Snapshot { is_disabled: true, ..Snapshot::default() }
    }

    /// Sets the entries that the next loop may change.
    pub(crate) fn permit(&mut self, writable: Writable) {
        self.writable = writable;
    }

    /// Takes the entries as they are.
    pub fn take(&mut self, knowledge: &dyn Knowledge) {
        self.before.clear();
        if !self.is_disabled {
            knowledge.values(&mut self.before);
        }
    }

    /// Writes to the journal what has changed since it was taken.
    ///
    /// # Errors
    /// An entry is an effector that the loop does not declare to change.
    pub fn record(&mut self, knowledge: &dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.is_disabled {
            return Ok(());
        }
        let mut after = mem::take(&mut self.after);
        after.clear();
        knowledge.values(&mut after);
        let mut result = Ok(());
        for (place, (before, after)) in self.before.iter().zip(&after).enumerate() {
            if before.is_same(*after) {
                continue;
            }
            let Some(entry) = knowledge.all_declared().nth(place) else { continue };
            context.changed(entry.name, *before, *after);
            if entry.effector && !self.writable.has(entry.name) {
                result = Err(Failure::new(format!(
                    "it changed the effector `{0}`, which it does not declare: write `effects(\"{0}\")`",
                    entry.name
                )));
            }
        }
        self.after = after;
        result
    }
}
