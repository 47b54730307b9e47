//! Files that a run leaves behind: tried before it starts, written when it has ended.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use super::RunArguments;
use crate::output::{counted, eprint, try_print};

/// True if the files can be written, asked before a run that may last for days. What they hold stays until there is
/// something new. A file that cannot be written has been reported.
pub(super) fn are_writable(arguments: &RunArguments) -> bool {
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
        for (other, option, _) in files[place + 1..].iter().filter(|(_, _, other)| other.as_ref() == Some(path)) {
            problems.push(format!(
                "error: the {what} and the {other} cannot both be written to `{}`\n  = help: give `{option}` another file\n",
                path.display()
            ));
        }
    }
    if arguments.journal.as_deref() == Some(Path::new("-")) {
        let problem = "error: the journal cannot be written to standard output, which is for the lines of the run\n";
        problems.push(format!("{problem}  = help: give `--journal` a file\n"));
    }
    if !problems.is_empty() {
        eprint(&format!("{}\n{}: nothing was started\n", problems.concat(), counted(problems.len(), "error")));
    }
    problems.is_empty()
}

/// Tries whether a file can be written, without a trace: a file that exists stays as it is, and no other one exists
/// afterwards.
fn try_open(path: &Path) -> io::Result<()> {
    if path == Path::new("-") {
        return Ok(());
    }
    match File::options().append(true).open(path) {
        Err(problem) if problem.kind() == io::ErrorKind::NotFound => {}
        result => return result.map(drop),
    }
    // A link to a file that does not exist yet.
    if let Ok(target) = path.read_link() {
        return try_open(&path.parent().unwrap_or(Path::new("")).join(target));
    }
    // Only a file created here is removed: if another process was faster, this is an error.
    File::create_new(path)?;
    std::fs::remove_file(path)
}

/// A file to write when a run has ended.
#[derive(Debug)]
pub(super) struct Output {
    what: &'static str,
    path: PathBuf,
    has_failed: AtomicBool,
}

impl Output {
    pub(super) fn new(what: &'static str, path: &Path) -> Output {
        Output { what, path: path.to_owned(), has_failed: AtomicBool::new(false) }
    }

    /// Writes the text, to standard output where the path is `-`. A failure is reported.
    pub(super) fn write(&self, text: io::Result<String>) {
        let put = |text: String| match self.path == Path::new("-") {
            true => try_print(&text),
            false => std::fs::write(&self.path, text),
        };
        if let Err(problem) = text.and_then(put) {
            let (what, path) = (self.what, self.path.display());
            eprint(&format!("error: the {what} could not be written to `{path}`: {problem}\n"));
            self.has_failed.store(true, Ordering::Relaxed);
        }
    }

    /// True if it could not be written.
    pub(super) fn has_failed(&self) -> bool {
        self.has_failed.load(Ordering::Relaxed)
    }
}
