use std::path::PathBuf;
use std::time::Duration;

use clap::Parser;
use saoms_api::host::parse_duration;

const EXIT_CODES: &str = "\
Exit codes:
  0  all is in PostgreSQL; with --follow: ended by SIGTERM or Ctrl-C
  1  the server went away, or refused rows, or it was stopped before all was there
  2  the input is wrong: the file, the server, the schema, the command line";

/// Bring the history of fleets to a PostgreSQL server, also while they run
///
/// The history is a file that `saoms run --history FILE` writes. Its tables and columns have the same names there. A
/// password comes from the variable PGPASSWORD, or from ~/.pgpass.
#[derive(Debug, Parser)]
#[command(name = "saoms-postgres", version, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    /// The history: a file of `saoms run --history`
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// The database, such as `postgres:///fleet?host=/run/postgresql` or
    /// `postgres://ada@server/fleet?sslmode=verify-full`
    #[arg(long, value_name = "URL", required_unless_present = "to_env", conflicts_with = "to_env")]
    pub(crate) to: Option<String>,

    /// The same, from this variable of the environment, where it may have a password
    #[arg(long, value_name = "VARIABLE")]
    pub(crate) to_env: Option<String>,

    /// The schema of the tables. It is made if it is missing
    #[arg(long, value_name = "NAME", default_value = "saoms", value_parser = schema)]
    pub(crate) schema: String,

    /// Go on with what is written from now on, until SIGTERM or Ctrl-C; wait for a server that is away
    #[arg(long)]
    pub(crate) follow: bool,

    /// Remove records of the journal from PostgreSQL that are older than this, such as `8760h`. Without it they stay,
    /// whatever `saoms run --history-keep` removes from the file
    #[arg(long, value_name = "DURATION", allow_hyphen_values = true, value_parser = parse_duration)]
    pub(crate) keep: Option<Duration>,
}

/// The longest name that PostgreSQL does not cut.
const LONGEST: usize = 63;

fn schema(name: &str) -> Result<String, String> {
    let is_good = !name.is_empty() && name.len() <= LONGEST && !name.contains('\0') && !name.starts_with("pg_");
    if is_good {
        Ok(name.to_owned())
    } else {
        Err(format!("expected a name of {LONGEST} bytes at most that does not begin with `pg_`"))
    }
}
