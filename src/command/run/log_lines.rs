//! The lines of the log: options, levels, and how a line looks.

use std::borrow::Cow;
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use clap::{Args, ValueEnum};
use saoms_api::Level;
use saoms_api::host::one_line;
use saoms_control::{LogLine, date};
use saoms_core::observe::{Occurrence, Rotation, RunEvent};
use saoms_core::report::RunReport;
use saoms_lang::assembly::Assembly;

use super::summary::outcome;
use super::{ConsoleStyle, RunArguments};
use crate::arguments::{duration, parse_size};

/// The least and the greatest width of the column with the names of components.
const NAMES: (usize, usize) = (14, 32);

/// Options of the log.
#[derive(Clone, Debug, Args)]
pub(crate) struct LogArguments {
    /// Also append the log to this file; `--quiet` and `--console` have no effect on it
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Option<PathBuf>,

    /// The format of the log: lines for people, or JSON objects with the time of day
    #[arg(long, value_enum, default_value_t = LogFormat::Plain)]
    log_format: LogFormat,

    /// The least severe lines that the log contains: `error`, `warning`, `info` (what happens) or `debug` (for
    /// developers) [default: info]
    #[arg(long, value_enum, value_name = "LEVEL")]
    log_level: Option<LogLevel>,

    /// Start plain lines of the log with date and time in UTC
    #[arg(long)]
    log_date: bool,

    /// Rotate the files of `--log` and `--journal` before they are larger than this: FILE becomes FILE.1, FILE.1
    /// becomes FILE.2, and so on
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    rotate_size: Option<u64>,

    /// Rotate these files when they are older than this (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long, value_name = "DURATION", value_parser = duration)]
    rotate_age: Option<Duration>,

    /// The number of earlier files to keep, beside the current one [default: 9]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=9999))]
    rotate_keep: Option<u32>,
}

/// Earlier files that are kept unless the command line says otherwise.
const KEEP: u32 = 9;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogFormat {
    Plain,
    Json,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum LogLevel {
    Error,
    Warning,
    Info,
    Debug,
}

impl From<LogLevel> for Level {
    fn from(level: LogLevel) -> Level {
        match level {
            LogLevel::Error => Level::Error,
            LogLevel::Warning => Level::Warning,
            LogLevel::Info => Level::Info,
            LogLevel::Debug => Level::Debug,
        }
    }
}

impl LogArguments {
    /// When files are moved aside.
    pub(super) fn rotation(&self) -> Rotation {
        Rotation { size: self.rotate_size, age: self.rotate_age, keep: self.rotate_keep.unwrap_or(KEEP) }
    }

    /// The option that would have no effect, and why.
    pub(super) fn without_effect(&self, arguments: &RunArguments) -> Option<&'static str> {
        let is_classic = arguments.console == ConsoleStyle::Classic;
        let rotates = self.rotate_size.is_some() || self.rotate_age.is_some();
        if rotates && self.log.is_none() && arguments.journal.is_none() {
            return Some("`--rotate-size` and `--rotate-age` are for the files of `--log` and `--journal`");
        }
        if self.rotate_keep.is_some() && !rotates {
            return Some("`--rotate-keep` is for files that `--rotate-size` or `--rotate-age` moves aside");
        }
        if self.log.is_some() {
            return None;
        }
        if self.log_level.is_some() && (arguments.quiet || is_classic) {
            return Some(
                "`--log-level` has no effect with `--quiet` and `--console classic`, unless `--log` names a file",
            );
        }
        if is_classic && (self.log_format == LogFormat::Json || self.log_date) {
            return Some(
                "the classic console has a form of its own, which `--log-format` and `--log-date` do not change",
            );
        }
        (self.log_format == LogFormat::Json && self.log_date)
            .then_some("`--log-date` is for plain lines: lines in JSON have the time of day")
    }
}

/// How lines of the log look.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogStyle {
    pub(super) format: LogFormat,
    /// The least severe lines.
    pub(super) level: Level,
    has_date: bool,
    /// The width of the column with the names of components.
    width: usize,
}

impl LogStyle {
    /// The style that the command line asks for.
    pub(super) fn of(arguments: &LogArguments, assembly: &Assembly) -> LogStyle {
        let LogArguments { log_format, log_level, log_date, .. } = *arguments;
        let level = log_level.map_or(Level::Info, Level::from);
        LogStyle { format: log_format, level, has_date: log_date, width: width(assembly) }
    }

    /// The style of plain lines without a date, as the classic console has them.
    pub(super) fn plain(self) -> LogStyle {
        LogStyle { format: LogFormat::Plain, has_date: false, ..self }
    }

    /// An event as a line.
    pub(super) fn line(self, event: &RunEvent) -> String {
        match self.format {
            // A line of a log is an object of texts and numbers: it can be written.
            LogFormat::Json => format!("{}\n", serde_json::json!(LogLine::of(event))),
            LogFormat::Plain if self.has_date => format!("{}  {}", date(SystemTime::now()), plain(event, self.width)),
            LogFormat::Plain => plain(event, self.width),
        }
    }

    /// The line about the end of a run.
    pub(super) fn end(self, report: &RunReport) -> String {
        let text = outcome(report);
        let time = saoms_api::Time::from_nanos(
            Duration::try_from_secs_f64(report.time_s).unwrap_or_default().as_nanos() as u64,
        );
        self.line(&RunEvent { time, component: None, what: Occurrence::Note { level: Level::Info, text } })
    }
}

fn width(assembly: &Assembly) -> usize {
    let names = assembly.components.iter().map(|component| one_line(&component.path).chars().count());
    names.max().unwrap_or(0).clamp(NAMES.0, NAMES.1)
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
