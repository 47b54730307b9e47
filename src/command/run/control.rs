//! The server with which operators reach the running fleet (`saoms status`, `saoms down`).

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use saoms_api::Level;
use saoms_control::{ControlServer, ControlledFleet, FleetDescription, Listener, LogTail, TopicWatch, default_socket};
use saoms_core::observe::Observer;
use saoms_core::schedule::Handle;

use super::RunArguments;
use super::ending::Signalled;
use super::events::Events;
use crate::Exit;
use crate::output::{displayed, eprint};

/// The value of `--control` for a fleet that nobody can reach.
const NONE: &str = "none";

/// The place at which the fleet will be reached.
pub(super) struct Control {
    listener: Listener,
    description: FleetDescription,
    /// The log of the fleet, an observer of it.
    log: Arc<LogTail>,
    /// The topics of the fleet, an observer of it.
    topics: Arc<TopicWatch>,
}

impl Control {
    /// Listens where the command line says, or where the commands look. In virtual time nobody listens unless that is
    /// asked for. Why a place that was named cannot be used is reported; one that was not named is done without.
    pub(super) fn of(arguments: &RunArguments, notes: &mut Vec<String>) -> Result<Option<Control>, Exit> {
        let description = description(arguments);
        let listener = match arguments.control.as_deref() {
            Some(NONE) => return Ok(None),
            None if arguments.virtual_time => return Ok(None),
            Some(path) => Listener::bind(Path::new(path)).map_err(|error| {
                let path = displayed(Path::new(path));
                eprint(&format!("error: `--control {path}`: {error}\n\n1 error: nothing was started\n"));
                Exit::WrongInput
            })?,
            None => match Listener::bind(&default_socket(&description.name, description.pid)) {
                Ok(listener) => listener,
                Err(error) => {
                    notes.push(format!("commands such as `saoms status` cannot reach this fleet: {error}"));
                    return Ok(None);
                }
            },
        };
        Ok(Some(Control { listener, description, log: Arc::default(), topics: Arc::default() }))
    }

    /// The observers of the fleet with which it serves.
    pub(super) fn observers(&self) -> [Arc<dyn Observer>; 2] {
        [Arc::clone(&self.log) as _, Arc::clone(&self.topics) as _]
    }

    /// Serves operators from now on.
    pub(super) fn serve(self, handle: &Handle, signals: &Signalled) -> Option<ControlServer> {
        let Control { listener, description, log, topics } = self;
        let events = Mutex::new(Events::of_operators(description.seed));
        let fleet = handle.clone();
        let send = move |line: &str| {
            let mut events = events.lock().unwrap_or_else(PoisonError::into_inner);
            events.send(line, &fleet)
        };
        let (fleet, ending) = (handle.clone(), signals.ending());
        let fleet = ControlledFleet::new(description, handle.clone(), (log, topics), send, move || ending.down(&fleet));
        ControlServer::start(listener, fleet)
            .inspect_err(|error| {
                handle
                    .note(Level::Warning, format!("commands such as `saoms status` cannot reach this fleet: {error}"));
            })
            .ok()
    }
}

fn description(arguments: &RunArguments) -> FleetDescription {
    let files = &arguments.fleet.files;
    let stem = files.first().and_then(|path| path.file_stem()).filter(|stem| *stem != "-");
    FleetDescription {
        name: stem.map_or_else(|| "fleet".to_owned(), |stem| stem.to_string_lossy().into_owned()),
        pid: std::process::id(),
        composites: files.iter().map(|path| path.display().to_string()).collect(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        started: SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs(),
        is_virtual: arguments.virtual_time,
        seed: arguments.seed,
    }
}
