//! `saoms fmt`: writes composites in one layout.

use std::collections::HashSet;
use std::fs::{self, OpenOptions};
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use saoms_core::diagnostic::{Diagnostics, human};
use saoms_core::format::format;
use saoms_core::load::composites_below;
use saoms_core::source::{FileId, Sources};
use saoms_core::xml;

use crate::Exit;
use crate::arguments::FmtArguments;
use crate::fleet::{INPUT, read_or_input};
use crate::output::{eprint, print, try_print};

pub(crate) fn fmt(arguments: &FmtArguments) -> Exit {
    let (mut is_wrong, mut has_failed) = (false, false);
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let mut files: Vec<PathBuf> = Vec::with_capacity(arguments.files.len());
    for path in &arguments.files {
        match path.is_dir() {
            true => files.extend(composites_below(path, &mut sources, &mut diagnostics)),
            false => files.push(path.clone()),
        }
    }
    if diagnostics.has_errors() {
        eprint(&human(&diagnostics.into_sorted(), &sources, io::stderr().is_terminal()));
        is_wrong = true;
    }
    let mut seen = HashSet::with_capacity(files.len());
    files.retain(|path| seen.insert(path.clone()));
    for path in &files {
        match one(path, arguments) {
            Outcome::Formatted => {}
            Outcome::Unformatted => {
                print(&format!("{}\n", path.display()));
                has_failed = true;
            }
            Outcome::NotWritten(error) => {
                eprint(&format!("error: `{}` cannot be written: {error}\n", path.display()));
                has_failed = true;
            }
            Outcome::Wrong(diagnostics) => {
                eprint(&diagnostics);
                is_wrong = true;
            }
        }
    }
    match (is_wrong, has_failed) {
        (true, _) => Exit::WrongInput,
        (_, true) => Exit::Failed,
        _ => Exit::Done,
    }
}

/// What came of a file.
enum Outcome {
    /// It is, or was, formatted.
    Formatted,
    /// It is not, and nobody wants it to be.
    Unformatted,
    /// It could not be written.
    NotWritten(io::Error),
    /// It is no XML, for these reasons.
    Wrong(String),
}

fn one(path: &Path, arguments: &FmtArguments) -> Outcome {
    let is_input = path == Path::new(INPUT);
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = read_or_input(path, arguments.max_size, &mut sources, &mut diagnostics);
    let formatted = file.and_then(|file| formatted(file, arguments.width, &sources, &mut diagnostics));
    let (Some(file), Some(formatted)) = (file, formatted) else {
        let diagnostics = diagnostics.into_sorted();
        return Outcome::Wrong(human(&diagnostics, &sources, io::stderr().is_terminal()));
    };
    let is_same = **sources.get(file).text() == *formatted;
    if arguments.check {
        return if is_same { Outcome::Formatted } else { Outcome::Unformatted };
    }
    let written = match (is_input, is_same) {
        (true, _) => try_print(&formatted),
        (false, true) => Ok(()),
        (false, false) => replace(path, &formatted),
    };
    written.map_or_else(Outcome::NotWritten, |()| Outcome::Formatted)
}

/// The formatted text, unless the file is not well-formed.
fn formatted(file: FileId, width: usize, sources: &Sources, diagnostics: &mut Diagnostics) -> Option<String> {
    let parsed = xml::parse(file, sources.get(file).text());
    match (parsed.fault, parsed.document) {
        (None, Some(document)) => Some(format(&document, width)),
        (fault, _) => {
            fault.into_iter().for_each(|one| diagnostics.push(one));
            None
        }
    }
}

/// Gives the file another text, whole or not at all: the text is written beside it and takes its name.
fn replace(path: &Path, text: &str) -> io::Result<()> {
    // What links lead to is replaced, not the link.
    let path = fs::canonicalize(path)?;
    let about = fs::metadata(&path)?;
    if !about.is_file() {
        return Err(io::Error::other("it is no regular file"));
    }
    // A file that its user may not write is not replaced either.
    OpenOptions::new().write(true).open(&path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(text.as_bytes())?;
    file.as_file().set_permissions(about.permissions())?;
    file.as_file().sync_all()?;
    file.persist(&path)?;
    Ok(())
}
