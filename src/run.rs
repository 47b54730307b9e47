//! `saoms run`: checks composites and runs the fleet that they describe.

use std::io;
use std::path::Path;
use std::sync::Arc;
use std::thread;

use saoms_core::report::Status;
use saoms_core::schedule::{ClockKind, Fleet, Handle, Settings};
use saoms_lang::assembly::Assembly;
use saoms_lang::check::{Options, check};
use saoms_lang::diagnostic::Severity;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::Exit;
use crate::arguments::{FleetArguments, Format, RunArguments};
use crate::console::Console;
use crate::fleet::{INPUT, checked};
use crate::output::{counted, eprint, eprint_json, print, print_json};
use crate::paths::Paths;
use crate::reload::{Reload, Watched};
use crate::results;
use crate::summary::summary;
use crate::watch::Watch;

pub(crate) fn run(arguments: &RunArguments) -> Exit {
    let mut files = arguments.fleet.clone();
    files.plugins.copies = arguments.reload;
    if arguments.reload && files.files.iter().any(|path| path == Path::new(INPUT)) {
        eprint("error: `--reload` reads composites again, which standard input cannot be\n");
        return Exit::WrongInput;
    }
    let Some(assembly) = assembly(arguments, &files) else { return Exit::WrongInput };
    if !results::writable(arguments) {
        return Exit::WrongInput;
    }
    let paths = arguments.paths.is_some().then(Arc::<Paths>::default);
    let watch = Watch { console: Console::new(arguments, &assembly), paths: paths.clone() };
    // Before the start, which may take a while in a large fleet: a signal that arrives then waits for its handler.
    let signals = Signals::new([SIGINT, SIGTERM]);
    let watched = arguments.reload.then(|| Watched::of(&assembly));
    let fleet = match Fleet::start(assembly, settings(arguments), Arc::new(watch)) {
        Ok(fleet) => fleet,
        Err(error) => {
            eprint(&format!("error: {error}\n\nthe fleet did not start: nothing runs\n"));
            return Exit::Failed;
        }
    };
    end_on_signals(signals, fleet.handle());
    let reload = watched.map(|watched| Reload::start(&files, &watched, fleet.handle()));
    let report = fleet.run_to_end();
    drop(reload);
    if !arguments.quiet {
        print(&summary(&report));
    }
    if !results::write(arguments, &report, paths.as_deref()) {
        return Exit::Failed;
    }
    match report.outcome.status {
        Status::Done | Status::Elapsed => Exit::Done,
        Status::Failed => Exit::Failed,
        Status::Interrupted => Exit::Interrupted,
    }
}

/// The fleet to run; without one, what is wrong has been shown. Texts and diagnostics do not outlive this: a run may last for days.
fn assembly(arguments: &RunArguments, files: &FleetArguments) -> Option<Assembly> {
    let outcome = checked(check, files, Options::default()).ok()?;
    // Standard output belongs to the run, unless there is none.
    match (arguments.format, &outcome.made) {
        (Format::Json, None) => print_json(&outcome.json(None::<()>)),
        (Format::Json, Some(_)) => eprint_json(&outcome.json(None::<()>)),
        (Format::Human, _) => {
            eprint(&outcome.human(if arguments.quiet { Severity::Error } else { Severity::Note }));
        }
    }
    if outcome.made.is_none() && arguments.format == Format::Human {
        eprint(&format!("\n{}: nothing was started\n", counted(outcome.count(Severity::Error), "error")));
    }
    outcome.made
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
        journal_file: arguments.journal.clone(),
        ..Settings::default()
    }
}

/// The first Ctrl-C ends every component through its shutdown, a second one ends the process at once.
fn end_on_signals(signals: io::Result<Signals>, stop: Handle) {
    let spawned = signals.and_then(|mut signals| {
        thread::Builder::new().name("signals".to_owned()).spawn(move || {
            let mut seen = false;
            for _ in signals.forever() {
                if seen {
                    std::process::exit(Exit::Interrupted as i32);
                }
                seen = true;
                stop.stop();
            }
        })
    });
    if let Err(error) = spawned {
        eprint(&format!("warning: Ctrl-C will end the process without a report: {error}\n"));
    }
}
