//! `saoms replay`: shows a recorded run in a browser, or runs one of its components again, alone.

mod component;

use std::path::{Path, PathBuf};

use clap::Args;
use saoms_api::host::one_line;
use saoms_control::{FinishedRun, RunReadError};
use saoms_recording::{Part, REPORT};

use super::record::{open, unreadable};
use super::view::serve;
use crate::Exit;
use crate::output::{displayed, eprint};

const EXIT_CODES: &str = "\
Exit codes:
  0    with `--component`: it does all that it did then, as far as its tape goes; else never, since the page is served
       until Ctrl-C
  1    with `--component`: it does something else; or standard output could not be written, or the recording not be read
  2    the input is wrong: no recording, one of another program, one without a tape of the component, or for the page one
       that was not finished; a class that is not there, a composite with errors, or the port is taken
  130  ended by Ctrl-C";

/// Show a recorded run in a browser, as `saoms view` does with a report, with a slider over time, a pause and a speed;
/// or run one of its components again, alone, with the code of today, and say where it does something else than then
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ReplayArguments {
    /// The file of `saoms run --record`; of several files of a run the last one, and with `--component` all of them in
    /// their order
    #[arg(value_name = "FILE", required = true)]
    recordings: Vec<PathBuf>,

    /// The port at which the page is served, on this machine alone; 0 is one that the system chooses
    #[arg(long, value_name = "PORT", default_value_t = 0, conflicts_with = "component")]
    port: u16,

    #[command(flatten)]
    component: component::ComponentArguments,
}

pub(crate) fn replay(arguments: &ReplayArguments) -> Exit {
    if let Some(exit) = component::replay(&arguments.recordings, &arguments.component) {
        return exit;
    }
    let [recording] = &arguments.recordings[..] else {
        eprint("error: the page shows one file: of several files of a run, name the last one\n");
        return Exit::WrongInput;
    };
    match finished(recording) {
        Ok(run) => serve(run, arguments.port),
        Err(exit) => exit,
    }
}

/// The run of a recording. What is wrong with it is reported.
fn finished(path: &Path) -> Result<FinishedRun, Exit> {
    let mut reader = open(path)?;
    let mut report = None;
    while let Some(part) = reader.next_part().map_err(|error| unreadable(&error))? {
        if let Part::File(file) = part
            && file.name == REPORT
        {
            report = Some(file.data);
        }
    }
    let wrong = |why: &str| {
        eprint(&format!("error: `{}` cannot be shown: {why}\n", displayed(path)));
        Exit::WrongInput
    };
    let Some(report) = report else {
        let why = match (reader.cut(), reader.start()) {
            (Some(_), _) => {
                "it was not finished, and what the page shows is at its end\n  = help: `saoms record cat` prints its messages"
            }
            (None, None) => "it is not of `saoms run --record`",
            (None, Some(_)) => "it has no report\n  = help: of several files of a run, show the last one",
        };
        return Err(wrong(why));
    };
    let text = String::from_utf8(report).map_err(|_| wrong("its report is no text"))?;
    FinishedRun::read(&text).map_err(|error| match error {
        RunReadError::NotRecorded => wrong(
            "it has the messages of a large fleet alone, and no samples of it\n  = help: run again with `--record FILE` and \
             `--report FILE`",
        ),
        // Only a program of another version wrote what cannot be shown.
        error => wrong(&one_line(&error.to_string())),
    })
}
