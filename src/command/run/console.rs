//! The observer that shows what happens in a fleet, and a summary at the end.

use std::borrow::Cow;
use std::time::Duration;

use saoms_api::Level;
use saoms_api::host::one_line;
use saoms_core::observe::{Interest, Observer, Occurrence, RunEvent, RunProgress};
use saoms_core::report::RunReport;
use saoms_lang::assembly::Assembly;

use super::status_line::StatusLine;
use super::summary::summary;
use super::{ConsoleStyle, RunArguments};
use crate::output::{eprint, print};

/// The least and the greatest width of the column with the names of components.
const NAMES: (usize, usize) = (14, 32);

/// The console of a run.
pub(crate) struct Console {
    verbosity: Verbosity,
    /// The width of the column with the names of components.
    width: usize,
    /// True if a file keeps all records of the journal.
    keeps_all: bool,
    /// The line below the others, on a terminal.
    status: Option<StatusLine>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Verbosity {
    /// Errors alone, on standard error.
    Quiet,
    /// A line per event, with time and component.
    Plain,
    /// The lines that the original's components wrote; warnings and errors on standard error.
    Classic,
}

impl Console {
    /// The console that the command line asks for.
    pub(crate) fn new(arguments: &RunArguments, assembly: &Assembly) -> Console {
        let verbosity = match arguments.console {
            _ if arguments.quiet => Verbosity::Quiet,
            ConsoleStyle::Plain => Verbosity::Plain,
            ConsoleStyle::Classic => Verbosity::Classic,
        };
        if verbosity == Verbosity::Classic {
            print("Starting...\n");
        }
        let status = if verbosity == Verbosity::Plain { StatusLine::on_terminal() } else { None };
        let names = assembly.components.iter().map(|component| one_line(&component.path).chars().count());
        let width = names.max().unwrap_or(0).clamp(NAMES.0, NAMES.1);
        Console { verbosity, width, keeps_all: arguments.journal.is_some(), status }
    }

    fn line(&self, text: &str) {
        match &self.status {
            Some(status) => status.above(|| print(text)),
            None => print(text),
        }
    }
}

impl Observer for Console {
    fn event(&self, event: &RunEvent) {
        let level = event.what.level();
        match (self.verbosity, &event.what) {
            (Verbosity::Classic, Occurrence::Console { text }) => print(&format!("{}\n", one_line(text))),
            (_, Occurrence::Console { .. }) => {}
            (Verbosity::Quiet, _) if level == Level::Error => eprint(&plain(event, self.width)),
            (Verbosity::Classic, _) if level <= Level::Warning => eprint(&plain(event, self.width)),
            (Verbosity::Plain, _) if level <= Level::Info => self.line(&plain(event, self.width)),
            _ => {}
        }
    }

    fn interest(&self) -> Interest {
        let log = match self.verbosity {
            Verbosity::Quiet => Level::Error,
            Verbosity::Classic => Level::Warning,
            Verbosity::Plain => Level::Info,
        };
        Interest {
            log: Some(log),
            console: self.verbosity == Verbosity::Classic,
            progress: self.status.as_ref().map(|_| Duration::from_millis(100)),
            journal: false,
        }
    }

    fn progress(&self, progress: &RunProgress) {
        if let Some(status) = &self.status {
            let RunProgress { time, periods, summaries } = progress;
            let summaries: String = summaries.iter().map(|summary| format!(" · {}", one_line(summary))).collect();
            status.set(format!("{time} · {periods} executions{summaries}"));
        }
    }

    fn end(&self, report: &RunReport) {
        if let Some(status) = &self.status {
            status.clear();
        }
        if self.verbosity != Verbosity::Quiet {
            print(&summary(report, self.keeps_all));
        }
    }
}

/// An event as one line: when, who, what.
fn plain(event: &RunEvent, width: usize) -> String {
    let mark = match event.what.level() {
        Level::Error => "error: ",
        Level::Warning => "warning: ",
        Level::Info | Level::Debug => "",
    };
    let who = one_line(event.component.as_deref().unwrap_or("fleet"));
    let what = event.what.to_string();
    let what = match event.what {
        // It shows the line of an event below.
        Occurrence::Note { .. } => Cow::Borrowed(what.as_str()),
        _ => one_line(&what),
    };
    format!("{:>11}  {who:<width$} {mark}{what}\n", event.time.to_string())
}
