//! `saoms run`: checks composites and runs the fleet that they describe.

mod alerts;
mod console;
mod control;
mod ending;
mod events;
pub(super) mod faults;
mod history;
mod log_file;
mod log_lines;
mod networks;
mod notify;
mod outputs;
mod picture;
mod picture_file;
mod reload;
mod report_file;
mod state;
mod status_line;
mod summary;
mod timeline_file;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use clap::{Args, ValueEnum};
use saoms_api::Level;
use saoms_api::extension::{EventLanguage, PictureRegistration};
use saoms_api::host::one_line;
use saoms_control::{AlertList, LossCounts};
use saoms_core::observe::{AdaptationWatch, InvariantWatch, Observer};
use saoms_core::report::RunStatus;
use saoms_core::schedule::{ClockKind, Handle, RunningFleet, Settings, Speed};
use saoms_lang::assembly::Assembly;
use saoms_lang::diagnostic::Severity;
use saoms_lang::project::INPUT;

use crate::Exit;
use crate::arguments::{FleetArguments, Format, duration};
use crate::fleet::{DiagnosticReport, compiled, files_read, has_components};
use crate::guard::has_own_end;
use crate::output::{Outputs, counted, displayed, eprint, eprint_coloured, eprint_json, limit_patience, print_json};
use alerts::AlertDelivery;
use console::Console;
use control::{Control, NetworkArguments};
pub(super) use ending::is_ignored;
use ending::{Signalled, end_without_reader};
use events::{Events, Numbers, Unreadable};
use faults::{FaultScript, Known, play_all, report_wrong};
use history::HistoryArguments;
use log_file::LogFile;
use log_lines::{LogArguments, LogStyle};
pub(super) use networks::read_private;
use networks::{Door, Networks, Refused};
use notify::Notifier;
use outputs::{Output, RunFiles};
use picture_file::PictureFile;
use reload::{Reload, Watched};
use report_file::ReportFile;
use timeline_file::TimelineFile;

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

    /// Run in virtual time: deterministic, and as fast as the machine allows
    #[arg(long = "virtual", conflicts_with_all = ["realtime", "timer_slack", "budget"])]
    pub(crate) virtual_time: bool,

    /// Seed of the random numbers: in virtual time, the same seed gives the same run
    #[arg(long, value_name = "N", default_value_t = 0, allow_hyphen_values = true, value_parser = seed)]
    pub(crate) seed: u64,

    /// Write the report as JSON to this file, `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,

    /// Leave the records of the journal out of the report: they take megabytes after a long run. Their counts stay
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

    #[command(flatten)]
    pub(crate) log: LogArguments,

    #[command(flatten)]
    pub(crate) network: NetworkArguments,

    /// Watch the libraries of plugins: when a library is rebuilt, its components are replaced while the fleet runs
    #[arg(long, conflicts_with = "virtual_time")]
    pub(crate) reload: bool,

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

pub(crate) fn run(arguments: &RunArguments) -> Exit {
    let signals = Signalled::new(arguments.grace);
    let files = &arguments.fleet;
    if arguments.reload && files.files.iter().any(|path| path == Path::new(INPUT)) {
        eprint("error: `--reload` reads composites again, which standard input cannot be\n");
        return Exit::WrongInput;
    }
    if let Some(why) = arguments.log.without_effect(arguments) {
        eprint(&format!("error: {why}\n"));
        return Exit::WrongInput;
    }
    let from_input = |path: &PathBuf| path == Path::new(INPUT);
    if arguments.events.as_ref().is_some_and(from_input) && files.files.iter().any(from_input) {
        eprint(
            "error: composite and events cannot both be read from standard input\n  = help: give one of them a file\n",
        );
        return Exit::WrongInput;
    }
    let Some((assembly, networks, read)) = assembly(arguments, files) else { return Exit::WrongInput };
    if let Err(exit) = Outputs::beside(arguments.events.clone()).with_streams() {
        return exit;
    }
    let numbers = Numbers::new(arguments.seed);
    let events = arguments.events.as_deref().map(|path| (path, Events::open(path, &numbers)));
    let events = match events {
        Some((path, Err(Unreadable { message, help }))) => {
            let path = displayed(path);
            let help = help.map(|help| format!("  = help: {help}\n")).unwrap_or_default();
            eprint(&format!(
                "error: the events cannot be read from `{path}`: {message}\n{help}\n1 error: nothing was started\n"
            ));
            return Exit::WrongInput;
        }
        Some((_, Ok(events))) => Some(events),
        None => None,
    };
    let mut faults = Vec::new();
    if let Some(path) = &arguments.faults {
        let Some(script) = FaultScript::read(path) else { return Exit::WrongInput };
        match script.events(&Known::of(&assembly, &arguments.fleet.severities), arguments.seed) {
            Ok(planned) => {
                if !arguments.quiet {
                    eprint(&planned.lowered.concat());
                }
                faults = planned.events;
            }
            Err(wrong) => {
                report_wrong(&wrong);
                return Exit::WrongInput;
            }
        }
    }
    let store = match state::open(arguments) {
        Ok(store) => store,
        Err(exit) => return exit,
    };
    let paths = PictureRegistration::linked("paths");
    if arguments.paths.is_some() && paths.is_none() {
        eprint("error: no component class of this program draws paths\n");
        return Exit::WrongInput;
    }
    let watched = arguments.reload.then(|| Watched::of(&assembly));
    if watched.as_ref().is_some_and(Watched::is_empty) {
        eprint(
            "error: `--reload` has nothing to watch: no component of the fleet comes from a plugin\n  = help: leave it out, or name the plugin with `--plugin`\n\n1 error: nothing was started\n",
        );
        return Exit::WrongInput;
    }
    let style = LogStyle::of(&arguments.log, &assembly);
    let read = read.into_iter().chain(state::files(arguments)).collect();
    let Some(files_written) = RunFiles::of(arguments, read, style) else { return Exit::WrongInput };
    let RunFiles { report, picture, timeline, journal, history, log } = files_written;
    let alerts: Arc<AlertList> = Arc::default();
    let history = match history.map(|path| history::open(&path, arguments, &alerts)).transpose() {
        Ok(history) => history,
        Err(exit) => return exit,
    };
    let mut delivery = match AlertDelivery::of(arguments, &assembly.run, &alerts) {
        Ok(delivery) => delivery,
        Err(exit) => return exit,
    };
    let log = log.map(|log| log.with_alerts(&alerts));
    let losses = LossCounts {
        log_lines: log.as_ref().map(LogFile::lost).unwrap_or_default(),
        history_rows: history.as_ref().map(|history| history.lost()).unwrap_or_default(),
    };
    // With a file, somebody wants the whole run, seen or not.
    let is_standard = |one: &Option<Output>| one.as_ref().is_none_or(Output::is_standard);
    let only_prints = journal.is_none()
        && history.is_none()
        && log.is_none()
        && is_standard(&report)
        && [&picture, &timeline].into_iter().all(is_standard);
    let needs_reader = only_prints && (!arguments.quiet || report.is_some() || picture.is_some() || timeline.is_some());
    let report = report.map(|output| Arc::new(ReportFile { output, is_short: arguments.short_report }));
    let picture = picture.zip(paths);
    let picture = picture.map(|(output, paths)| Arc::new(PictureFile::new(output, title(arguments), paths, &assembly)));
    // Nobody else asks for it, and it takes all records of the journal.
    let is_measured = report.is_some() || timeline.is_some();
    let adaptation = is_measured.then(|| Arc::new(AdaptationWatch::default()));
    let timeline = timeline.zip(adaptation.clone());
    let timeline = timeline.map(|(output, watch)| Arc::new(TimelineFile { output, title: title(arguments), watch }));
    // At the end, they write in this order.
    let mut observers: Vec<Arc<dyn Observer>> = vec![Arc::new(Console::new(arguments, style))];
    observers.extend(log.map(|log| Arc::new(log) as Arc<dyn Observer>));
    observers.extend(journal.map(|journal| Arc::new(journal) as Arc<dyn Observer>));
    observers.extend(history.map(|history| Arc::new(history) as Arc<dyn Observer>));
    observers.extend(report.clone().map(|report| report as Arc<dyn Observer>));
    observers.extend(picture.clone().map(|picture| picture as Arc<dyn Observer>));
    observers.extend(timeline.clone().map(|timeline| timeline as Arc<dyn Observer>));
    observers.push(Arc::clone(&alerts) as Arc<dyn Observer>);
    observers.extend(adaptation.map(|watch| watch as Arc<dyn Observer>));
    let watch = arguments.invariants.then(|| Arc::new(InvariantWatch::default()));
    observers.extend(watch.clone().map(|watch| watch as Arc<dyn Observer>));
    let mut notes = Vec::new();
    let whole = all_nodes(arguments, &assembly);
    let control = match Control::of(arguments, &mut notes) {
        Ok(control) => control,
        Err(exit) => return exit,
    };
    observers.extend(control.iter().flat_map(Control::observers));
    signals.starts(assembly.run.hangup);
    let (mut server, mut clients) = (None, Vec::new());
    let door: Arc<Door> = Arc::default();
    let mut until_events = None;
    let before = |handle: &Handle| {
        store.map_or(Ok(()), |store| handle.use_store(store))?;
        numbers.outlive(handle);
        alerts.outlive(handle);
        watch.iter().filter(|_| handle.recalled().is_some()).for_each(|watch| watch.goes_on());
        // One that goes on from where its work was done would end before it hears of more.
        until_events = Some(handle.hold());
        signals.reaches(handle);
        delivery.start(handle);
        notes.drain(..).for_each(|note| handle.note(Level::Warning, note));
        whole.into_iter().for_each(|note| handle.note(Level::Info, note));
        // A run that has not begun does not end, and only one in virtual time has a speed.
        let _ = arguments.paused.then(|| handle.pause());
        let _ = arguments.speed.map(|speed| handle.set_speed(speed));
        clients = networks.join(handle, &signals, &door)?;
        server = control
            .and_then(|control| control.serve(handle, &signals, &numbers, losses.clone(), &alerts, files.clone()));
        door.open(server.as_ref());
        Ok(())
    };
    let fleet = match RunningFleet::start_with(assembly, settings(arguments), observers, before) {
        Ok(fleet) => fleet,
        Err(error) => {
            let error = error.to_string();
            eprint(&format!("error: {}\n\nthe fleet did not start: nothing runs\n", one_line(&error)));
            delivery.finish();
            return Exit::Failed;
        }
    };
    signals.end(fleet.handle());
    let notifier = Notifier::start(fleet.handle());
    if needs_reader {
        end_without_reader(fleet.handle(), &signals);
    }
    let hold = arguments.stay.then(|| fleet.handle().hold());
    let reload = watched.map(|watched| Reload::start(files, &watched, fleet.handle()));
    play_all(faults, &fleet.handle());
    events.into_iter().for_each(|events| events.play(fleet.handle(), arguments.virtual_time, || signals.has_come()));
    drop(until_events);
    if arguments.virtual_time {
        // Virtual time waits for who reads what is printed.
        limit_patience(arguments.grace.max(PAGER_PATIENCE));
        fleet.wait_for_end();
    } else {
        fleet.wait_for_end();
        limit_patience(arguments.grace);
    }
    crate::guard::look_at_end();
    // Others receive what the components sent last.
    drop(clients);
    let outcome = fleet.run_to_end().outcome;
    delivery.finish();
    drop((hold, reload, server, notifier));
    let violations = watch.iter().flat_map(|watch| watch.violations()).inspect(|one| {
        eprint(&format!("error: [{}] {}: {}\n", one.at, one.invariant, one.text));
    });
    if violations.count() > 0 {
        return Exit::Failed;
    }
    if report.is_some_and(|report| report.output.has_failed())
        || picture.is_some_and(|picture| picture.output.has_failed())
        || timeline.is_some_and(|timeline| timeline.output.has_failed())
        || losses.log_lines.load(Ordering::Relaxed) > 0
        || history::lacks_rows(&losses)
    {
        return Exit::Failed;
    }
    match outcome.status {
        // In virtual time the run may be over before the thread that handles the signal knows of it.
        RunStatus::Done | RunStatus::Elapsed if has_own_end() => Exit::Interrupted,
        RunStatus::Done | RunStatus::Elapsed | RunStatus::Stopped => Exit::Done,
        RunStatus::Incomplete | RunStatus::Failed => Exit::Failed,
        RunStatus::Interrupted if signals.has_come() => Exit::Interrupted,
        // Its reader has seen enough.
        RunStatus::Interrupted => Exit::Done,
    }
}

/// The least time, in virtual time, for which a reader of standard output that reads nothing is waited for: somebody
/// may look at a page of the output.
const PAGER_PATIENCE: Duration = Duration::from_secs(60);

/// The fleet to run with its networks, and the files that were read; `None` after its errors have been shown. Texts and
/// diagnostics are dropped here: a run may last for days.
fn assembly(arguments: &RunArguments, files: &FleetArguments) -> Option<(Assembly, Networks, Vec<PathBuf>)> {
    let languages = EventLanguage::linked().filter(|_| arguments.events.is_some());
    let settled: Vec<String> = languages.flat_map(|one| one.settles).map(|code| format!("{code}=allow")).collect();
    let compilation = compiled(files, |project, classes| {
        project.severities(settled).node(arguments.node.clone()).to_start().compile(classes)
    });
    let mut compilation = compilation.ok()?;
    let mut networks = None;
    if let Some(whole) = compilation.output.take() {
        let assembly = arguments.node.iter().fold(whole, |whole, node| whole.at(node));
        let assembly = compilation.output.insert(assembly);
        match Networks::of(arguments, assembly, &mut compilation.diagnostics) {
            Ok(found) => networks = Some(found),
            Err(Refused) => compilation.output = None,
        }
    }
    let shown = DiagnosticReport::from(&compilation);
    // Standard output belongs to the run, unless there is none.
    match (arguments.format, &compilation.output) {
        (Format::Json, None) => print_json(&shown.json(None::<()>)),
        (Format::Json, Some(_)) => eprint_json(&shown.json(None::<()>)),
        (Format::Human, _) => {
            eprint_coloured(&shown.human(if arguments.quiet { Severity::Error } else { Severity::Note }));
        }
    }
    // Without errors here, what is missing was reported.
    let errors = shown.count(Severity::Error);
    if compilation.output.is_none() && arguments.format == Format::Human && errors > 0 {
        eprint(&format!("\n{}: nothing was started\n", counted(errors, "error")));
    }
    let mut read = files_read(&compilation, files);
    read.extend(arguments.events.iter().chain(&arguments.faults).cloned());
    let assembly = compilation.output?;
    if !has_components(&assembly, "run") {
        return None;
    }
    Some((assembly, networks?, read))
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("expected a whole number from 0 to {}", u64::MAX))
}

fn settings(arguments: &RunArguments) -> Settings {
    Settings {
        clock: if arguments.virtual_time { ClockKind::Virtual } else { ClockKind::Real },
        seed: arguments.seed,
        limit: arguments.limit,
        budget: arguments.budget,
        timer_slack: arguments.timer_slack,
        realtime: arguments.realtime,
        grace: arguments.grace,
        // As in a simulation: what has not happened by then never does, however short `--for` is.
        ends_at_standstill: arguments.invariants,
        ..Settings::default()
    }
}

/// What is said of a fleet that could run in several programs, and runs in this one.
fn all_nodes(arguments: &RunArguments, assembly: &Assembly) -> Option<String> {
    let nodes = assembly.nodes();
    let is_whole = arguments.node.is_none() && !arguments.virtual_time && nodes.len() > 1;
    let names: Vec<String> = nodes.keys().map(|node| format!("`{node}`")).collect();
    is_whole.then(|| format!("all nodes run in this program, {}: `--node` runs one of them alone", names.join(", ")))
}

/// The names of the composites.
fn title(arguments: &RunArguments) -> String {
    let names = arguments.fleet.files.iter().filter_map(|path| path.file_stem());
    names.map(|name| name.to_string_lossy()).collect::<Vec<_>>().join(", ")
}
