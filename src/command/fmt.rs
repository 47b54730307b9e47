//! `saoms fmt`: writes composites in one layout.

use std::collections::HashSet;
use std::fmt::{self, Display};
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use clap::Args;
use saoms_lang::project::{INPUT, Refused, composite_files, document};
use saoms_tools::diagnostics::human;
use saoms_tools::format::Formatted;

use crate::Exit;
use crate::arguments::parse_size;
use crate::output::{Outputs, Place, displayed, eprint, eprint_coloured, print, print_as_is, replace};

const EXIT_CODES: &str = "\
Exit codes:
  0  every file is formatted; with --check, every file was formatted already
  1  with --check, a file is not formatted (its name is on standard output); without, a file could not be written
  2  a file cannot be read or is not well-formed XML (the diagnostics say where), and was left
     as it is; or a folder has no composites";

/// Format composites: indentation, attributes and blank lines; order, comments and text stay
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct FmtArguments {
    /// Files to format in place; a folder means all composites in it and below, `-` means from standard input to
    /// standard output
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,

    /// Write nothing, and list the files that are not formatted
    #[arg(long)]
    pub(crate) check: bool,

    /// The longest start tag that stays on one line; in a longer one, each attribute but the first has a line of its
    /// own
    #[arg(long, value_name = "COLUMNS", default_value_t = saoms_tools::format::WIDTH)]
    pub(crate) width: usize,

    /// Also format files outside the folder to which links in the folder lead
    #[arg(long)]
    pub(crate) allow_outside: bool,

    /// Refuse larger files
    #[arg(long, value_name = "SIZE", default_value = "256MB", value_parser = parse_size)]
    pub(crate) max_size: u64,
}

pub(crate) fn fmt(arguments: &FmtArguments) -> Exit {
    let (mut is_wrong, mut has_failed) = (false, false);
    let (mut files, refused) = composite_files(&arguments.files, arguments.allow_outside);
    if let Some(refused) = refused {
        eprint_coloured(&shown(&refused));
        is_wrong = true;
    }
    if let Err(exit) = Outputs::beside(files.iter().cloned()).with_streams() {
        return exit;
    }
    let mut seen = HashSet::with_capacity(files.len());
    files.retain(|path| seen.insert(path.clone()));
    for path in &files {
        match one(path, arguments) {
            Outcome::Formatted => {}
            Outcome::Unformatted => {
                print(&format!("{}\n", displayed(path)));
                has_failed = true;
            }
            Outcome::NotWritten(error) => {
                eprint(&format!("error: `{}` cannot be written: {error}\n", displayed(path)));
                has_failed = true;
            }
            Outcome::Wrong(diagnostics) => {
                eprint_coloured(&diagnostics);
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

/// The outcome for a file.
enum Outcome {
    /// It is, or was, formatted.
    Formatted,
    /// It is not, and `--check` writes nothing.
    Unformatted,
    /// It could not be written.
    NotWritten(io::Error),
    /// It is no XML, for these reasons.
    Wrong(String),
}

fn one(path: &Path, arguments: &FmtArguments) -> Outcome {
    let is_input = path == Path::new(INPUT);
    let document = match document(path, arguments.max_size) {
        Ok(document) => document,
        Err(refused) => return Outcome::Wrong(shown(&refused)),
    };
    let formatted = Formatted { document: &document, width: arguments.width };
    let is_same = is_same(&formatted, document.text());
    if arguments.check {
        return if is_same { Outcome::Formatted } else { Outcome::Unformatted };
    }
    let written = match (is_input, is_same) {
        (true, _) => {
            print_as_is(&formatted);
            Ok(())
        }
        (false, true) => Ok(()),
        // What links lead to is replaced, not the link.
        (false, false) => match Place::of(path) {
            Ok(Place::File(path)) => replace(&path, |to| write!(to, "{formatted}")),
            Ok(_) => Err(io::Error::other("it is not a regular file")),
            Err(error) => Err(error),
        },
    };
    written.map_or_else(Outcome::NotWritten, |()| Outcome::Formatted)
}

/// True if the value is displayed as this text, found without keeping it.
fn is_same(shown: &impl Display, text: &str) -> bool {
    struct Rest<'t>(&'t str);
    impl fmt::Write for Rest<'_> {
        fn write_str(&mut self, part: &str) -> fmt::Result {
            self.0 = self.0.strip_prefix(part).ok_or(fmt::Error)?;
            Ok(())
        }
    }
    let mut rest = Rest(text);
    fmt::Write::write_fmt(&mut rest, format_args!("{shown}")).is_ok() && rest.0.is_empty()
}

/// The reasons why files are refused, as people read them.
fn shown(refused: &Refused) -> String {
    human(&refused.diagnostics, &refused.sources, io::stderr().is_terminal())
}
