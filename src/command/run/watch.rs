//! `saoms run --watch`: the fleet becomes that of its files when these change.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::thread;
use std::time::SystemTime;

use saoms_api::Level;
use saoms_api::host::one_line;
use saoms_core::schedule::{ChangeOptions, ChangeWithdrawal, Handle};

use super::changes::{FleetChanges, WantedFleet};
use super::watched_files::{LOOK, WatchedFiles};
use crate::arguments::FleetArguments;
use crate::output::eprint_coloured;

/// The watch over the files of a fleet, until it is dropped.
pub(super) struct FileWatch {
    _end: Sender<()>,
}

struct Watcher {
    changes: Arc<FleetChanges>,
    handle: Handle,
    files: WatchedFiles,
    /// The time at which somebody began to read the files that are watched.
    since: SystemTime,
    /// Files whose change another change, or the system, hindered.
    again: Vec<PathBuf>,
    /// True since it was told that the system has no thread for a change.
    lacks_thread: bool,
    coloured: bool,
}

impl FileWatch {
    /// Begins to watch the files of the fleet, on a thread of its own.
    pub(super) fn start(changes: Arc<FleetChanges>, handle: Handle, coloured: bool) -> FileWatch {
        let (end, ended) = channel();
        let mut files = WatchedFiles::default();
        let present = changes.present();
        files.set(present.read, present.since);
        let (since, again) = (present.since, Vec::new());
        let watcher = Watcher { changes, handle: handle.clone(), files, since, again, lacks_thread: false, coloured };
        let spawned = thread::Builder::new().name("saoms-watch".to_owned()).spawn(move || watcher.watch(&ended));
        if let Err(error) = spawned {
            handle.note(Level::Warning, format!("files are not watched: {error}"));
        }
        FileWatch { _end: end }
    }
}

impl Watcher {
    fn watch(mut self, ended: &Receiver<()>) {
        while ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
            let present = self.changes.present();
            if present.since != self.since {
                // Somebody applied other files meanwhile.
                self.files.set(present.read, present.since);
                self.since = present.since;
            }
            let mut changed = std::mem::take(&mut self.again);
            changed.extend(self.files.look());
            changed.sort_unstable();
            changed.dedup();
            if !changed.is_empty() {
                self.apply(&changed, ended);
            }
        }
    }

    /// Lets the fleet become that of its files. The change is taken back if they change again before it is made, or the
    /// watch ends.
    fn apply(&mut self, changed: &[PathBuf], ended: &Receiver<()>) {
        let names: Vec<String> = changed.iter().map(|path| format!("`{}`", path.display())).collect();
        let names = one_line(&names.join(", ")).into_owned();
        let files = self.changes.present().files;
        let mut wanted = match self.changes.read(&files, self.coloured, Path::new("")) {
            Ok(wanted) => wanted,
            Err(error) => return self.keep(&names, &error),
        };
        self.files.add(wanted.read.iter().cloned(), wanted.since);
        let newer = match self.settle(&mut wanted, &files, ended) {
            Ok(newer) => newer,
            Err(error) => {
                self.again = changed.to_vec();
                if !std::mem::replace(&mut self.lacks_thread, true) {
                    self.keep(&names, &format!("the system cannot create a thread: {error}"));
                }
                return;
            }
        };
        self.lacks_thread = false;
        let answer = wanted.answer;
        if !answer.diagnostics.is_empty() {
            eprint_coloured(&answer.text);
        }
        for note in &answer.notes {
            self.handle.note(Level::Warning, one_line(note).into_owned());
        }
        match (answer.failure, answer.plan) {
            (Some(_), _) if wanted.is_withdrawn => {
                let why = if newer.is_empty() { "files are not watched any more" } else { "its files change again" };
                self.handle.note(Level::Info, format!("a change of the fleet is taken back: {why}"));
                self.again = changed.to_vec();
            }
            (Some(failure), _) if failure.busy => self.again = changed.to_vec(),
            (Some(failure), _) => self.keep(&names, &failure.error),
            (None, Some(plan)) if plan.is_empty() => {
                self.handle.note(Level::Info, format!("{names} changed: the fleet is the same"));
            }
            _ => {}
        }
        self.again.extend(newer);
    }

    /// Makes the change on a thread of its own, and looks after the files meanwhile; those that changed again.
    fn settle(
        &mut self,
        wanted: &mut WantedFleet,
        files: &FleetArguments,
        ended: &Receiver<()>,
    ) -> io::Result<Vec<PathBuf>> {
        let withdrawal = ChangeWithdrawal::default();
        let (by, options) = (Some("watch".to_owned()), ChangeOptions::default());
        let options = ChangeOptions { by, withdrawal: withdrawal.clone(), ..options };
        let mut newer = Vec::new();
        let (changes, watched) = (&self.changes, &mut self.files);
        thread::scope(|scope| {
            let (done, is_done) = channel::<()>();
            let make = move || {
                changes.settle(wanted, files, Some(options));
                drop(done);
            };
            thread::Builder::new().name("saoms-watch".to_owned()).spawn_scoped(scope, make)?;
            while is_done.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                newer.extend(watched.look());
                if !newer.is_empty() || ended.try_recv() == Err(TryRecvError::Disconnected) {
                    withdrawal.withdraw();
                }
            }
            Ok(newer)
        })
    }

    fn keep(&self, names: &str, why: &str) {
        let why = one_line(why);
        self.handle.note(Level::Error, format!("{names} changed: {why}; the fleet continues as it was"));
    }
}
