//! The command line of `saoms run`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};
use saoms_core::schedule::Speed;

use super::control::NetworkArguments;
use super::history::HistoryArguments;
use super::log_lines::LogArguments;
use super::recording::RecordingArguments;
use crate::arguments::{FleetArguments, Format, duration, parse_size};

const EXIT_CODES: &str = "\
Exit codes:
  0    done; also if --for or `saoms down` ended the run with work left (the report says so), or if
       the reader of standard output closed it
  1    the run failed: a component failed for good, a message was lost, a report, picture or standard output could not be
       written; or it is incomplete: work was given up
  2    the input is wrong: a composite, a value or the command line; or an output cannot be written, or is an input;
       nothing was started
  130  ended by Ctrl-C, SIGTERM or SIGHUP (a lost terminal, unless `hangup` of the composite is `hold` or `goOn`)";

/// Check composites and run the fleet that they describe together
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,

    /// Run only the components of this node (`saoms:node`): those of the other nodes run in other programs. All of the
    /// fleet is checked
    #[arg(long, value_name = "NAME", conflicts_with = "virtual_time")]
    pub(crate) node: Option<String>,

    /// The format of diagnostics: for people on standard error, or as one JSON object on standard output (on standard
    /// error once a fleet runs)
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub(crate) format: Format,

    /// End the run after this time (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long = "for", value_name = "DURATION", allow_hyphen_values = true, value_parser = duration)]
    pub(crate) limit: Option<Duration>,

    /// Wait no longer than this for a message broker that is not there, and end with an error then; `0s` is not at all.
    /// Without it, components wait for their broker for ever
    #[arg(long, value_name = "DURATION", conflicts_with = "virtual_time", allow_hyphen_values = true, value_parser = duration)]
    pub(crate) connect_timeout: Option<Duration>,

    /// When the run ends, wait so long for programs of its networks that are away and have not received all events.
    /// Those that they lack then are lost, and the run has failed; `0s` waits for nobody who is away
    #[arg(long, value_name = "DURATION", default_value = "60s", conflicts_with = "virtual_time", allow_hyphen_values = true, value_parser = duration)]
    pub(crate) linger: Duration,

    /// Memory for events that programs of its networks have not received yet: what is beyond it is lost, and the run
    /// has failed
    #[arg(long, value_name = "SIZE", default_value = "256MB", conflicts_with = "virtual_time", value_parser = parse_size)]
    pub(crate) backlog: u64,

    /// Run in virtual time: deterministic, and as fast as the machine allows
    #[arg(long = "virtual", conflicts_with_all = ["realtime", "timer_slack", "budget"])]
    pub(crate) virtual_time: bool,

    /// Seed of the random numbers: in virtual time, the same seed gives the same run
    #[arg(long, value_name = "N", default_value_t = 0, allow_hyphen_values = true, value_parser = seed)]
    pub(crate) seed: u64,

    /// Write the report as JSON to this file, `-` for standard output; `saoms view FILE` shows the run
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,

    /// Leave the records of the journal and the recording for `saoms view` out of the report: they take megabytes
    /// after a long run. The counts of the records stay
    #[arg(long, requires = "report")]
    pub(crate) short_report: bool,

    /// Draw the paths of the robots to this SVG file, one world below the other; `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) paths: Option<PathBuf>,

    /// Draw the run over time to this SVG file: finished and open work, the robots that are awake, their batteries, and
    /// how the fleet adapted to each event; `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) timeline: Option<PathBuf>,

    /// Write all records of the journal to this file, as lines of JSON; the report has only the newest records of each
    /// component
    #[arg(long, value_name = "FILE")]
    pub(crate) journal: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) history: HistoryArguments,

    #[command(flatten)]
    pub(crate) recording: RecordingArguments,

    /// Read events from this file, or as they come from standard input (`-`): one scenario line each, such as `at 3s
    /// luggage (3,1) to (3,10)`; an event without a time happens at once. A wrong line is reported and ignored
    #[arg(long, value_name = "FILE")]
    pub(crate) events: Option<PathBuf>,

    /// Put the faults of this file into the run: lines of a scenario, such as `at 10s for 30s lose 20 % on POSTOPIC`. A
    /// wrong line is an error before anything starts
    #[arg(long, value_name = "FILE")]
    pub(crate) faults: Option<PathBuf>,

    /// Keep the fleet in this folder: the same command goes on from there, after a crash, a power failure or a usual
    /// end. The folder is made if it is missing; no other program may use it meanwhile
    #[arg(long, value_name = "FOLDER")]
    pub(crate) state: Option<PathBuf>,

    /// Hold the run to the invariants of its components, as `saoms simulate` does: violations are reported, and the
    /// exit code is 1 then. In virtual time, a standstill ends the run before `--for`
    #[arg(long)]
    pub(crate) invariants: bool,

    /// Keep running when all work is done, for events that are sent later: until `saoms down`, a signal, or the time of
    /// `--for`
    #[arg(long)]
    pub(crate) stay: bool,

    /// Pause before the first executions, until `saoms resume`
    #[arg(long)]
    pub(crate) paused: bool,

    /// Seconds of virtual time in a second, such as `1`, `10` or `0.5`; without this option, as fast as the machine
    /// allows. `saoms speed` changes it
    #[arg(long, value_name = "FACTOR|max", requires = "virtual_time")]
    pub(crate) speed: Option<Speed>,

    /// The socket at which commands such as `saoms status` reach the fleet, or `none`. The default in real time is
    /// `NAME-PID.sock` in `$XDG_RUNTIME_DIR/saoms`, or in `/tmp/saoms-UID` without that folder; in virtual time a fleet
    /// has a socket only with `--stay`, `--paused` or `--speed`
    #[arg(long, value_name = "PATH|none")]
    pub(crate) control: Option<String>,

    /// Deliver alerts to the address and the command that the composite names (`alertUrl`, `alertCommand`): without
    /// this, a composite sends nothing and runs no command
    #[arg(long)]
    pub(crate) alerts: bool,

    /// Call the web servers to which references of the composite lead (`binding.rest`), with the tokens in the
    /// environment variables that it names: without this, a composite sends nothing
    #[arg(long)]
    pub(crate) allow_web: bool,

    #[command(flatten)]
    pub(crate) log: LogArguments,

    #[command(flatten)]
    pub(crate) network: NetworkArguments,

    /// Watch the libraries of plugins: when a library is rebuilt, its components are replaced while the fleet runs
    #[arg(long, conflicts_with = "virtual_time")]
    pub(crate) reload: bool,

    /// Watch the files of the composites: when they change, the fleet becomes what they describe, as `saoms apply` does
    /// it. Files with errors, and changes that would lose a state, change nothing
    #[arg(long, conflicts_with = "virtual_time")]
    pub(crate) watch: bool,

    /// Show only errors
    #[arg(long, conflicts_with = "console")]
    pub(crate) quiet: bool,

    /// The style of the console: `plain` lines, or `classic`, as the original program printed them
    #[arg(long, value_enum, value_name = "STYLE", default_value_t = ConsoleStyle::Plain)]
    pub(crate) console: ConsoleStyle,

    /// Run the timer under SCHED_FIFO with locked memory, in real time
    #[arg(long, conflicts_with = "timer_slack")]
    pub(crate) realtime: bool,

    /// The delay that the kernel may add to the timer to save power, in real time without `--realtime`; 1ns is the most
    /// punctual
    #[arg(long, value_name = "DURATION", default_value = "50us", allow_hyphen_values = true, value_parser = duration)]
    pub(crate) timer_slack: Duration,

    /// The time that an execution may delay the others before a spare thread takes over, in real time
    #[arg(long, value_name = "DURATION", default_value = "1ms", allow_hyphen_values = true, value_parser = duration)]
    pub(crate) budget: Duration,

    /// The time that a component may take to end before it is abandoned, and that a blocked standard output may delay
    /// the end after a signal
    #[arg(long, value_name = "DURATION", default_value = "2s", allow_hyphen_values = true, value_parser = duration)]
    pub(crate) grace: Duration,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ConsoleStyle {
    Plain,
    Classic,
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("expected a whole number from 0 to {}", u64::MAX))
}
