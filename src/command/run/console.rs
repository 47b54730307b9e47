//! The observer that shows what happens in a fleet, and a summary at the end.

use std::path::PathBuf;
use std::time::Duration;

use saoms_api::Level;
use saoms_api::host::one_line;
use saoms_core::observe::{Interest, Observer, Occurrence, RunEvent, RunProgress};
use saoms_core::report::{RunReport, RunStatus};

use super::log_lines::{LogFormat, LogStyle};
use super::status_line::StatusLine;
use super::summary::{ending, summary};
use super::{ConsoleStyle, RunArguments};
use crate::output::{Place, eprint, print};

/// The console of a run.
pub(crate) struct Console {
    verbosity: Verbosity,
    style: LogStyle,
    /// True if a file keeps all records of the journal.
    keeps_all: bool,
    /// The line below the others, on a terminal.
    status: Option<StatusLine>,
    /// Writes the log and the summary: to standard output, or to standard error where an output of its own, such as
    /// the report, has standard output.
    write: fn(&str),
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
    pub(crate) fn new(arguments: &RunArguments, style: LogStyle) -> Console {
        let verbosity = match arguments.console {
            _ if arguments.quiet => Verbosity::Quiet,
            ConsoleStyle::Plain => Verbosity::Plain,
            ConsoleStyle::Classic => Verbosity::Classic,
        };
        let outputs =
            [&arguments.report, &arguments.paths, &arguments.timeline, &arguments.journal, &arguments.log.log];
        let is_standard = |path: &PathBuf| Place::of(path).is_ok_and(|place| place.is_standard_output());
        let write = if outputs.into_iter().flatten().any(is_standard) { eprint } else { print };
        if verbosity == Verbosity::Classic {
            write("Starting...\n");
        }
        let style = if verbosity == Verbosity::Classic { style.plain() } else { style };
        let has_status = verbosity == Verbosity::Plain && style.format == LogFormat::Plain;
        let status = if has_status { StatusLine::on_terminal() } else { None };
        Console { verbosity, style, keeps_all: arguments.journal.is_some(), status, write }
    }

    fn line(&self, text: &str) {
        match &self.status {
            Some(status) => status.above(|| (self.write)(text)),
            None => (self.write)(text),
        }
    }
}

impl Observer for Console {
    fn event(&self, event: &RunEvent) {
        let level = event.what.level();
        match (self.verbosity, &event.what) {
            (Verbosity::Classic, Occurrence::Console { text }) => (self.write)(&format!("{}\n", one_line(text))),
            (_, Occurrence::Console { .. }) => {}
            (Verbosity::Quiet, _) if level == Level::Error => eprint(&self.style.line(event)),
            (Verbosity::Classic, _) if level <= Level::Warning => eprint(&self.style.line(event)),
            (Verbosity::Plain, _) if level <= self.style.level => self.line(&self.style.line(event)),
            _ => {}
        }
    }

    fn interest(&self) -> Interest {
        let log = match self.verbosity {
            Verbosity::Quiet => Level::Error,
            Verbosity::Classic => Level::Warning,
            Verbosity::Plain => self.style.level,
        };
        Interest {
            log: Some(log),
            console: self.verbosity == Verbosity::Classic,
            samples: None,
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
        match (self.verbosity, self.style.format) {
            // Who reads errors alone is told of an end that is one.
            (Verbosity::Quiet, format) => match (report.outcome.status, format) {
                (RunStatus::Incomplete | RunStatus::Failed, LogFormat::Plain) => eprint(&ending(report)),
                (RunStatus::Incomplete | RunStatus::Failed, LogFormat::Json) => eprint(&self.style.end(report)),
                _ => {}
            },
            (_, LogFormat::Plain) => (self.write)(&summary(report, self.keeps_all)),
            (_, LogFormat::Json) => (self.write)(&self.style.end(report)),
        }
    }
}
