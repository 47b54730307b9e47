use std::fs;
use std::path::{self, Path, PathBuf};

use saoms_core::store::Store;

use super::RunArguments;
use crate::Exit;
use crate::output::{displayed, eprint};

/// Opens the folder of `--state`, if there is one.
pub(super) fn open(arguments: &RunArguments) -> Result<Option<Store>, Exit> {
    let Some(folder) = &arguments.state else { return Ok(None) };
    let refuse = |message: &str| {
        eprint(&format!("error: {message}\n\n1 error: nothing was started\n"));
        Err(Exit::WrongInput)
    };
    if arguments.virtual_time {
        return refuse(
            "`--state` keeps what a fleet does in real time, and `--virtual` begins anew each time: leave one of them out",
        );
    }
    if let Some(option) = taken_by(arguments, folder) {
        let path = displayed(folder);
        return refuse(&format!(
            "`{option}` and `--state` both name `{path}`, which `--state` makes a folder: give `{option}` another path"
        ));
    }
    match Store::open(folder) {
        Ok(store) => Ok(Some(store)),
        Err(error) => refuse(&format!("the state of `--state` cannot be used: {error}")),
    }
}

/// The option that names the folder, too, for something of its own.
fn taken_by(arguments: &RunArguments, folder: &Path) -> Option<&'static str> {
    let control = arguments.control.as_deref().filter(|path| *path != "none").map(Path::new);
    let others = [
        ("--report", arguments.report.as_deref()),
        ("--paths", arguments.paths.as_deref()),
        ("--timeline", arguments.timeline.as_deref()),
        ("--journal", arguments.journal.as_deref()),
        ("--history", arguments.history.file.as_deref()),
        ("--log", arguments.log.log.as_deref()),
        ("--control", control),
    ];
    let of = |path: &Path| path::absolute(path).unwrap_or_else(|_| path.to_owned());
    others.into_iter().find(|(_, path)| path.is_some_and(|path| of(path) == of(folder))).map(|(option, _)| option)
}

/// The files in the folder, which no output may replace.
pub(super) fn files(arguments: &RunArguments) -> impl Iterator<Item = PathBuf> + use<'_> {
    let entries = arguments.state.iter().flat_map(fs::read_dir).flatten();
    entries.filter_map(|entry| Some(entry.ok()?.path()))
}
