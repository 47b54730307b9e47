//! Checks on a thread of their own, after a short pause in typing.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use saoms_api::host::contain::contained;
use saoms_lang::source::OpenTexts;
use saoms_tools::editor::{CheckUpdate, Checker, EditorDiagnostic};

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
    pub(super) files: BTreeMap<PathBuf, Arc<Vec<EditorDiagnostic>>>,
}

/// Takes jobs until all senders are gone; of several that wait only the newest, and none that is older than `newest`.
pub(super) fn check_all(mut checker: Checker, newest: &AtomicU64, jobs: &Receiver<Job>, done: impl Fn(Outcome)) {
    while let Ok(mut job) = jobs.recv() {
        loop {
            match jobs.recv_timeout(QUIET) {
                Ok(newer) => job = Job { looks_anew: newer.looks_anew || job.looks_anew, ..newer },
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
        // A fault of ours costs one check, and not all that follow.
        if let Err(failure) = contained(|| check(&mut checker, &job, newest, &done)) {
            eprint(&format!("saoms: the check {failure}\n"));
        }
    }
}

pub(super) fn check(checker: &mut Checker, job: &Job, newest: &AtomicU64, done: &impl Fn(Outcome)) {
    let Job { generation, open, looks_anew } = job;
    let is_wanted = || newest.load(Ordering::Relaxed) == *generation;
    checker.check(open, *looks_anew, &is_wanted, &mut |update| match update {
        CheckUpdate::Diagnostics(files) => done(Outcome { generation: *generation, files }),
        CheckUpdate::Failed(failure) => eprint(&format!("saoms: the check {failure}\n")),
    });
}
