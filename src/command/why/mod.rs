//! `saoms why`: what led to what a robot did, from the journal of a run.

mod answer;

use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use saoms_api::Time;
use saoms_api::host::{format_duration, one_line};
use saoms_core::journal::{
    JournalDocument, JournalPart, JournalReadError, JournalSource, Why, find, node_of, part, read, read_parts,
};
use saoms_core::observe::earlier_file;
use serde_json::json;

use crate::Exit;
use crate::arguments::{Format, duration};
use crate::command::control::{RunningFleetArguments, escape};
use crate::command::report::merged;
use crate::output::{self, Outputs, eprint, print, print_as_is};

const EXIT_CODES: &str = "\
Exit codes:
  0  answered, even if the component did nothing
  1  standard output could not be written
  2  the input is wrong: no such robot, a time after the end of the run, a file that is incomplete or has no journal; or the
     records that the whole answer needs were overwritten, or left out by --short-report; no fleet runs, or it is not
     clear which one is meant";

/// Explain why a component did something: in a running fleet, or from the report or the journal of a run
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct WhyArguments {
    /// The robot, or any other component: its path, a unique ending of its path, or its ID
    #[arg(value_name = "ROBOT")]
    pub(crate) component: String,

    /// Explain the last action before this time of the run; by default, before the end of the run (a bare number is
    /// milliseconds; units us, ms, s, min, h)
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = duration)]
    pub(crate) at: Option<Duration>,

    /// The file of `saoms run --report`, or that of `saoms run --journal`; `-` is standard input. Of a fleet that ran
    /// in several programs, give the report of each. Without this option, the running fleet is asked
    #[arg(long, visible_alias = "journal", value_name = "FILE", conflicts_with_all = ["name", "token_file"])]
    pub(crate) report: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) fleet: RunningFleetArguments,
}

pub(crate) fn why(arguments: &WhyArguments) -> Exit {
    if let Err(exit) = Outputs::beside(arguments.report.clone()).with_streams() {
        return exit;
    }
    let document = match &arguments.report[..] {
        [path] => whole_document(path),
        several @ [_, ..] => of_nodes(several),
        [] => match of_running(arguments) {
            Ok(document) => Ok(document),
            Err(exit) => return exit,
        },
    };
    let show = |text: &str| match arguments.fleet.format {
        Format::Human => print(text),
        Format::Json => print_as_is(text),
    };
    match document.and_then(|document| answer(arguments, &document)) {
        Ok(Answer { text, lost: None }) => {
            show(&text);
            Exit::Done
        }
        Ok(Answer { text, lost: Some(lost) }) => {
            show(&text);
            eprint(&format!("error: {}\n", one_line(&lost)));
            Exit::WrongInput
        }
        Err(problem) => {
            eprint(&format!("error: {}\n", one_line(&problem)));
            Exit::WrongInput
        }
    }
}

struct Answer {
    text: String,
    /// Reason why the answer is incomplete.
    lost: Option<String>,
}

/// The journal in a file, which has to have its records.
fn whole_document(path: &Path) -> Result<JournalDocument, String> {
    let document = document(path)?;
    let journal = &document.journal;
    if document.source == JournalSource::Report && journal.entries().is_empty() && journal.records > journal.overwritten
    {
        return Err(format!(
            "{} is a report without the records of the journal, as `--short-report` writes it: run again without that option, or with `--journal FILE`, and give that file to `saoms why`",
            named(path)
        ));
    }
    Ok(document)
}

/// The journals of the reports of several nodes as one.
fn of_nodes(paths: &[PathBuf]) -> Result<JournalDocument, String> {
    let report = serde_json::to_string(&merged(paths)?).map_err(|error| error.to_string())?;
    let document = read(&report).map_err(|error| error.to_string())?;
    if document.journal.entries().is_empty() && document.journal.records > document.journal.overwritten {
        return Err(
            "these are reports without the records of their journals, as `--short-report` writes them: run again \
                    without that option"
                .to_owned(),
        );
    }
    Ok(document)
}

/// What the fleet that runs tells. Why there is nothing is reported.
fn of_running(arguments: &WhyArguments) -> Result<JournalDocument, Exit> {
    let fleet = &arguments.fleet;
    let at = arguments.at.map(|at| format!("&at={}", escape(&format_duration(at)))).unwrap_or_default();
    let path = format!("/v1/why?component={}{at}", escape(&arguments.component));
    let told = fleet.ask("GET", &path, "").inspect_err(|_| {
        if fleet.format == Format::Human && fleet.name.is_none() && saoms_control::running().is_empty() {
            eprint("  = help: `--report FILE` asks the report or the journal of a run\n");
        }
    })?;
    let document = read(&told.to_string());
    let document = document
        .map_err(|error| fleet.refuse(&format!("the answer of the fleet is malformed: {error}"), Exit::WrongInput))?;
    Ok(JournalDocument { source: JournalSource::Running, ..document })
}

fn answer(arguments: &WhyArguments, document: &JournalDocument) -> Result<Answer, String> {
    let component = find(&document.components, &arguments.component)?;
    let at = arguments.at.map(|at| Time::START + at);
    if let (Some(asked), Some(at), Some(end)) = (arguments.at, at, document.end)
        && at > end
    {
        let asked = format_duration(asked);
        let reached = if document.source == JournalSource::Running { "is at" } else { "had ended at" };
        return Err(format!("the run {reached} {end}, before {asked}: ask for a time up to then"));
    }
    let why = document.journal.why(&component.name, at).map_err(|error| {
        format!("the causes of the action of `{}` are unknown: {error}. {}", component.name, advice(document))
    })?;
    let missing = why.chains.iter().find_map(|chain| chain.missing);
    let lost = missing.map(|missing| {
        if let Some((node, number)) = node_of(missing) {
            return of_other_node(document, node, number);
        }
        let how = if document.source == JournalSource::File { "not written to the file" } else { "overwritten" };
        format!("record {}, which led to this, was {how}. {}", missing.0, advice(document))
    });
    let text = match arguments.fleet.format {
        Format::Human => answer::human(&component.name, at, &why, document),
        Format::Json => machine(&component.name, at, &why),
    };
    Ok(Answer { text, lost })
}

/// What is said of a record of another node, which is not among those that are known.
fn of_other_node(document: &JournalDocument, node: usize, number: u64) -> String {
    let node = document.nodes.get(node).map_or_else(|| "another node".to_owned(), |node| format!("node `{node}`"));
    format!(
        "record {number} of {node} led to this, and is not known here: give `--report` for each program of the fleet, or \
         it was overwritten there"
    )
}

/// Advice about records that are missing.
fn advice(document: &JournalDocument) -> String {
    let what = match document.source {
        JournalSource::Report => "A report",
        JournalSource::Running => "A running fleet",
        JournalSource::File => {
            let missing = document.journal.lost + document.journal.overwritten;
            let hint = if document.journal.overwritten > 0 { ": `--rotate-keep` keeps more earlier files" } else { "" };
            return format!("Of this run {missing} records are not in the file{hint}");
        }
    };
    format!("{what} holds the newest records of each component: run with `--journal FILE` to keep all of them")
}

/// A file as messages name it.
pub(super) fn named(path: &Path) -> String {
    if path == Path::new("-") { "standard input".to_owned() } else { format!("`{}`", path.display()) }
}

/// The journal in a file, or in standard input for `-`. Of a file that was moved aside while the run went on, the
/// earlier ones are read, too.
pub(super) fn document(path: &Path) -> Result<JournalDocument, String> {
    let last = text(path)?;
    let mut parts = vec![(path.to_owned(), last)];
    if path != Path::new("-")
        && let Some(newest) = part(&parts[0].1)
    {
        parts.extend(earlier_parts(path, &newest));
        parts.reverse();
    }
    let texts: Vec<&str> = parts.iter().map(|(_, text)| text.as_str()).collect();
    let document = match texts[..] {
        [only] => read(only).map_err(|error| (0, error)),
        ref several => read_parts(several),
    };
    document.map_err(|(place, error)| {
        let name = named(&parts[place].0);
        match error {
            JournalReadError::NoJournal => {
                format!("{name} contains no journal: write the report again with `saoms run --report FILE`")
            }
            JournalReadError::Other => format!("{name} cannot be read: {error}"),
            JournalReadError::Malformed { .. } => format!("{name}, {error}"),
        }
    })
}

/// The parts of the same run before this one, the newest first, as far as they follow each other.
fn earlier_parts(path: &Path, newest: &JournalPart) -> Vec<(PathBuf, String)> {
    let (mut parts, mut next) = (Vec::new(), newest.number);
    // They stand beside the file that a link leads to.
    let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    for number in 1.. {
        let file = earlier_file(&path, number);
        let Ok(text) = text(&file) else { break };
        match part(&text) {
            Some(found) if found.run == newest.run && found.number + 1 == next => {
                next = found.number;
                parts.push((file, text));
            }
            // It was moved on since the one after it was read.
            Some(found) if found.run == newest.run && found.number >= next => {}
            _ => break,
        }
    }
    parts
}

/// The text of a file, or of standard input for `-`.
pub(super) fn text(path: &Path) -> Result<String, String> {
    let name = named(path);
    let bytes = if path == Path::new("-") {
        let mut bytes = Vec::new();
        std::io::stdin().lock().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    let bytes = bytes.map_err(|error| format!("{name} cannot be read: {error}"))?;
    String::from_utf8(whole_lines(bytes))
        .map_err(|error| format!("{name} is not text: byte {} is not UTF-8", error.utf8_error().valid_up_to() + 1))
}

/// The bytes of a file without a last line that was not written whole: a run that goes on or was killed ends within a
/// character, a machine that lost its power leaves zeros or what was on the disk before.
fn whole_lines(mut bytes: Vec<u8>) -> Vec<u8> {
    let tail = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let is_text = |tail: &[u8]| str::from_utf8(tail).is_ok() && !tail.contains(&0);
    if tail > 0 && !is_text(&bytes[tail..]) {
        bytes.truncate(tail);
    }
    bytes
}

fn machine(component: &str, at: Option<Time>, why: &Why<'_>) -> String {
    let asked = at.map(Time::as_secs_f64);
    let answer = json!({
        "component": component,
        "asked_s": asked,
        "time_s": why.time.map(Time::as_secs_f64),
        "chains": why.chains,
        "knowledge": why.knowledge,
    });
    let mut text = Vec::new();
    // Nothing fails in memory, and what is written is text.
    let _ = output::json(&mut text, &answer);
    String::from_utf8(text).unwrap_or_default()
}
