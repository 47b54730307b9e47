//! Events that a component raised and nobody takes: each is told once in an execution, and the rest is counted.

use saoms_api::Level;

use super::host::ComponentHost;
use crate::observe::Occurrence;

/// Greatest number of events that are told by name in one execution.
const MAX_NAMES: usize = 16;

/// The events without a receiver that the present code raised, by name, with how many of them were not told.
#[derive(Debug, Default)]
pub(crate) struct Unheard {
    named: Vec<(String, u32)>,
    others: u32,
}

impl Unheard {
    /// Notes an event of this name. True if it is the first one, which is told at once.
    fn note(&mut self, name: &str) -> bool {
        if let Some((_, untold)) = self.named.iter_mut().find(|(known, _)| known == name) {
            *untold += 1;
            return false;
        }
        let has_room = self.named.len() < MAX_NAMES;
        match has_room {
            true => self.named.push((name.to_owned(), 0)),
            false => self.others += 1,
        }
        has_room
    }

    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.named.is_empty()
    }
}

impl ComponentHost<'_> {
    /// Tells that nobody takes an event, or counts it where this was told.
    pub(super) fn has_no_receiver(&mut self, name: &str, event: &str) {
        if self.part.spent.has_line() && self.part.unheard.note(name) {
            self.warn(format!("the event `{event}` has no receiver: no component that takes it runs in this site"));
        }
    }

    /// Tells how many more there were, once the code has returned.
    #[cold]
    pub(super) fn tell_unheard(&mut self) {
        let Unheard { named, others } = std::mem::take(&mut self.part.unheard);
        for (name, untold) in named.into_iter().filter(|(_, untold)| *untold > 0) {
            self.warn(format!("{untold} more events `{name}` have no receiver"));
        }
        if others > 0 {
            self.warn(format!("{others} more events of other names have no receiver"));
        }
    }

    fn warn(&self, text: String) {
        self.emit(Occurrence::Log { level: Level::Warning, text });
    }
}
