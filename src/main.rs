//! The command `saoms`: loads composites, checks them, and runs the fleet that they describe.
//!
//! One file per subcommand; each returns the process's exit code. What the machine does is in `saoms-core`; the components that ship are in
//! `saoms-components`, which is linked here and known nowhere else; of its
//! messages, the picture of the robots' paths knows those that it draws.

mod arguments;
mod check;
mod components;
mod console;
mod expand;
mod fleet;
mod fmt;
mod folder;
mod graph;
mod lsp;
mod memory;
mod new;
mod output;
mod paths;
mod plugins;
mod reload;
mod results;
mod run;
mod schema;
mod summary;
mod svg;
mod watch;
mod why;
mod wiring;

use std::process::ExitCode;

use saoms_components as _;

#[global_allocator]
static MEMORY: memory::Memory = memory::Memory;

use crate::arguments::Command;

/// How the process ends; documented in `saoms --help`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Exit {
    /// Everything asked for was done.
    Done = 0,
    /// The run failed, or what was to be written could not be, or was found not to be as asked.
    Failed = 1,
    /// The input is wrong and nothing was started.
    WrongInput = 2,
    /// Ctrl-C ended the run.
    Interrupted = 130,
}

fn main() -> ExitCode {
    // clap itself ends with 2 on a wrong command line, which is wrong input too.
    let exit = match arguments::parsed().command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Check(arguments) => check::check(&arguments),
        Command::Expand(arguments) => expand::expand(&arguments),
        Command::Fmt(arguments) => fmt::fmt(&arguments),
        Command::Graph(arguments) => graph::graph(&arguments),
        Command::Schema(arguments) => schema::schema(&arguments),
        Command::Why(arguments) => why::why(&arguments),
        Command::Lsp(arguments) => lsp::lsp(&arguments),
        Command::New(arguments) => new::new(&arguments),
        Command::Components(arguments) => components::components(&arguments),
    };
    ExitCode::from(exit as u8)
}
