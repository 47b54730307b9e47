//! The history that a run leaves (`--history`).

use std::path::{self, Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use clap::Args;
use saoms_control::{AlertList, LossCounts};
use saoms_history::{History, HistoryRun};

use super::RunArguments;
use super::alerts::FileAlert;
use super::control::fleet_name;
use crate::Exit;
use crate::arguments::duration;
use crate::output::{counted, eprint};

/// Options of `saoms run` for the history.
#[derive(Clone, Debug, Args)]
pub(crate) struct HistoryArguments {
    /// Write the history to this database of SQLite, which may have that of earlier runs: runs, all records of the
    /// journal, alerts, reports, and tables of the components. `saoms query` asks it, also while the fleet runs
    #[arg(long = "history", id = "history", value_name = "FILE")]
    pub(super) file: Option<PathBuf>,

    /// Remove records of the journal from the history that are older than this, such as `168h`: its file grows no more
    /// then. The other tables stay
    #[arg(long = "history-keep", value_name = "DURATION", requires = "history", allow_hyphen_values = true, value_parser = duration)]
    pub(super) keep: Option<Duration>,
}

/// Where the history is written, for those who ask it from another folder.
pub(super) fn path(arguments: &RunArguments) -> Option<PathBuf> {
    arguments.history.file.as_ref().map(|path| path::absolute(path).unwrap_or_else(|_| path.clone()))
}

/// The observer that writes it. Why it cannot is reported.
pub(super) fn open(path: &Path, arguments: &RunArguments, alerts: &Arc<AlertList>) -> Result<History, Exit> {
    let run = HistoryRun {
        name: fleet_name(arguments),
        composites: arguments.fleet.files.iter().map(|path| path.display().to_string()).collect(),
        node: arguments.node.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    let events = FileAlert::of("history", alerts);
    History::open(path, run, arguments.history.keep, Box::new(events)).map_err(|error| {
        eprint(&format!("error: `--history`: {error}\n\n1 error: nothing was started\n"));
        Exit::WrongInput
    })
}

/// True if rows of the history were lost, which is told.
pub(super) fn lacks_rows(losses: &LossCounts) -> bool {
    let lost = losses.history_rows.load(Ordering::Relaxed);
    if lost > 0 {
        let rows = counted(usize::try_from(lost).unwrap_or(usize::MAX), "row");
        eprint(&format!("error: the history lacks {rows}, which could not be written\n"));
    }
    lost > 0
}
