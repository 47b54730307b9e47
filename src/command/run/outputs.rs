//! Files that a run leaves behind: tried before it starts, written while it goes on or when it has ended.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use saoms_core::observe::{JournalFile, RotatingFile, Rotation, earlier_file};
use saoms_recording::path_of_part;

use super::RunArguments;
use super::log_file::LogFile;
use super::log_lines::LogStyle;
use crate::output::{Asked, Outputs, Place, Sink, counted, displayed, eprint, mode_of_files};

/// The files of a run.
pub(super) struct RunFiles {
    pub(super) report: Option<Output>,
    pub(super) picture: Option<Output>,
    pub(super) timeline: Option<Output>,
    pub(super) journal: Option<JournalFile>,
    pub(super) history: Option<PathBuf>,
    pub(super) recording: Option<PathBuf>,
    pub(super) log: Option<LogFile>,
}

/// A file to write when a run has ended.
#[derive(Debug)]
pub(super) struct Output {
    what: &'static str,
    path: PathBuf,
    sink: Sink,
    has_failed: AtomicBool,
}

impl RunFiles {
    /// The files that a run was asked for, tried before it starts, as it may last for days. What they hold stays until
    /// there is something new. `None` after it was told that one cannot be written, or is one of those that are read.
    pub(super) fn of<'a>(arguments: &'a RunArguments, read: Vec<PathBuf>, style: LogStyle) -> Option<RunFiles> {
        let mut outputs = Outputs::beside(read);
        let mut problems = Vec::new();
        let mut add = |what, option, path: Option<&'a Path>, grows| {
            let asked = Asked { what, option, path: path?, grows };
            outputs.add(asked).map_err(|refused| problems.push(refused.into_text())).ok().map(|place| (asked, place))
        };
        let report = add("report", "--report", arguments.report.as_deref(), false);
        let picture = add("picture", "--paths", arguments.paths.as_deref(), false);
        let timeline = add("timeline", "--timeline", arguments.timeline.as_deref(), false);
        let journal = add("journal", "--journal", arguments.journal.as_deref(), true);
        let history = add("history", "--history", arguments.history.file.as_deref(), true);
        let recording = add("recording", "--record", arguments.recording.file.as_deref(), true);
        let log = add("log", "--log", arguments.log.log.as_deref(), true);
        let rotation = arguments.log.rotation();
        let moved = [&journal, &log].into_iter().flatten().filter(|_| rotation.is_any());
        problems.extend(moved.filter_map(|(asked, place)| taken_aside(asked, place, rotation, &outputs)));
        problems.extend(recording.iter().filter_map(|(asked, place)| taken_by_part(asked, place, &outputs)));
        let pictures = [("--paths", &arguments.paths), ("--timeline", &arguments.timeline)];
        problems.extend(pictures.into_iter().filter_map(|(option, path)| other_picture(option, path.as_deref()?)));
        if problems.is_empty() {
            // A pipe waits for its reader, so that it is opened when nothing else can be wrong.
            let mut told = |asked: Asked<'_>, error| problems.push(asked.unwritable(&error));
            let mut whole = |(asked, place)| Output::open(asked, place).map_err(|error| told(asked, error)).ok();
            let (report, picture) = (report.and_then(&mut whole), picture.and_then(&mut whole));
            let timeline = timeline.and_then(&mut whole);
            let journal = journal
                .and_then(|(asked, place)| grown(asked, place, rotation).map_err(|error| told(asked, error)).ok());
            let log = log.and_then(|(asked, place)| {
                log_file(asked, place, rotation, style).map_err(|error| told(asked, error)).ok()
            });
            let history = history.and_then(|(asked, place)| {
                plain_file(&place, "the history is a database").map_err(|error| told(asked, error)).ok()
            });
            let recording = recording.and_then(|(asked, place)| {
                plain_file(&place, "a recording has an index").map_err(|error| told(asked, error)).ok()
            });
            if problems.is_empty() {
                return Some(RunFiles { report, picture, timeline, journal, history, recording, log });
            }
        }
        eprint(&format!("{}\n{}: nothing was started\n", problems.concat(), counted(problems.len(), "error")));
        None
    }
}

/// The message about a file that would be moved over one that is read, or over another output.
fn taken_aside(asked: &Asked<'_>, place: &Place, rotation: Rotation, outputs: &Outputs) -> Option<String> {
    let Place::File(path) = place else { return None };
    let taken = (1..=rotation.keep).map(|number| earlier_file(path, number)).find(|file| outputs.hold(file))?;
    let Asked { what, option, path, .. } = asked;
    let (path, taken) = (displayed(path), displayed(&taken));
    Some(format!(
        "error: `{option} {path}`: the {what} would be rotated onto `{taken}`, which is an input or another output\n"
    ))
}

/// The parts of a recording that are looked at.
const PARTS: u32 = 1000;

/// The message about a recording that would go on over a file that is read, or over another output.
fn taken_by_part(asked: &Asked<'_>, place: &Place, outputs: &Outputs) -> Option<String> {
    let Place::File(path) = place else { return None };
    let taken = (2..=PARTS).map(|part| path_of_part(path, part)).find(|file| outputs.hold(file))?;
    let Asked { what, option, path, .. } = asked;
    let (path, taken) = (displayed(path), displayed(&taken));
    Some(format!(
        "error: `{option} {path}`: the {what} would go on in `{taken}`, which is an input or another output\n"
    ))
}

/// The endings of pictures that are no SVG.
const PICTURES: [&str; 13] =
    ["png", "jpg", "jpeg", "gif", "webp", "bmp", "tif", "tiff", "pdf", "ps", "eps", "svgz", "ico"];

/// The message about a file whose ending is that of another kind of picture.
fn other_picture(option: &str, path: &Path) -> Option<String> {
    let ending = path.extension()?.to_str()?;
    let is_other = PICTURES.iter().any(|known| ending.eq_ignore_ascii_case(known));
    is_other.then(|| {
        format!(
            "error: the picture of `{option}` is in SVG, but `{}` ends with `.{ending}`\n  = help: write `{}`\n",
            displayed(path),
            displayed(&path.with_extension("svg"))
        )
    })
}

fn grown(asked: Asked<'_>, place: Place, rotation: Rotation) -> io::Result<JournalFile> {
    match place.open()? {
        Sink::Open(file) => Ok(JournalFile::to(file, asked.path)),
        Sink::File(path) => {
            let tell = |problem: &str| eprint(&format!("error: {problem}\n"));
            Ok(JournalFile::new(path).with_mode(mode_of_files()).with_rotation(rotation, tell))
        }
        Sink::Standard => Err(io::Error::other("standard output is for the lines of the run; give it a file")),
    }
}

/// The path of what has to be a file, for a reason.
fn plain_file(place: &Place, reason: &str) -> io::Result<PathBuf> {
    match place {
        Place::File(path) => Ok(path.clone()),
        Place::Descriptor(_) | Place::Irregular(_) => Err(io::Error::other(format!("{reason}; give it a file"))),
    }
}

fn log_file(asked: Asked<'_>, place: Place, rotation: Rotation, style: LogStyle) -> io::Result<LogFile> {
    let path = asked.path.to_owned();
    let file = match place.open()? {
        Sink::Open(file) => RotatingFile::of(file, path.clone()),
        Sink::File(file) => RotatingFile::append(file, mode_of_files(), rotation)?,
        Sink::Standard => return Err(io::Error::other("standard output has these lines without it; give it a file")),
    };
    Ok(LogFile::new(path, file, style))
}

impl Output {
    fn open(asked: Asked<'_>, place: Place) -> io::Result<Output> {
        let (what, path, sink) = (asked.what, asked.path.to_owned(), place.open()?);
        Ok(Output { what, path, sink, has_failed: AtomicBool::new(false) })
    }

    /// Writes it. A failure is told.
    pub(super) fn write(&self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
        if let Err(problem) = self.sink.write(write) {
            let (what, path) = (self.what, displayed(&self.path));
            eprint(&format!("error: the {what} could not be written to `{path}`: {problem}\n"));
            self.has_failed.store(true, Ordering::Relaxed);
        }
    }

    /// True if it goes to standard output.
    pub(super) fn is_standard(&self) -> bool {
        matches!(self.sink, Sink::Standard)
    }

    /// True if it could not be written.
    pub(super) fn has_failed(&self) -> bool {
        self.has_failed.load(Ordering::Relaxed)
    }
}
