//! The command `saoms`: loads composites, checks them, and runs the fleet that they describe.
//!
//! `command` has one file per subcommand; each returns the process's exit code. The machinery is in `saoms-core`; the
//! components that ship are in `saoms-components`, which is linked here and known nowhere else.

mod arguments;
mod command;
mod environment;
mod fleet;
mod guard;
mod lsp;
mod output;
mod plugins;

use saoms_components as _;

/// The exit code of the process; documented in `saoms --help`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Exit {
    /// Everything asked for was done.
    Done = 0,
    /// The run failed or is incomplete, or what was to be written could not be, or was found not to be as asked.
    Failed = 1,
    /// The input is wrong and nothing was started.
    WrongInput = 2,
    /// A plan has changes.
    Changes = 3,
    /// Ctrl-C ended the run.
    Interrupted = 130,
}

fn main() {
    // SAFETY: this is the first thing that the process does.
    unsafe { environment::prepare() };
    // clap itself ends with 2 on a wrong command line, which is wrong input too.
    let exit = command::execute();
    // Whatever else there is to say of it: who reads the output lacks a part.
    let exit = if output::has_failed() { Exit::Failed } else { exit };
    guard::exit(exit as i32)
}
