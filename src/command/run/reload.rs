//! `saoms run --reload`: components whose library is rebuilt are replaced while the fleet runs.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use saoms_api::Level;
use saoms_api::host::one_line;
use saoms_core::schedule::{ChangeError, Handle};
use saoms_lang::assembly::{Assembly, ComponentSpec};
use saoms_lang::diagnostic::Severity;

use super::changes::FleetChanges;
use super::watched_files::{LOOK, WatchedFiles};
use crate::fleet::{DiagnosticReport, compiled};
use crate::output::eprint_coloured;

/// The time after which a component that could not be replaced is asked again.
const AGAIN: Duration = Duration::from_secs(1);

/// Who replaces components of a new build, in the journal.
const BY: &str = "reload";

/// The watch over the libraries of a fleet, until it is dropped.
pub(crate) struct Reload {
    _end: Sender<()>,
}

struct Watcher {
    changes: Arc<FleetChanges>,
    handle: Handle,
    /// The node that runs; empty for the whole fleet.
    node: String,
    files: WatchedFiles,
    /// Components that have to be asked again.
    waiting: Vec<ComponentSpec>,
    asked: Instant,
}

impl Reload {
    /// Begins to watch, on a thread of its own.
    pub(crate) fn start(changes: Arc<FleetChanges>, node: Option<String>, handle: Handle) -> Reload {
        let (end, ended) = channel();
        let mut files = WatchedFiles::default();
        let present = changes.present();
        files.add(present.libraries, present.since);
        let watcher = Watcher {
            changes,
            node: node.unwrap_or_default(),
            files,
            waiting: Vec::new(),
            asked: Instant::now(),
            handle: handle.clone(),
        };
        let spawned = thread::Builder::new().name("saoms-reload".to_owned()).spawn(move || watcher.watch(&ended));
        if let Err(error) = spawned {
            handle.note(Level::Warning, format!("libraries are not watched: {error}"));
        }
        Reload { _end: end }
    }
}

/// The libraries of a fleet.
pub(crate) fn libraries(assembly: &Assembly) -> Vec<PathBuf> {
    let all: BTreeSet<&Path> = assembly.components.iter().flat_map(origins).collect();
    all.into_iter().map(Path::to_owned).collect()
}

/// The libraries that a component's class and loops come from. Code in another language is not replaced.
fn origins(component: &ComponentSpec) -> impl Iterator<Item = &Path> {
    let own = component.class.origin().filter(|_| component.class.language().is_none());
    own.into_iter().chain(component.loops.iter().filter_map(|one| one.class.origin()))
}

impl Watcher {
    fn watch(mut self, ended: &Receiver<()>) {
        while ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
            let changed = self.files.look();
            // A change of the fleet may have brought others.
            let present = self.changes.present();
            self.files.add(present.libraries, present.since);
            if !changed.is_empty() {
                self.reload(&changed);
            }
            if !self.waiting.is_empty() && self.asked.elapsed() >= AGAIN {
                let waiting = std::mem::take(&mut self.waiting);
                self.replace(waiting, true);
            }
        }
    }

    /// Takes new builds of these libraries.
    fn reload(&mut self, changed: &[PathBuf]) {
        let names: Vec<String> = changed.iter().map(|path| format!("`{}`", path.display())).collect();
        let names = one_line(&names.join(", ")).into_owned();
        let kept = |why: &str| format!("{names} changed: {why}; the fleet continues with the earlier build");
        // Faults of a library have been reported already.
        let files = self.changes.present().files;
        let Ok(compilation) = compiled(&files, |project, classes| project.to_start().compile(classes)) else {
            return self.handle.note(Level::Error, kept("it cannot be used"));
        };
        let Some(whole) = &compilation.output else {
            eprint_coloured(&DiagnosticReport::from(&compilation).human(Severity::Error));
            return self.handle.note(Level::Error, kept("the composites do not match it"));
        };
        let part = (!self.node.is_empty()).then(|| whole.clone().at(&self.node));
        let assembly = part.as_ref().unwrap_or(whole);
        let plan = self.handle.plan(assembly);
        if !(plan.added.is_empty() && plan.removed.is_empty()) {
            return self.handle.note(
                Level::Error,
                kept("the composites have other components than the fleet: `saoms apply` them first"),
            );
        }
        if let Some(why) = self.changes.web_refusal(assembly) {
            return self.note(Level::Error, &kept(&why));
        }
        self.handle.note(Level::Info, format!("{names} changed: its components are replaced"));
        let affected = assembly
            .components
            .iter()
            .filter(|component| origins(component).any(|origin| changed.iter().any(|path| path == origin)));
        self.waiting.clear();
        self.replace(affected.cloned().collect(), false);
    }

    /// Tells it in one line: names and reasons are of others.
    fn note(&self, level: Level, text: &str) {
        self.handle.note(level, one_line(text).into_owned());
    }

    /// `again` is true if it was reported before that they cannot be replaced now.
    fn replace(&mut self, components: Vec<ComponentSpec>, again: bool) {
        self.asked = Instant::now();
        for component in components {
            let next = component.clone();
            let path = component.path.clone();
            match self.handle.replace(component, Some(BY)) {
                Ok(_) => {}
                Err(error @ (ChangeError::NotNow { .. } | ChangeError::Busy | ChangeError::Meanwhile)) => {
                    let why = error.reason();
                    if !again {
                        self.note(Level::Info, &format!("component `{path}` is replaced later: {why}"));
                    }
                    self.waiting.push(next);
                }
                Err(error) => {
                    let why = match &error {
                        ChangeError::Failed { component, .. } if *component == path => error.reason(),
                        other => other.to_string(),
                    };
                    self.note(
                        Level::Error,
                        &format!("component `{path}` is not replaced, the earlier one continues: {why}"),
                    );
                }
            }
        }
    }
}
