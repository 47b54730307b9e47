//! Shows what happens in a fleet while it happens.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use saoms_api::Level;
use saoms_core::schedule::{Event, Events, Occurrence, Progress};
use saoms_lang::assembly::Assembly;

use super::{ConsoleStyle, RunArguments};
use crate::output::{eprint, print};

/// How narrow and how wide the column with the names of components may be.
const NAMES: (usize, usize) = (14, 32);

/// What of the events is shown, and how.
pub(crate) struct Console {
    shown: Shown,
    /// The width of the column with the names of components.
    width: usize,
    /// On a terminal, the line below the others that says how far the run is.
    bar: Option<ProgressBar>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Shown {
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
        let shown = match arguments.console {
            _ if arguments.quiet => Shown::Quiet,
            ConsoleStyle::Plain => Shown::Plain,
            ConsoleStyle::Classic => Shown::Classic,
        };
        if shown == Shown::Classic {
            print("Starting...\n");
        }
        let on_terminal = std::io::stdout().is_terminal() && std::io::stderr().is_terminal();
        let bar = (shown == Shown::Plain && on_terminal).then(|| {
            let style = ProgressStyle::with_template("{spinner} {msg}");
            ProgressBar::new_spinner().with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
        });
        let names = assembly.components.iter().map(|component| component.path.chars().count());
        let width = names.max().unwrap_or(0).clamp(NAMES.0, NAMES.1);
        Console { shown, width, bar }
    }

    fn line(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| print(text)),
            None => print(text),
        }
    }
}

impl Drop for Console {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Events for Console {
    fn event(&self, event: &Event) {
        let level = event.what.level();
        match (self.shown, &event.what) {
            (Shown::Classic, Occurrence::Console { text }) => print(&format!("{text}\n")),
            (_, Occurrence::Console { .. }) => {}
            (Shown::Quiet, _) if level == Level::Error => eprint(&plain(event, self.width)),
            (Shown::Classic, _) if level <= Level::Warning => eprint(&plain(event, self.width)),
            (Shown::Plain, _) if level <= Level::Info => self.line(&plain(event, self.width)),
            _ => {}
        }
    }

    fn log_level(&self) -> Option<Level> {
        Some(match self.shown {
            Shown::Quiet => Level::Error,
            Shown::Classic => Level::Warning,
            Shown::Plain => Level::Info,
        })
    }

    fn wants_console(&self) -> bool {
        self.shown == Shown::Classic
    }

    fn progress_every(&self) -> Option<Duration> {
        self.bar.as_ref().map(|_| Duration::from_millis(100))
    }

    fn progress(&self, progress: &Progress) {
        if let Some(bar) = &self.bar {
            let Progress { time, periods, requested, delivered } = progress;
            let luggage = match requested {
                0 => String::new(),
                _ => format!(" · {delivered} of {requested} pieces of luggage delivered"),
            };
            bar.set_message(format!("{time} · {periods} executions{luggage}"));
            bar.tick();
        }
    }
}

/// An event as one line: when, who, what.
fn plain(event: &Event, width: usize) -> String {
    let mark = match event.what.level() {
        Level::Error => "error: ",
        Level::Warning => "warning: ",
        Level::Info | Level::Debug => "",
    };
    let who = event.component.as_deref().unwrap_or("fleet");
    format!("{:>11}  {who:<width$} {mark}{}\n", event.time.to_string(), event.what)
}
