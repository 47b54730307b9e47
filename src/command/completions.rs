//! `saoms completions`: completions of the command line for a shell.

use clap::{Args, Command};
use clap_complete::Shell;

use crate::Exit;
use crate::output::print_as_is;

const EXIT_CODES: &str = "\
Exit codes:
  0  printed
  1  standard output could not be written
  2  the shell is not supported";

/// Print completions of the command line for a shell
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct CompletionsArguments {
    /// The shell that reads them
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

pub(crate) fn completions(arguments: &CompletionsArguments, mut command: Command) -> Exit {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "saoms", &mut script);
    print_as_is(&String::from_utf8_lossy(&script));
    Exit::Done
}
