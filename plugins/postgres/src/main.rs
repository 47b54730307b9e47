//! The command `saoms-postgres`: brings the history of fleets, which `saoms run --history` writes into a file of
//! SQLite, to a PostgreSQL server. `docs/history.md` has its use.
//!
//! The file is the buffer: what is read from it is brought in batches, each a transaction that also says how far the
//! tables reach. So a batch is there as a whole or not at all, whatever ends the program, the server or the network,
//! and the next attempt goes on where the server says.

mod address;
mod arguments;
mod batch;
mod copier;
mod follow;
mod gaps;
mod looks;
mod problem;
mod server;
mod source;
mod stop;
mod table;
mod totals;

use std::io::Write;

use clap::Parser;

use address::Address;
use arguments::Arguments;
use follow::Task;
use problem::Problem;
use source::Source;
use stop::Stop;

/// The exit code of the process; documented in `saoms-postgres --help`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Exit {
    /// Everything asked for was done.
    Done = 0,
    /// The server went away, refused rows, or somebody stopped it before all was there.
    Failed = 1,
    /// The input is wrong.
    WrongInput = 2,
}

fn main() {
    let arguments = Arguments::parse();
    let exit = start(&arguments).unwrap_or_else(|text| {
        complain(&text);
        Exit::WrongInput
    });
    std::process::exit(exit as i32)
}

fn start(arguments: &Arguments) -> Result<Exit, String> {
    let address = Address::of(arguments)?;
    let source = Source::open(&arguments.file).map_err(|problem| match problem {
        Problem::Wrong(text) | Problem::Away(text) => text,
        Problem::Overtaken => String::new(),
    })?;
    let stop = Stop::on_signals().map_err(|error| format!("signals cannot be heard: {error}"))?;
    Ok(Task::new(arguments, &source, &address, &stop).execute())
}

/// Tells people of something that is wrong.
fn complain(text: &str) {
    tell("error", text);
}

/// Tells people of something that may be wrong.
fn warn(text: &str) {
    tell("warning", text);
}

fn tell(severity: &str, text: &str) {
    // Where standard error is closed nobody wants to know.
    let _ = writeln!(std::io::stderr(), "{severity}: {text}");
}
