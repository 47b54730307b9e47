//! The recording that a run leaves (`--record`).

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use clap::Args;
use saoms_api::extension::DrawingRegistration;
use saoms_api::host::one_line;
use saoms_api::rule::nearest;
use saoms_control::{AlertList, LossCounts};
use saoms_lang::assembly::{Assembly, Traffic};
use saoms_lang::source::{Sources, Span};
use saoms_recording::{RecordedRun, Recording};

use super::RunArguments;
use super::alerts::FileAlert;
use super::control::fleet_name;
use crate::Exit;
use crate::arguments::parse_size;
use crate::output::{counted, eprint, mode_of_files};

/// Options of `saoms run` for the recording.
#[derive(Clone, Debug, Args)]
pub(crate) struct RecordingArguments {
    /// Record the messages of all topics, the journal and the log to this file, in the format MCAP with types of ROS 2,
    /// which Foxglove opens. `saoms record` shows it
    #[arg(long = "record", id = "record", value_name = "FILE.mcap")]
    pub(super) file: Option<PathBuf>,

    /// Record the messages of these topics alone
    #[arg(long = "record-topics", value_name = "TOPIC,...", requires = "record", value_delimiter = ',')]
    topics: Option<Vec<String>>,

    /// Record all that these components get and do, too, so that `saoms replay FILE --component NAME` runs each of them
    /// again alone
    #[arg(long = "record-component", value_name = "NAME,...", requires = "record", value_delimiter = ',')]
    components: Vec<String>,

    /// End the file at this size, from 1MB on, and go on in another one: `FILE-2.mcap`, `FILE-3.mcap` and so on
    #[arg(long = "record-limit", id = "record-limit", value_name = "SIZE", requires = "record", value_parser = limit)]
    limit: Option<u64>,
}

/// The least size of a file: what stands before its messages has room.
const LEAST: u64 = 1_000_000;

fn limit(text: &str) -> Result<u64, String> {
    match parse_size(text)? {
        size if size < LEAST => Err("expected 1MB at least".to_owned()),
        size => Ok(size),
    }
}

/// The most components of a fleet whose recording has what `saoms replay` shows without a full report. Samples of 1,000
/// components would take longer than all else that is recorded of them.
pub(super) const REPLAYED: usize = 250;

/// The names and texts of what says what the fleet is, without secrets.
pub(super) fn texts(sources: &Sources) -> Vec<(String, String)> {
    let files = sources.iter().map(|(_, file)| file).filter(|file| !file.path().starts_with("--"));
    files
        .map(|file| {
            let whole = Span::new(0, u32::try_from(file.text().len()).unwrap_or(u32::MAX));
            (file.path().to_owned(), file.shown(whole).into_owned())
        })
        .collect()
}

/// The observer that records the run. A topic that nobody has is reported.
pub(super) fn of(
    path: &Path,
    arguments: &RunArguments,
    (assembly, files): (&Assembly, Vec<(String, String)>),
    alerts: &Arc<AlertList>,
) -> Result<Recording, Exit> {
    let topics = arguments.recording.topics.clone();
    if let Some(wanted) = &topics {
        let known = Traffic::of(assembly).topics;
        let drawn = drawn(known.iter().map(|topic| topic.name.as_str()));
        let names = || known.iter().map(|topic| topic.name.as_str()).chain(drawn.iter().map(String::as_str));
        let unknown: Vec<&String> = wanted.iter().filter(|topic| !names().any(|name| name == *topic)).collect();
        for topic in &unknown {
            let near = nearest(topic, names()).map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
            let topic = one_line(topic);
            eprint(&format!("error: `--record-topics`: the fleet has no topic `{topic}`{near}\n"));
        }
        if !unknown.is_empty() {
            eprint(&format!("\n{}: nothing was started\n", counted(unknown.len(), "error")));
            return Err(Exit::WrongInput);
        }
    }
    let run = RecordedRun {
        name: fleet_name(arguments),
        files,
        node: arguments.node.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        topics,
        components: components(arguments, assembly)?,
        limit: arguments.recording.limit,
    };
    Ok(Recording::new(path, mode_of_files(), run, Box::new(FileAlert::of("recording", alerts))))
}

/// The components whose tapes are recorded. One that the fleet does not have is reported.
fn components(arguments: &RunArguments, assembly: &Assembly) -> Result<Vec<String>, Exit> {
    let wanted = &arguments.recording.components;
    let names = || assembly.components.iter().map(|one| one.path.as_str());
    let unknown: Vec<&String> = wanted.iter().filter(|one| !names().any(|name| name == *one)).collect();
    for component in &unknown {
        let near = nearest(component, names()).map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
        let component = one_line(component);
        eprint(&format!("error: `--record-component`: the fleet has no component `{component}`{near}\n"));
    }
    if unknown.is_empty() {
        return Ok(wanted.clone());
    }
    eprint(&format!("\n{}: nothing was started\n", counted(unknown.len(), "error")));
    Err(Exit::WrongInput)
}

/// The topics that drawings may have beside these, in each of their sites.
fn drawn<'a>(topics: impl Iterator<Item = &'a str>) -> BTreeSet<String> {
    let own = || DrawingRegistration::linked().into_iter().flat_map(|one| one.topics);
    let in_site = |site: &str| own().map(|topic| format!("{site}/{topic}")).collect::<Vec<_>>();
    topics
        .flat_map(|topic| match topic.rsplit_once('/') {
            Some((site, _)) => in_site(&format!("/{site}")),
            None => in_site(""),
        })
        .collect()
}

/// True if the recording lacks something, which is told.
pub(super) fn lacks_messages(losses: &LossCounts) -> bool {
    let lost = losses.recorded.load(Ordering::Relaxed);
    if lost > 0 {
        let lost = counted(usize::try_from(lost).unwrap_or(usize::MAX), "message");
        eprint(&format!(
            "error: the recording lacks {lost} at least, records of the journal and lines of the log included\n"
        ));
    }
    lost > 0
}
