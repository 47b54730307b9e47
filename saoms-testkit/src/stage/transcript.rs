//! What a component did on a [`Bench`](crate::Bench), for people.

use std::fmt::Write as _;

use saoms_api::host::SharedMessage;
use saoms_api::{Level, Work};

use super::Stage;

/// An action of a component.
pub(crate) enum Action {
    /// A message that it sent as the publisher with this index.
    Sent(usize, SharedMessage),
    Log(Level, String),
    Console(String),
    Journal(String),
    Report(String),
    Work(Work),
    /// An event that it raised.
    Raised(String),
    /// The execution was skipped, because the component of this name was busy.
    Skipped(String),
}

impl Stage {
    pub(crate) fn transcript(&self) -> String {
        let mut text = String::new();
        for (time, what) in &self.actions {
            let _ = write!(text, "{:8.3} s  ", time.as_nanos() as f64 / 1e9);
            let _ = match what {
                Action::Sent(place, message) => {
                    let taken = &self.publishers[*place];
                    let shown = taken.schema.as_ref().and_then(|schema| schema.decode(message.bytes()).ok());
                    let shown = shown.map_or_else(|| "bytes that are no message".to_owned(), |json| json.to_string());
                    writeln!(text, "sends {} {shown}", taken.name)
                }
                Action::Log(level, line) => writeln!(text, "{}: {line}", level_name(*level)),
                Action::Console(line) => writeln!(text, "console: {line}"),
                Action::Journal(line) => writeln!(text, "{line}"),
                Action::Report(line) => writeln!(text, "report: {line}"),
                Action::Work(Work::Open) => writeln!(text, "has work left"),
                Action::Work(Work::Done) => writeln!(text, "has no work left"),
                Action::Work(Work::GivenUp) => writeln!(text, "gave up work"),
                Action::Raised(event) => writeln!(text, "raises {event}"),
                Action::Skipped(provider) => writeln!(text, "skipped: component `{provider}` is busy"),
            };
        }
        text
    }
}

const fn level_name(level: Level) -> &'static str {
    match level {
        Level::Error => "error",
        Level::Warning => "warning",
        Level::Info => "info",
        Level::Debug => "debug",
    }
}
