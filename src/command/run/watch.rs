//! What of a run is shown and kept while it happens.

use std::sync::Arc;
use std::time::Duration;

use saoms_api::{Level, TopicDeclaration};
use saoms_core::schedule::{Event, Events, Progress, Sent};

use super::console::Console;
use crate::paths::Paths;

/// The console and, where a picture is asked for, what it will show.
pub(crate) struct Watch {
    pub(crate) console: Console,
    pub(crate) paths: Option<Arc<Paths>>,
}

impl Events for Watch {
    fn event(&self, event: &Event) {
        self.console.event(event);
    }

    fn log_level(&self) -> Option<Level> {
        self.console.log_level()
    }

    fn wants_console(&self) -> bool {
        self.console.wants_console()
    }

    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        self.paths.as_ref().is_some_and(|paths| paths.wants_topic(name, declared))
    }

    fn message(&self, sent: &Sent) {
        if let Some(paths) = &self.paths {
            paths.message(sent);
        }
    }

    fn progress_every(&self) -> Option<Duration> {
        self.console.progress_every()
    }

    fn progress(&self, progress: &Progress) {
        self.console.progress(progress);
    }
}
