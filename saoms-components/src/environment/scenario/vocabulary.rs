use saoms_api::event::Events;
use saoms_api::event::fault::FAULTS;

use super::event::KINDS;

/// The events that lines of a scenario can have.
#[derive(Clone, Copy, Debug)]
pub(in crate::environment) struct Vocabulary<'a> {
    /// The words of the language that the class plays; `None` for all of them.
    plays: Option<&'a [String]>,
    /// The events that classes take; `None` where they are not known, and any may be one.
    events: Option<&'a Events>,
}

impl<'a> Vocabulary<'a> {
    /// All events of the language, and any of classes.
    pub(in crate::environment) const ANY: Vocabulary<'static> = Vocabulary { plays: None, events: None };

    /// All events of the language, and these.
    pub(in crate::environment) fn with(events: &'a Events) -> Vocabulary<'a> {
        Vocabulary { plays: None, events: Some(events) }
    }

    /// The same, with these events of the language alone.
    pub(super) fn playing(self, plays: &'a [String]) -> Vocabulary<'a> {
        Vocabulary { plays: Some(plays), ..self }
    }

    pub(super) fn plays(self, word: &str) -> bool {
        self.plays.is_none_or(|plays| plays.iter().any(|one| one == word))
    }

    pub(super) fn events(self) -> Option<&'a Events> {
        self.events
    }

    /// All names of events that are known.
    pub(in crate::environment) fn names(self) -> impl Iterator<Item = &'a str> {
        let own = KINDS.into_iter().filter(move |word| self.plays(word));
        own.chain(self.events.into_iter().flat_map(Events::names))
    }

    /// These names and the words of faults, which each fleet plays, for messages.
    pub(super) fn expected(self) -> String {
        let mut names: Vec<String> = self.names().chain(FAULTS).map(|name| format!("`{name}`")).collect();
        match names.pop() {
            Some(last) if !names.is_empty() => format!("{} or {last}", names.join(", ")),
            Some(only) => only,
            None => "an event".to_owned(),
        }
    }
}
