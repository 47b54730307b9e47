//! What the command line takes.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, Parser, Subcommand, ValueEnum};

/// Deploys a fleet of self-adaptive robots from composite files.
#[derive(Debug, Parser)]
#[command(name = "saoms", version, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The command line. Where it is wrong, that is told and the process ends.
pub(crate) fn parsed() -> Arguments {
    Arguments::try_parse().unwrap_or_else(|mut error| {
        // Whoever names a composite alone wants to run it.
        if error.kind() == ErrorKind::InvalidSubcommand
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand)
            && Path::new(word).exists()
        {
            let tip = format!("to run a composite, write `saoms run {word}`");
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        error.exit()
    })
}

const EXIT_CODES: &str = "\
Exit codes:
  0    done, also when --for elapsed with work left (the report says so)
  1    the run failed: a component failed for good, a message was lost, a finished report or picture could not be written
  2    the input is wrong: a composite, a value, the command line, a place where no file can be; nothing was started
  130  ended by Ctrl-C";

const FMT_EXIT_CODES: &str = "\
Exit codes:
  0  every file is formatted now; with --check, was before
  1  with --check, a file is not formatted (its name is on standard output); else, a file could not be written
  2  a file cannot be read or is not well-formed XML (the diagnostics say where), and was left as it is; or a folder has no composites";

const GRAPH_EXIT_CODES: &str = "\
Exit codes:
  0  drawn, also where the composite has mistakes: what is missing is drawn so
  1  the picture could not be written
  2  the file cannot be read or is no composite, or nothing says the format";

const SCHEMA_EXIT_CODES: &str = "\
Exit codes:
  0  written; the names of the files are on standard output
  1  a file could not be written
  2  a plugin cannot be used";

const WHY_EXIT_CODES: &str = "\
Exit codes:
  0  answered, also when the answer is that the robot did nothing
  2  the input is wrong: no such robot, a time after the end of the run, a file without journal or not whole; or the records that the whole
     answer needs were overwritten";

const LSP_EXIT_CODES: &str = "\
Exit codes:
  0  the editor ended the session
  1  the editor went away without ending it";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Check composites and run the fleet that they describe together
    #[command(after_help = EXIT_CODES)]
    Run(RunArguments),
    /// Check composites without running anything
    #[command(after_help = EXIT_CODES)]
    Check(CheckArguments),
    /// Print the one composite that is left when includes, inner composites, property sources and wires are resolved
    #[command(after_help = EXIT_CODES)]
    Expand(ExpandArguments),
    /// Write composites in one layout: indentation, attributes, blank lines; order, comments and text stay
    #[command(after_help = FMT_EXIT_CODES)]
    Fmt(FmtArguments),
    /// Draw composites: components, services, references, properties, wires, promotions, topics
    #[command(after_help = GRAPH_EXIT_CODES)]
    Graph(GraphArguments),
    /// Tell why a robot did what it did, from the report or the journal of a run
    #[command(after_help = WHY_EXIT_CODES)]
    Why(WhyArguments),
    /// Make a plugin or a composite that works, to start from
    New(NewArguments),
    /// Write the language of composites, with all classes and properties, as XML schemas for editors
    #[command(after_help = SCHEMA_EXIT_CODES)]
    Schema(SchemaArguments),
    /// Serve editors over standard input and output: diagnostics, completion, and more (Language Server Protocol)
    #[command(after_help = LSP_EXIT_CODES)]
    Lsp(LspArguments),
    /// List the component classes, or describe one: properties, topics, services, references
    Components(ComponentsArguments),
}

/// What describes a fleet.
#[derive(Clone, Debug, Args)]
pub(crate) struct FleetArguments {
    /// Composite files, `-` for standard input; several form one fleet. A folder is a contribution: `check` looks at all of it, others
    /// take what its `sca-contribution.xml` calls deployable, or the only composite that runs by itself
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,

    /// Give a composite property another value; may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub(crate) settings: Vec<String>,

    /// Make diagnostics of a code `allow`ed, a `note`, a `warning` or an `error` where composites say nothing else; may be repeated
    #[arg(long = "severity", value_name = "CODE=LEVEL[:REASON]")]
    pub(crate) severities: Vec<String>,

    #[command(flatten)]
    pub(crate) plugins: PluginArguments,

    /// Refuse larger files
    #[arg(long, value_name = "SIZE", default_value = "256MB", value_parser = parse_size)]
    pub(crate) max_size: u64,
}

/// Where classes come from that are not linked into this program.
#[derive(Clone, Debug, Args)]
pub(crate) struct PluginArguments {
    /// Use the classes of this plugin, or of all plugins in this folder; may be repeated
    #[arg(long = "plugin", value_name = "PATH")]
    pub(crate) plugins: Vec<PathBuf>,

    /// Whether copies of libraries are loaded, because they may change.
    #[arg(skip)]
    pub(crate) copies: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    Human,
    Json,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CheckFormat {
    Human,
    Json,
    Sarif,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,

    /// How diagnostics are shown: for people on standard error, or on standard output as one JSON object or as SARIF 2.1.0
    #[arg(long, value_enum, default_value_t = CheckFormat::Human)]
    pub(crate) format: CheckFormat,

    /// Take classes that this program does not know as given, and implementations of other kinds: check all that can be checked without them
    #[arg(long)]
    pub(crate) assume_classes: bool,

    /// Report the wiring of the whole fleet: every topic with who publishes and reads it how often, and what is odd about it
    #[arg(long, conflicts_with = "assume_classes")]
    pub(crate) wiring: bool,
}

#[derive(Debug, Args)]
pub(crate) struct LspArguments {
    #[command(flatten)]
    pub(crate) plugins: PluginArguments,

    /// Take classes that this program does not know as given, as `saoms check --assume-classes` does
    #[arg(long)]
    pub(crate) assume_classes: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ExpandArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,

    /// Take classes that this program does not know as given, and implementations of other kinds: resolve all that can be resolved without them
    #[arg(long)]
    pub(crate) assume_classes: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,

    /// How diagnostics are shown: for people on standard error, or as one JSON object on standard output (on standard error once a fleet runs)
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub(crate) format: Format,

    /// End the run after this time (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long = "for", value_name = "DURATION", allow_hyphen_values = true, value_parser = saoms_api::parse_duration)]
    pub(crate) limit: Option<Duration>,

    /// Run in virtual time: the same fleet, deterministic, as fast as the machine goes
    #[arg(long = "virtual", conflicts_with = "realtime")]
    pub(crate) virtual_time: bool,

    /// Where chance starts: in virtual time the same seed gives the same run
    #[arg(long, value_name = "N", default_value_t = 0, allow_hyphen_values = true)]
    pub(crate) seed: u64,

    /// Write the report as JSON to this file, `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,

    /// Draw the robots' paths into this SVG file, `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) paths: Option<PathBuf>,

    /// Write every record of the journal to this file, as lines of JSON; the report holds the newest ones of each component
    #[arg(long, value_name = "FILE")]
    pub(crate) journal: Option<PathBuf>,

    /// Watch the libraries of plugins: components of one that is built anew are replaced while the fleet runs
    #[arg(long, conflicts_with = "virtual_time")]
    pub(crate) reload: bool,

    /// Show nothing but errors
    #[arg(long, conflicts_with = "console")]
    pub(crate) quiet: bool,

    /// Show what happens as `plain` lines, or as the `classic` console of the original
    #[arg(long, value_enum, value_name = "STYLE", default_value_t = ConsoleStyle::Plain)]
    pub(crate) console: ConsoleStyle,

    /// Run the timer under SCHED_FIFO with locked memory
    #[arg(long)]
    pub(crate) realtime: bool,

    /// How much later the kernel may wake the timer to save power; 1ns is the most punctual
    #[arg(long, value_name = "DURATION", default_value = "50us", allow_hyphen_values = true, value_parser = saoms_api::parse_duration)]
    pub(crate) timer_slack: Duration,

    /// How long an execution may hold up the others before a spare thread takes over
    #[arg(long, value_name = "DURATION", default_value = "1ms", allow_hyphen_values = true, value_parser = saoms_api::parse_duration)]
    pub(crate) budget: Duration,

    /// How long a component may take to end before it is abandoned
    #[arg(long, value_name = "DURATION", default_value = "2s", allow_hyphen_values = true, value_parser = saoms_api::parse_duration)]
    pub(crate) grace: Duration,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ConsoleStyle {
    Plain,
    Classic,
}

#[derive(Debug, Args)]
pub(crate) struct FmtArguments {
    /// Files to format in place; a folder stands for all composites in it and below, `-` is from standard input to standard output
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,

    /// Write nothing, and list the files that are not formatted
    #[arg(long)]
    pub(crate) check: bool,

    /// Columns that a start tag has to fit into; else each attribute but the first gets a line
    #[arg(long, value_name = "COLUMNS", default_value_t = saoms_tools::format::WIDTH)]
    pub(crate) width: usize,

    /// Refuse larger files
    #[arg(long, value_name = "SIZE", default_value = "256MB", value_parser = parse_size)]
    pub(crate) max_size: u64,
}

#[derive(Debug, Args)]
pub(crate) struct GraphArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,

    /// Where the picture goes; the ending says the format (`.svg`, `.mmd`, `.dot`), `-` is standard output
    #[arg(short, long, value_name = "PICTURE")]
    pub(crate) output: Option<PathBuf>,

    /// The format where no ending says it; SVG by default
    #[arg(long, value_enum)]
    pub(crate) format: Option<Picture>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Picture {
    /// A picture in the notation of SCA
    Svg,
    /// A flowchart for Mermaid, as Markdown viewers draw it
    Mermaid,
    /// A graph for Graphviz
    Dot,
}

#[derive(Debug, Args)]
pub(crate) struct SchemaArguments {
    /// The folder for the schemas, one for each namespace, and for `catalog.xml`, by which editors find them; made if it is not there
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,

    /// The version of XML Schema: 1.0, which every editor reads, or 1.1, which also holds components to the properties of their classes
    #[arg(long, value_enum, value_name = "VERSION", default_value_t = XsdVersion::V1_0)]
    pub(crate) xsd: XsdVersion,

    #[command(flatten)]
    pub(crate) plugins: PluginArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum XsdVersion {
    #[value(name = "1.0")]
    V1_0,
    #[value(name = "1.1")]
    V1_1,
}

#[derive(Debug, Args)]
pub(crate) struct WhyArguments {
    /// The robot, or any other component: its path, an ending of its path that no other has, or its ID
    pub(crate) robot: String,

    /// Ask what it did last up to this time of the run, and not up to its end (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = saoms_api::parse_duration)]
    pub(crate) at: Option<Duration>,

    /// The file of `saoms run --report`, or that of `saoms run --journal`; `-` is standard input
    #[arg(long, visible_alias = "journal", value_name = "FILE")]
    pub(crate) report: PathBuf,

    /// Text for people, or JSON
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct ComponentsArguments {
    /// The class to describe, by any of its names
    pub(crate) name: Option<String>,

    #[command(flatten)]
    pub(crate) plugins: PluginArguments,

    /// Text for people, or JSON
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub(crate) format: Format,
}

/// A size in bytes, or with one of the units kB, MB and GB.
fn parse_size(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let scale = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => Some(1),
        "k" | "kb" => Some(1_000),
        "m" | "mb" => Some(1_000_000),
        "g" | "gb" => Some(1_000_000_000),
        _ => None,
    };
    let size =
        digits.trim().parse::<u64>().ok().zip(scale).and_then(|(number, scale)| number.checked_mul(scale));
    size.ok_or_else(|| "expected a number of bytes, or a number with one of the units kB, MB, GB".to_owned())
}

#[derive(Debug, Args)]
pub(crate) struct NewArguments {
    #[command(subcommand)]
    pub(crate) what: NewWhat,
}

#[derive(Debug, Subcommand)]
pub(crate) enum NewWhat {
    /// Make the crate of a plugin: its code, its tests, and a composite that uses it
    Plugin {
        /// The folder to make; its name becomes that of the package
        path: PathBuf,

        /// What the plugin brings: a component, the hardware of a robot, or a loop of robots
        #[arg(long, value_enum, default_value_t = PluginKind::Component)]
        kind: PluginKind,

        /// Where saoms-api comes from: a folder with a checkout, a git URL, or a version; by default the checkout that made this program
        #[arg(long, value_name = "SOURCE")]
        api: Option<String>,
    },
    /// Make a composite with one robot
    Composite {
        /// The file to make
        path: PathBuf,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PluginKind {
    Component,
    Robot,
    Loop,
}
