//! `saoms record`: what a recording has, its messages as JSON, and a part of it as a recording of its own.

mod cat;
mod filter;
mod info;

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, Subcommand};
use saoms_api::host::one_line;
use saoms_api::rule::nearest;
use saoms_recording::{Reader, RecordedMessage, RecordingError};

use crate::Exit;
use crate::arguments::duration;
use crate::output::{Outputs, displayed, eprint};

const EXIT_CODES: &str = "\
Exit codes:
  0  shown or written; also of a recording that was cut off, as far as it goes
  1  the output could not be written, or the recording not be read
  2  there is no such recording or topic, or the output is the recording";

/// Show recordings of `saoms run --record`, or take a part of one
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct RecordArguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    Info(info::InfoArguments),
    Cat(cat::CatArguments),
    Filter(filter::FilterArguments),
}

/// What of a recording is meant.
#[derive(Clone, Debug, Args)]
struct PartArguments {
    /// The recording
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// Only messages of this topic; may be repeated. `/rosout` is the log, `/saoms/journal` the journal
    #[arg(long = "topic", value_name = "TOPIC", value_delimiter = ',')]
    topics: Vec<String>,

    /// Only messages from this time of the run on (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long, value_name = "TIME", value_parser = duration)]
    from: Option<Duration>,

    /// Only messages up to this time of the run
    #[arg(long, value_name = "TIME", value_parser = duration)]
    to: Option<Duration>,
}

pub(crate) fn record(arguments: &RecordArguments) -> Exit {
    let done = match &arguments.action {
        Action::Info(arguments) => info::info(arguments),
        Action::Cat(arguments) => cat::cat(arguments),
        Action::Filter(arguments) => filter::filter(arguments),
    };
    done.map_or_else(|exit| exit, |()| Exit::Done)
}

/// A recording. Why it cannot be read is reported.
pub(super) fn open(path: &Path) -> Result<Reader, Exit> {
    Outputs::beside([path.to_owned()]).with_streams()?;
    Reader::open(path).map_err(|error| unreadable(&error))
}

/// Reports why a recording cannot be read.
pub(super) fn unreadable(error: &RecordingError) -> Exit {
    eprint(&format!("error: {}\n", one_line(&error.to_string())));
    match error {
        RecordingError::Io { error, .. } if error.kind() != std::io::ErrorKind::NotFound => Exit::Failed,
        _ => Exit::WrongInput,
    }
}

/// Says that a recording, all of which was read, was cut off.
fn warn_of_cut(path: &Path, reader: &Reader) {
    if let Some(why) = reader.cut() {
        let (path, why) = (displayed(path), one_line(why));
        eprint(&format!("warning: `{path}` ends in the middle: {why}; what stands before is complete\n"));
    }
}

/// The times of a recording as those of its run.
#[derive(Clone, Copy, Debug, Default)]
struct Start(Option<u64>);

impl Start {
    /// The time of a message in seconds of the run: of one by another program, from its first message on.
    fn seconds(&mut self, reader: &Reader, message: &RecordedMessage) -> f64 {
        let start = *self.0.get_or_insert_with(|| reader.start().unwrap_or(message.time));
        let distance = i128::from(message.time) - i128::from(start);
        distance as f64 / 1e9
    }
}

impl PartArguments {
    /// True if a message is meant that has this time of the run.
    fn mean(&self, message: &RecordedMessage, seconds: f64) -> bool {
        self.means_topic(message)
            && self.from.is_none_or(|from| seconds >= from.as_secs_f64())
            && self.to.is_none_or(|to| seconds <= to.as_secs_f64())
    }

    /// True if a message is of a topic that is meant, and from before the time that is.
    fn begin_after(&self, message: &RecordedMessage, seconds: f64) -> bool {
        self.means_topic(message) && self.from.is_some_and(|from| seconds < from.as_secs_f64())
    }

    fn means_topic(&self, message: &RecordedMessage) -> bool {
        self.topics.is_empty() || self.topics.iter().any(|one| one == message.channel.topic())
    }

    /// Reports topics that a recording, all of which was read, does not have.
    fn check_topics(&self, reader: &Reader) -> Result<(), Exit> {
        let names = || reader.channels().map(|channel| channel.topic());
        let unknown: Vec<&String> = self.topics.iter().filter(|topic| !names().any(|name| name == *topic)).collect();
        for topic in &unknown {
            let near = nearest(topic, names()).map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
            eprint(&format!("error: the recording has no topic `{}`{near}\n", one_line(topic)));
        }
        if unknown.is_empty() { Ok(()) } else { Err(Exit::WrongInput) }
    }
}
