//! The files that a run leaves behind: asked for before it starts, written when it has ended.

use std::fs::File;
use std::io;
use std::path::Path;

use saoms_core::report::RunReport;

use super::RunArguments;
use super::summary::outcome;
use crate::output::{counted, eprint, try_print};
use crate::paths::Paths;

/// Whether the files can be written, asked before a run that may last for days. What they hold stays until there is something new. Where one
/// cannot, that has been told.
pub(crate) fn writable(arguments: &RunArguments) -> bool {
    let files = [
        ("report", "--report", &arguments.report),
        ("picture", "--paths", &arguments.paths),
        ("journal", "--journal", &arguments.journal),
    ];
    let mut problems: Vec<String> = files
        .iter()
        .filter_map(|(what, _, path)| Some((what, path.as_deref()?)))
        .filter_map(|(what, path)| Some((what, path, try_open(path).err()?)))
        .map(|(what, path, problem)| {
            format!("error: the {what} cannot be written to `{}`: {problem}\n", path.display())
        })
        .collect();
    for (place, (what, _, path)) in files.iter().enumerate() {
        let Some(path) = path else { continue };
        for (other, option, _) in
            files[place + 1..].iter().filter(|(_, _, other)| other.as_ref() == Some(path))
        {
            problems.push(format!(
                "error: the {what} and the {other} cannot both be written to `{}`\n  = help: give `{option}` another file\n",
                path.display()
            ));
        }
    }
    if arguments.journal.as_deref() == Some(Path::new("-")) {
        let problem =
            "error: the journal cannot be written to standard output, which is for the lines of the run\n";
        problems.push(format!("{problem}  = help: give `--journal` a file\n"));
    }
    if !problems.is_empty() {
        eprint(&format!(
            "{}\n{}: nothing was started\n",
            problems.concat(),
            counted(problems.len(), "error")
        ));
    }
    problems.is_empty()
}

/// Whether a file can be written, without a trace of the question: what is there stays as it is, and nothing else is there afterwards.
fn try_open(path: &Path) -> io::Result<()> {
    if path == Path::new("-") {
        return Ok(());
    }
    match File::options().append(true).open(path) {
        Err(problem) if problem.kind() == io::ErrorKind::NotFound => {}
        result => return result.map(drop),
    }
    // A link to what is not there yet.
    if let Ok(target) = path.read_link() {
        return try_open(&path.parent().unwrap_or(Path::new("")).join(target));
    }
    // Removed is only what was made here: where somebody else was faster, this is an error.
    File::create_new(path)?;
    std::fs::remove_file(path)
}

/// Writes what was asked for; `false` where that was not possible, which has been told.
pub(crate) fn write(arguments: &RunArguments, report: &RunReport, paths: Option<&Paths>) -> bool {
    let report_written = arguments.report.as_ref().is_none_or(|path| {
        let text = serde_json::to_string_pretty(report).map(|text| text + "\n");
        told("report", path, text.map_err(io::Error::from).and_then(|text| put(path, &text)))
    });
    let picture = arguments.paths.as_ref().zip(paths);
    let picture_written = picture.is_none_or(|(path, paths)| {
        told("picture", path, put(path, &paths.picture(&title(arguments), &outcome(report))))
    });
    report_written && picture_written
}

/// `-` is standard output.
fn put(path: &Path, text: &str) -> io::Result<()> {
    if path == Path::new("-") { try_print(text) } else { std::fs::write(path, text) }
}

fn told(what: &str, path: &Path, result: io::Result<()>) -> bool {
    if let Err(problem) = &result {
        eprint(&format!("error: the {what} could not be written to `{}`: {problem}\n", path.display()));
    }
    result.is_ok()
}

/// The names of the composites.
fn title(arguments: &RunArguments) -> String {
    let names = arguments.fleet.files.iter().filter_map(|path| path.file_stem());
    names.map(|name| name.to_string_lossy()).collect::<Vec<_>>().join(", ")
}
