//! `saoms view`: shows a run that has ended in a browser.

use std::path::{Path, PathBuf};

use clap::Args;
use saoms_api::host::one_line;
use saoms_control::{FinishedRun, RunReadError, ViewServer};
use saoms_core::journal::JournalSource;

use super::why::{document, named, text};
use crate::Exit;
use crate::output::{Outputs, eprint, has_failed, print};

const EXIT_CODES: &str = "\
Exit codes:
  0    never, since the page is served until Ctrl-C
  1    standard output could not be written
  2    the input is wrong: no report, or one without a recording; a journal of another run; or the port is taken
  130  ended by Ctrl-C";

/// Show a run that has ended in a browser, with a slider over time: what its components and their loops did, plots,
/// alerts and the log
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ViewArguments {
    /// The file of `saoms run --report`; `-` is standard input
    #[arg(value_name = "FILE")]
    report: PathBuf,

    /// The file of `saoms run --journal` of the same run: it has all records of the loops, a report only the newest
    /// ones of each component
    #[arg(long, value_name = "FILE")]
    journal: Option<PathBuf>,

    /// The port at which the page is served, on this machine alone; 0 is one that the system chooses
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
}

pub(crate) fn view(arguments: &ViewArguments) -> Exit {
    let read = std::iter::once(&arguments.report).chain(&arguments.journal).cloned();
    if let Err(exit) = Outputs::beside(read).with_streams() {
        return exit;
    }
    match finished(arguments) {
        Ok(run) => serve(run, arguments.port),
        Err(problem) => {
            eprint(&format!("error: {problem}\n"));
            Exit::WrongInput
        }
    }
}

/// Serves the page of a run.
pub(super) fn serve(run: FinishedRun, port: u16) -> Exit {
    let (name, time) = (one_line(run.name()).into_owned(), run.time());
    let server = match ViewServer::start(run, port) {
        Ok(server) => server,
        Err(error) => {
            let help = if port == 0 { "" } else { "  = help: name another port, or none\n" };
            eprint(&format!("error: `--port {port}`: {error}\n{help}"));
            return Exit::WrongInput;
        }
    };
    print(&format!("{name}, {time}: open {} in a browser; Ctrl-C ends this\n", server.url()));
    // Without its address, nobody finds the page.
    while !has_failed() {
        std::thread::park();
    }
    Exit::Failed
}

/// The run to show, or what is wrong with its files.
fn finished(arguments: &ViewArguments) -> Result<FinishedRun, String> {
    let path = &arguments.report;
    let report = text(path).map_err(|problem| one_line(&problem).into_owned())?;
    let run = FinishedRun::read(&report).map_err(|error| {
        let (file, error_text) = (named(path), one_line(&error.to_string()).into_owned());
        format!("{file} cannot be shown: {error_text}{}", help(&error))
    })?;
    let Some(path) = &arguments.journal else { return Ok(run) };
    let journal = document(path).map_err(|problem| one_line(&problem).into_owned())?;
    if journal.source != JournalSource::File {
        return Err(format!("{} is no journal: it is a report\n  = help: leave `--journal` out", named(path)));
    }
    run.with_journal(journal).map_err(|problem| of_journal(path, &problem))
}

fn of_journal(path: &Path, problem: &str) -> String {
    format!("{} does not belong to this report: {problem}", named(path))
}

/// What to do about an error.
fn help(error: &RunReadError) -> &'static str {
    match error {
        RunReadError::NoReport(_) => "\n  = help: `saoms run FILE --report FILE` writes one",
        RunReadError::CutOff => "\n  = help: copy it again, or run again with `--report FILE`",
        RunReadError::NotRecorded => {
            "\n  = help: run again with `--report FILE` and without `--short-report`; of reports that were joined or rebuilt \
             from a journal, look at that of each program"
        }
        RunReadError::OtherVersion(_) => "\n  = help: use the version of `saoms` that wrote it",
        RunReadError::Malformed(_) => "",
    }
}
