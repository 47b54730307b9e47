//! `saoms run`: checks composites and runs the fleet that they describe.

mod alerts;
mod applied;
mod arguments;
mod changes;
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
mod recording;
mod reload;
mod report_file;
mod state;
mod status_line;
mod summary;
mod timeline_file;
mod watch;
mod watched_files;
mod web;

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, SystemTime};

use saoms_api::Level;
use saoms_api::extension::{EventLanguage, PictureRegistration};
use saoms_api::host::one_line;
use saoms_control::{AlertList, FigureWatch, LossCounts, Recorder};
use saoms_core::assemble::fingerprint;
use saoms_core::network::Client;
use saoms_core::observe::{AdaptationWatch, InvariantWatch, Observer};
use saoms_core::report::RunStatus;
use saoms_core::schedule::{ClockKind, Handle, RunningFleet, Settings};
use saoms_lang::assembly::Assembly;
use saoms_lang::diagnostic::Severity;
use saoms_lang::project::INPUT;

use crate::Exit;
use crate::arguments::{FleetArguments, Format};
use crate::fleet::{DiagnosticReport, compiled, files_read, has_components};
use crate::guard::has_own_end;
use crate::output::{Outputs, counted, displayed, eprint, eprint_coloured, eprint_json, limit_patience, print_json};
use alerts::AlertDelivery;
use applied::LastApplied;
pub(crate) use arguments::{ConsoleStyle, RunArguments};
use changes::FleetChanges;
use console::Console;
use control::Control;
use ending::{Signalled, end_without_reader};
use events::{Events, Numbers, Unreadable};
use faults::{FaultScript, Known, play_all, report_wrong};
use log_file::LogFile;
use log_lines::LogStyle;
pub(super) use networks::read_private;
use networks::{Door, Networks, Refused};
use notify::Notifier;
use outputs::{Output, RunFiles};
use picture_file::PictureFile;
use reload::{Reload, libraries};
use report_file::ReportFile;
use timeline_file::TimelineFile;
use watch::FileWatch;
use web::{Web, WebAccesses};

pub(crate) fn run(arguments: &RunArguments) -> Exit {
    let signals = Signalled::new(arguments.grace);
    let files = &arguments.fleet;
    let reads_again = [("--reload", arguments.reload), ("--watch", arguments.watch)];
    if let Some((option, _)) = reads_again.iter().find(|(_, is_given)| *is_given)
        && files.files.iter().any(|path| path == Path::new(INPUT))
    {
        eprint(&format!("error: `{option}` reads composites again, which standard input cannot be\n"));
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
    let Some(Prepared { assembly, networks, web, read, watched, texts, since }) = prepared(arguments, files) else {
        return Exit::WrongInput;
    };
    if let Err(exit) = web.judge() {
        return exit;
    }
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
    let libraries = libraries(&assembly);
    if arguments.reload && libraries.is_empty() {
        eprint(
            "error: `--reload` has nothing to watch: no component of the fleet comes from a plugin\n  = help: leave it out, or name the plugin with `--plugin`\n\n1 error: nothing was started\n",
        );
        return Exit::WrongInput;
    }
    let style = LogStyle::of(&arguments.log, &assembly);
    let read = read.into_iter().chain(state::files(arguments)).collect();
    let Some(files_written) = RunFiles::of(arguments, read, style) else { return Exit::WrongInput };
    let RunFiles { report, picture, timeline, journal, history, recording, log } = files_written;
    let alerts: Arc<AlertList> = Arc::default();
    let history = match history.map(|path| history::open(&path, arguments, &alerts)).transpose() {
        Ok(history) => history.map(Arc::new),
        Err(exit) => return exit,
    };
    let recording = recording.map(|path| recording::of(&path, arguments, (&assembly, texts), &alerts)).transpose();
    let recording = match recording {
        Ok(recording) => recording.map(Arc::new),
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
        recorded: recording.as_ref().map(|recording| recording.lost()).unwrap_or_default(),
    };
    // With a file, somebody wants the whole run, seen or not.
    let is_standard = |one: &Option<Output>| one.as_ref().is_none_or(Output::is_standard);
    let only_prints = journal.is_none()
        && history.is_none()
        && recording.is_none()
        && log.is_none()
        && is_standard(&report)
        && [&picture, &timeline].into_iter().all(is_standard);
    let needs_reader = only_prints && (!arguments.quiet || report.is_some() || picture.is_some() || timeline.is_some());
    let is_shown_later = report.is_some() && !arguments.short_report
        || recording.is_some() && assembly.components.len() <= recording::REPLAYED;
    let figures = Arc::new(FigureWatch::new(control::is_reached(arguments)));
    let recorder = is_shown_later.then(|| {
        let components = assembly.components.len();
        Arc::new(Recorder::new(title(arguments), components, Arc::clone(&alerts), Arc::clone(&figures)))
    });
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
    observers.extend(history.clone().map(|history| history as Arc<dyn Observer>));
    observers.extend(recording.clone().map(|recording| recording as Arc<dyn Observer>));
    observers.extend(report.clone().map(|report| report as Arc<dyn Observer>));
    observers.extend(picture.clone().map(|picture| picture as Arc<dyn Observer>));
    observers.extend(timeline.clone().map(|timeline| timeline as Arc<dyn Observer>));
    observers.push(Arc::clone(&alerts) as Arc<dyn Observer>);
    observers.extend(adaptation.map(|watch| watch as Arc<dyn Observer>));
    let is_recorded = recorder.is_some();
    observers.extend(recorder.map(|recorder| recorder as Arc<dyn Observer>));
    let watch = arguments.invariants.then(|| Arc::new(InvariantWatch::default()));
    observers.extend(watch.clone().map(|watch| watch as Arc<dyn Observer>));
    let mut notes = Vec::new();
    let whole = all_nodes(arguments, &assembly);
    let starting = store.is_some().then(|| fingerprint(&assembly));
    let control = match Control::of(arguments, &figures, &mut notes) {
        Ok(control) => control,
        Err(exit) => return exit,
    };
    observers.extend((is_recorded || control.is_some()).then_some(figures as Arc<dyn Observer>));
    observers.extend(control.iter().flat_map(Control::observers));
    signals.starts(assembly.run.hangup);
    let (mut server, mut clients, mut changes) = (None, Vec::new(), None);
    let (policy, accesses) = (assembly.run.clone(), WebAccesses::of(&assembly));
    let door: Arc<Door> = Arc::default();
    let mut until_events = None;
    let before = |handle: &Handle| {
        store.map_or(Ok(()), |store| handle.use_store(store))?;
        numbers.outlive(handle);
        history.iter().filter(|_| starting.is_some()).for_each(|history| history.outlive(handle));
        recording.iter().for_each(|recording| recording.outlive(handle));
        let applied = starting.map(|starting| LastApplied::outlive(handle, starting, &arguments.fleet.files));
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
        let url = control.as_ref().and_then(|control| control.url().map(str::to_owned));
        let ran = (libraries, watched, since);
        let changing = FleetChanges::new(handle.clone(), arguments, (policy, accesses), ran, applied);
        let changing = changes.insert(Arc::new(changing));
        server =
            control.and_then(|control| control.serve(handle, &signals, &numbers, losses.clone(), &alerts, changing));
        web.start(handle, url.as_deref(), server.is_some());
        door.open(server.as_ref());
        Ok(())
    };
    let fleet = match RunningFleet::start_with(assembly, settings(arguments), observers, before) {
        Ok(fleet) => fleet,
        Err(error) => {
            let error = error.to_string();
            eprint(&format!("error: {}\n\nthe fleet did not start: nothing runs\n", one_line(&error)));
            clients.into_iter().for_each(Client::abandon);
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
    let reload = changes.iter().filter(|_| arguments.reload);
    let reload: Vec<Reload> =
        reload.map(|changes| Reload::start(Arc::clone(changes), arguments.node.clone(), fleet.handle())).collect();
    let watching = changes.iter().filter(|_| arguments.watch);
    let coloured = std::io::stderr().is_terminal();
    let watching: Vec<FileWatch> =
        watching.map(|changes| FileWatch::start(Arc::clone(changes), fleet.handle(), coloured)).collect();
    if let Some(path) = &arguments.faults {
        play_all(path, faults, &fleet.handle());
    }
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
    // Others receive what the components sent last, on all networks at the same time.
    clients.iter().for_each(Client::close);
    drop(clients);
    let outcome = fleet.run_to_end().outcome;
    delivery.finish();
    drop((hold, reload, watching, server, notifier));
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
        || recording::lacks_messages(&losses)
    {
        return Exit::Failed;
    }
    match outcome.status {
        // In virtual time the run may be over before the thread that handles the signal knows of it.
        RunStatus::Done | RunStatus::Elapsed if has_own_end() => Exit::Interrupted,
        RunStatus::Done | RunStatus::Elapsed | RunStatus::Stopped => Exit::Done,
        RunStatus::Incomplete | RunStatus::Failed => Exit::Failed,
        RunStatus::Interrupted if signals.has_come() => Exit::Interrupted,
        // Its reader has seen enough; what has failed before has failed all the same.
        RunStatus::Interrupted if outcome.reasons.is_empty() => Exit::Done,
        RunStatus::Interrupted => Exit::Failed,
    }
}

/// The least time, in virtual time, for which a reader of standard output that reads nothing is waited for: somebody
/// may look at a page of the output.
const PAGER_PATIENCE: Duration = Duration::from_secs(60);

/// A fleet that can start.
struct Prepared {
    assembly: Assembly,
    networks: Networks,
    web: Web,
    /// All files that were read: no output may go there.
    read: Vec<PathBuf>,
    /// Those of them that say what the fleet is.
    watched: Vec<PathBuf>,
    /// Their names and texts, for the recording.
    texts: Vec<(String, String)>,
    /// The time at which that began.
    since: SystemTime,
}

/// The fleet to run; `None` after its errors have been shown. Texts and diagnostics are dropped here: a run may last
/// for days.
fn prepared(arguments: &RunArguments, files: &FleetArguments) -> Option<Prepared> {
    let since = SystemTime::now();
    let compilation = compiled(files, |project, classes| {
        project.severities(settled(arguments)).node(arguments.node.clone()).to_start().compile(classes)
    });
    let mut compilation = compilation.ok()?;
    let (mut networks, mut web) = (None, Web::default());
    if let Some(whole) = compilation.output.take() {
        let assembly = arguments.node.iter().fold(whole, |whole, node| whole.at(node));
        let assembly = compilation.output.insert(assembly);
        match Networks::of(arguments, assembly, &mut compilation.diagnostics) {
            Ok(found) => {
                networks = Some(found);
                web = Web::of(arguments, assembly, &mut compilation.diagnostics);
            }
            Err(Refused) => compilation.output = None,
        }
        if compilation.diagnostics.iter().any(|one| one.severity == Severity::Error) {
            compilation.output = None;
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
    let watched = compilation.sources.open().files_read();
    let mut read = files_read(&compilation, files);
    read.extend(arguments.events.iter().chain(&arguments.faults).cloned());
    let texts = if arguments.recording.file.is_some() { recording::texts(&compilation.sources) } else { Vec::new() };
    let assembly = compilation.output?;
    if !has_components(&assembly, "run") {
        return None;
    }
    Some(Prepared { assembly, networks: networks?, web, read, watched, texts, since })
}

/// The severities that follow from the other options of a run.
fn settled(arguments: &RunArguments) -> Vec<String> {
    let languages = EventLanguage::linked().filter(|_| arguments.events.is_some());
    languages.flat_map(|one| one.settles).map(|code| format!("{code}=allow")).collect()
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
