//! Checks on a thread of their own, after a short pause in typing.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use saoms_api::host::contain::contained;
use saoms_lang::contribution::Finder;
use saoms_lang::source::OpenTexts;
use saoms_tools::editor::Workspace;

use super::diagnostics::Reported;
use super::fleets::{CheckedFleets, Fleet};
use super::registries::Registries;
use crate::output::eprint;

/// The time without a change before a check starts.
const QUIET: Duration = Duration::from_millis(120);

/// A request for a check.
#[derive(Debug)]
pub(super) struct Job {
    /// Rises with each change.
    pub(super) generation: u64,
    pub(super) open: OpenTexts,
    /// True if files came or went.
    pub(super) looks_anew: bool,
}

/// The result of a check: all diagnostics by file. Files without a fault are not among them.
#[derive(Debug)]
pub(super) struct Outcome {
    pub(super) generation: u64,
    pub(super) files: BTreeMap<PathBuf, Arc<Vec<Reported>>>,
}

/// What the user wants of all checks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CheckOptions {
    /// True if classes that are not known are taken as given.
    pub(super) assume_classes: bool,
    /// True if composites may name files outside their folder and contribution.
    pub(super) allow_outside: bool,
}

/// The checker of the editor's documents.
#[derive(Debug)]
pub(super) struct Checker {
    registries: Arc<Registries>,
    options: CheckOptions,
    /// The newest generation: older jobs are given up.
    newest: Arc<AtomicU64>,
    workspace: Workspace,
    fleets: CheckedFleets,
}

impl Checker {
    pub(super) fn new(registries: Arc<Registries>, options: CheckOptions, newest: Arc<AtomicU64>) -> Self {
        let (workspace, fleets) = (Workspace::default(), CheckedFleets::default());
        Self { registries, options, newest, workspace, fleets }
    }

    /// Takes jobs until all senders are gone; of several that wait only the newest.
    pub(super) fn run(mut self, jobs: &Receiver<Job>, done: impl Fn(Outcome)) {
        while let Ok(mut job) = jobs.recv() {
            loop {
                match jobs.recv_timeout(QUIET) {
                    Ok(newer) => job = Job { looks_anew: newer.looks_anew || job.looks_anew, ..newer },
                    Err(RecvTimeoutError::Timeout) => break,
                    Err(RecvTimeoutError::Disconnected) => return,
                }
            }
            // A fault of ours costs one check, and not all that follow.
            if let Err(failure) = contained(|| self.check(&job, &done)) {
                eprint(&format!("saoms: the check {failure}\n"));
            }
        }
    }

    /// Checks all fleets that what changed has to do with, those of changed files first. What is wrong is given to
    /// `done` when these are checked, and when all are; not where something changed in the meantime.
    pub(super) fn check(&mut self, job: &Job, done: impl Fn(Outcome)) {
        self.workspace.set_open(job.open.clone());
        if job.looks_anew {
            self.workspace.refresh();
        }
        let changed = self.fleets.update(job, &mut self.workspace, &self.registries);
        let mut finder = Finder::new(job.open.clone());
        let (first, others) = self.fleets.stale(&changed);
        let (has_both, mut is_whole) = (!first.is_empty() && !others.is_empty(), true);
        for stale in [first, others] {
            is_whole &= stale.iter().all(|fleet| self.one(fleet, job, &mut finder));
            if is_whole && has_both {
                self.tell(job, &done);
            }
        }
        // A fleet that is broken does not lead to all of its files.
        is_whole = is_whole && self.fleets.unseen().iter().all(|fleet| self.one(fleet, job, &mut finder));
        if is_whole {
            self.tell(job, &done);
        }
    }

    /// Checks one fleet; false where something changed in the meantime.
    fn one(&mut self, fleet: &Fleet, job: &Job, finder: &mut Finder) -> bool {
        if self.newest.load(Ordering::Relaxed) != job.generation {
            return false;
        }
        // Nor does it cost more than one fleet, which is checked again when it changes.
        let found = contained(|| fleet.check(&job.open, self.options, finder, &self.registries));
        let found = found.unwrap_or_else(|failure| {
            eprint(&format!("saoms: the check {failure}\n"));
            fleet.unchecked()
        });
        self.fleets.add(fleet, found);
        true
    }

    fn tell(&self, job: &Job, done: &impl Fn(Outcome)) {
        if self.newest.load(Ordering::Relaxed) == job.generation {
            done(Outcome { generation: job.generation, files: self.fleets.diagnostics() });
        }
    }
}
