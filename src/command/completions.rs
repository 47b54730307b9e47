//! `saoms completions`: completions of the command line for a shell.

use clap::{Args, Command};
use clap_complete::Shell;

use crate::Exit;
use crate::output::print;

/// Print completions of the command line for a shell
#[derive(Debug, Args)]
pub(crate) struct CompletionsArguments {
    /// The shell that reads them
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

pub(crate) fn completions(arguments: &CompletionsArguments, mut command: Command) -> Exit {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "saoms", &mut script);
    print(&String::from_utf8_lossy(&script));
    Exit::Done
}
