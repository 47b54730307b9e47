//! What a component tells people: the log, alerts and the report.

use std::fmt;

use crate::{Context, ReportValue, Work};

/// Severity of a log line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Something that the operator has to look at.
    Error,
    /// Something unexpected that the component could handle.
    Warning,
    /// Normal events, for an operator.
    Info,
    /// Details, for finding faults.
    Debug,
}

impl Context<'_> {
    /// Writes a line to the log, with the time and the component's name. Formatted only if an observer wants it:
    /// [`info!`](crate::info) and [`warn!`](crate::warn) take a text with values in it.
    pub fn log(&mut self, level: Level, line: impl fmt::Display) {
        self.host.log(level, format_args!("{line}"));
    }

    /// [`log`](Context::log) at [`Level::Info`].
    pub fn info(&mut self, line: impl fmt::Display) {
        self.log(Level::Info, line);
    }

    /// [`log`](Context::log) at [`Level::Warning`].
    pub fn warn(&mut self, line: impl fmt::Display) {
        self.log(Level::Warning, line);
    }

    /// Says that a person is needed: in the log, at [`Level::Error`], and in the alerts of the fleet, which operators
    /// acknowledge. `kind` is a word that stands in metrics, such as `assistance`; `subject` says what it is about,
    /// where a component may have several alerts of a kind. It lasts until [`alert_over`](Context::alert_over) or until
    /// the component starts anew; the same kind and subject again give it another line.
    pub fn alert(&mut self, kind: &str, subject: impl fmt::Display, line: impl fmt::Display) {
        self.host.alert(kind, &subject.to_string(), Some(format_args!("{line}")));
    }

    /// Says that the [`alert`](Context::alert) of this kind and subject is over; if there is none, nothing happens.
    pub fn alert_over(&mut self, kind: &str, subject: impl fmt::Display) {
        self.host.alert(kind, &subject.to_string(), None);
    }

    /// Writes a line to the classic console (`--console classic`). Formatted only if an observer wants it.
    pub fn console(&mut self, line: impl fmt::Display) {
        self.host.console(format_args!("{line}"));
    }

    /// Sets a value of the run's report, such as `map.blocks`; dots lead into nested objects. The last value counts.
    pub fn report(&mut self, path: &str, value: impl Into<ReportValue>) {
        self.host.report(path, value.into());
    }

    /// Adds to a number of the run's report, such as `luggage.delivered`, which several components may share.
    pub fn count(&mut self, path: &str, more: i64) {
        self.host.count(path, more);
    }

    /// Says whether this component has work left. The run ends by itself when at least one component voted and all that
    /// voted `Open` or `Done` are [`Work::Done`]. If the component publishes events in the same execution, the run
    /// continues for three of its longest periods, so that these are read.
    pub fn vote(&mut self, work: Work) {
        self.host.vote(work);
    }
}
/// Writes a line to the log with values in it, as `format!` takes them; [`Context::info`] takes a text alone.
///
/// ```
/// use saoms_api::{Context, info};
///
/// fn tell(context: &mut Context<'_>, pieces: u32) {
///     info!(context, "has {pieces} pieces");
/// }
/// ```
#[macro_export]
macro_rules! info {
    ($context:expr, $($line:tt)+) => { $crate::info!(@ $crate::Level::Info, $context, $($line)+) };
    (@ $level:expr, $context:expr, $($line:tt)+) => { $context.log($level, ::core::format_args!($($line)+)) };
}

/// [`info!`](crate::info) at [`Level::Warning`].
#[macro_export]
macro_rules! warn {
    ($context:expr, $($line:tt)+) => { $crate::info!(@ $crate::Level::Warning, $context, $($line)+) };
}
