//! `saoms run --reload`: components whose library is rebuilt are replaced while the fleet runs.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use saoms_api::Level;
use saoms_api::host::one_line;
use saoms_core::schedule::{ChangeError, Handle};
use saoms_lang::assembly::{Assembly, ComponentSpec};
use saoms_lang::diagnostic::Severity;

use crate::arguments::FleetArguments;
use crate::fleet::{DiagnosticReport, compiled};
use crate::output::eprint_coloured;

/// The time between two looks at the files. A file is loaded when two looks in a row find it unchanged.
const LOOK: Duration = Duration::from_millis(300);

/// The time after which a component that could not be replaced is asked again.
const AGAIN: Duration = Duration::from_secs(1);

/// The identity of a file's content: inode, size, and time of its last change.
type Stamp = (u64, u64, i64, i64);

/// The watch over the libraries of a fleet, until it is dropped.
pub(crate) struct Reload {
    _end: Sender<()>,
}

struct Watcher {
    arguments: FleetArguments,
    handle: Handle,
    /// The paths of all components, in the order of the assembly.
    components: Vec<String>,
    /// The node that runs; empty for the whole fleet.
    node: String,
    files: BTreeMap<PathBuf, FileStamps>,
    /// Components that have to be asked again.
    waiting: Vec<ComponentSpec>,
    asked: Instant,
}

struct FileStamps {
    loaded: Option<Stamp>,
    /// The file at the last look.
    seen: Option<Stamp>,
}

impl Reload {
    /// Begins to watch, on a thread of its own.
    pub(crate) fn start(arguments: &FleetArguments, assembly: &Watched, handle: Handle) -> Reload {
        let (end, ended) = channel();
        let known = |path: &PathBuf| {
            let stamp = stamp(path);
            (path.clone(), FileStamps { loaded: stamp, seen: stamp })
        };
        let watcher = Watcher {
            arguments: arguments.clone(),
            components: assembly.components.clone(),
            node: assembly.node.clone(),
            files: assembly.files.iter().map(known).collect(),
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

/// The parts of an assembly that are watched.
pub(crate) struct Watched {
    components: Vec<String>,
    files: Vec<PathBuf>,
    /// The node that runs; empty for the whole fleet.
    node: String,
}

impl Watched {
    pub(crate) fn of(assembly: &Assembly) -> Watched {
        let components = assembly.components.iter();
        let mut files: Vec<PathBuf> = components.flat_map(origins).map(Path::to_owned).collect();
        files.sort();
        files.dedup();
        Watched { components: paths(assembly), files, node: assembly.node.to_string() }
    }

    /// True if there is no library.
    pub(crate) fn is_empty(&self) -> bool {
        self.files.is_empty()
    }
}

/// The libraries that a component's class and loops come from.
fn origins(component: &ComponentSpec) -> impl Iterator<Item = &Path> {
    component.class.origin().into_iter().chain(component.loops.iter().filter_map(|one| one.class.origin()))
}

fn paths(assembly: &Assembly) -> Vec<String> {
    assembly.components.iter().map(|component| component.path.clone()).collect()
}

fn stamp(path: &Path) -> Option<Stamp> {
    let found = fs::metadata(path).ok()?;
    Some((found.ino(), found.size(), found.mtime(), found.mtime_nsec()))
}

impl Watcher {
    fn watch(mut self, ended: &Receiver<()>) {
        while ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
            let changed: Vec<PathBuf> = self.files.iter_mut().filter_map(|(path, known)| known.look(path)).collect();
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
        let Ok(compilation) = compiled(&self.arguments, |project, classes| project.to_start().compile(classes)) else {
            return self.handle.note(Level::Error, kept("it cannot be used"));
        };
        let Some(whole) = &compilation.output else {
            eprint_coloured(&DiagnosticReport::from(&compilation).human(Severity::Error));
            return self.handle.note(Level::Error, kept("the composites do not match it"));
        };
        let part = (!self.node.is_empty()).then(|| whole.clone().at(&self.node));
        let assembly = part.as_ref().unwrap_or(whole);
        if paths(assembly) != self.components {
            return self.handle.note(
                Level::Error,
                kept("the composites have other components than when the fleet started: restart it"),
            );
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
            match self.handle.replace(component) {
                Ok(_) => {}
                Err(ChangeError::NotNow { why, .. }) => {
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

impl FileStamps {
    /// The path, if its file differs from the loaded one and is complete.
    fn look(&mut self, path: &Path) -> Option<PathBuf> {
        let now = stamp(path);
        let settled = std::mem::replace(&mut self.seen, now) == now;
        (settled && now.is_some() && now != self.loaded).then(|| {
            self.loaded = now;
            path.to_owned()
        })
    }
}
