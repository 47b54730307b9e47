//! `saoms man`: the manual pages of all commands.

use std::path::PathBuf;

use clap::builder::Resettable;
use clap::{Args, Command};
use clap_mangen::Man;

use crate::Exit;
use crate::output::{print, write_into};

const EXIT_CODES: &str = "\
Exit codes:
  0  written; the folder is on standard output
  1  a page could not be written
  2  the folder is a file, or two pages would have the same file name";

/// Write manual pages of all commands
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ManArguments {
    /// The folder for the pages, such as `~/.local/share/man/man1`; it is made if it does not exist
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
}

pub(crate) fn man(arguments: &ManArguments, command: Command) -> Exit {
    let folder = &arguments.output;
    // Pages do not depend on the build that writes them.
    let mut command = command.disable_help_subcommand(true).long_version(Resettable::Reset);
    command.build();
    let mut pages = Vec::new();
    add(command, &mut pages);
    let mut texts = Vec::with_capacity(pages.len());
    for page in pages {
        let mut text = Vec::new();
        // Memory takes all that is written to it.
        let _ = page.render(&mut text);
        texts.push((folder.join(page.get_filename()), text));
    }
    match write_into("manual page", folder, &texts, Vec::new()) {
        Ok(()) => {
            print(&format!("{}\n", folder.display()));
            Exit::Done
        }
        Err(refused) => refused.told(),
    }
}

/// Adds the pages of a command and of those below it.
fn add(command: Command, pages: &mut Vec<Man>) {
    command.get_subcommands().filter(|one| !one.is_hide_set()).for_each(|one| add(one.clone(), pages));
    pages.push(Man::new(command));
}
