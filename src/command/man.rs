//! `saoms man`: the manual pages of all commands.

use std::fs;
use std::path::PathBuf;

use clap::{Args, Command};

use crate::Exit;
use crate::output::{eprint, print};

const EXIT_CODES: &str = "\
Exit codes:
  0  written; the folder is on standard output
  1  a page could not be written";

/// Write manual pages of all commands
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ManArguments {
    /// The folder for the pages, such as `~/.local/share/man/man1`; made if it is not there
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
}

pub(crate) fn man(arguments: &ManArguments, command: Command) -> Exit {
    let folder = &arguments.output;
    match fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(command, folder)) {
        Ok(()) => {
            print(&format!("{}\n", folder.display()));
            Exit::Done
        }
        Err(error) => {
            eprint(&format!("error: manual pages cannot be written to `{}`: {error}\n", folder.display()));
            Exit::Failed
        }
    }
}
