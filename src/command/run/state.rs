use std::fs;
use std::path::PathBuf;

use saoms_core::store::Store;

use super::RunArguments;
use crate::Exit;
use crate::output::eprint;

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
    match Store::open(folder) {
        Ok(store) => Ok(Some(store)),
        Err(error) => refuse(&format!("the state of `--state` cannot be used: {error}")),
    }
}

/// The files in the folder, which no output may replace.
pub(super) fn files(arguments: &RunArguments) -> impl Iterator<Item = PathBuf> + use<'_> {
    let entries = arguments.state.iter().flat_map(fs::read_dir).flatten();
    entries.filter_map(|entry| Some(entry.ok()?.path()))
}
