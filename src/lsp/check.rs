//! Checks on a thread of their own, after a short pause in typing.

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use saoms_lang::contribution::Finder;
use saoms_lang::diagnostic::{Diagnostic, codes};
use saoms_lang::project::Project;
use saoms_lang::source::{OpenTexts, Sources, identity};

use saoms_api::host::contain::contained;
use saoms_tools::editor::{Scene, SceneFleet, Workspace};

use super::diagnostics::{Reported, reported};
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
    /// The files that are open.
    pub(super) paths: Vec<PathBuf>,
    /// True if files came or went.
    pub(super) looks_anew: bool,
}

/// The result of a check: all diagnostics by file. Files without a fault are not among them.
#[derive(Debug)]
pub(super) struct Outcome {
    pub(super) generation: u64,
    pub(super) files: BTreeMap<PathBuf, Vec<Reported>>,
}

/// The kind of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FileKind {
    Composite,
    /// Of a contribution.
    Description,
    /// It holds values for composites.
    Values,
}

/// The checker of the editor's documents.
#[derive(Debug)]
pub(super) struct Checker {
    pub(super) registries: Arc<Registries>,
    pub(super) assume_classes: bool,
    pub(super) allow_outside: bool,
    /// The newest generation: older jobs are given up.
    pub(super) newest: Arc<AtomicU64>,
    pub(super) workspace: Workspace,
}

impl Checker {
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
            match contained(|| self.check(job)) {
                Ok(Some(outcome)) => done(outcome),
                Ok(None) => {}
                Err(failure) => eprint(&format!("saoms: the check {failure}\n")),
            }
        }
    }

    /// All that is wrong; `None` where something changed in the meantime.
    pub(super) fn check(&mut self, job: Job) -> Option<Outcome> {
        self.workspace.set_open(job.open.clone());
        if job.looks_anew {
            self.workspace.refresh();
        }
        let mut files: BTreeMap<PathBuf, Vec<Reported>> = BTreeMap::new();
        let (mut checked, mut seen) = (HashSet::new(), HashSet::new());
        let mut finder = Finder::new(job.open.clone());
        for path in &job.paths {
            let (fleets, kind) = self.fleets(path);
            if kind == FileKind::Description {
                contribution(path, &job, &mut finder, &mut files);
            }
            for (fleet, may_be_part) in fleets {
                if checked.insert(fleet.clone()) {
                    self.one(&fleet, may_be_part, &job, &mut finder, &mut files, &mut seen)?;
                }
            }
            // A fleet that is broken does not lead here.
            let alone = vec![path.clone()];
            if kind == FileKind::Composite && !seen.contains(path) && checked.insert(alone.clone()) {
                self.one(&alone, false, &job, &mut finder, &mut files, &mut seen)?;
            }
        }
        (self.newest.load(Ordering::Relaxed) == job.generation).then_some(Outcome { generation: job.generation, files })
    }

    /// The fleets that one file is part of, and of each whether others elsewhere may use it; then what it is itself.
    fn fleets(&mut self, path: &Path) -> (Vec<(Vec<PathBuf>, bool)>, FileKind) {
        let around = self.workspace.around(path);
        if around.file().is_none_or(|first| first.path != path) {
            return (Vec::new(), FileKind::Composite);
        }
        let scene = Scene::new(around, self.registries.of(path, &[]));
        let paths = |fleet: &SceneFleet| fleet.files.iter().map(|file| scene.files[*file].path.clone()).collect();
        let fleets = scene.fleets().iter().map(|fleet| (paths(fleet), fleet.may_be_part)).collect();
        let sort = match scene.file() {
            one if one.is_beside => FileKind::Values,
            one if one.is_description() => FileKind::Description,
            _ => FileKind::Composite,
        };
        (fleets, sort)
    }

    /// Checks composites as one fleet, with all that they name. `None` where something changed in the meantime.
    fn one(
        &self,
        fleet: &[PathBuf],
        may_be_part: bool,
        job: &Job,
        finder: &mut Finder,
        files: &mut BTreeMap<PathBuf, Vec<Reported>>,
        seen: &mut HashSet<PathBuf>,
    ) -> Option<()> {
        if self.newest.load(Ordering::Relaxed) != job.generation {
            return None;
        }
        if fleet.is_empty() {
            return Some(());
        }
        // Nothing of a plugin runs because somebody looks at a file.
        let project = Project::new()
            .files(fleet)
            .allow_outside(self.allow_outside)
            .open_texts(job.open.clone())
            .assume_classes(self.assume_classes)
            .without_plugin_code()
            .part(may_be_part);
        let found = project.load_with(finder, self.registries.as_ref()).compile();
        for (_, file) in found.sources.iter() {
            seen.insert(identity(Path::new(file.path())));
        }
        let reported: Vec<_> = found.reported().cloned().collect();
        add(&reported, &found.sources, files);
        Some(())
    }
}

/// Diagnostics of the description of a contribution, and of the names of the composites there.
fn contribution(description: &Path, job: &Job, finder: &mut Finder, files: &mut BTreeMap<PathBuf, Vec<Reported>>) {
    let folder = description.parent().unwrap_or(Path::new(""));
    let inner = folder.ends_with("META-INF").then(|| folder.parent()).flatten();
    let project = Project::new().file(inner.unwrap_or(folder)).open_texts(job.open.clone());
    let (mut found, sources) = project.check_folders(finder);
    found.retain(|one| one.code != &codes::FILE_IS_DIRECTORY);
    add(&found, &sources, files);
}

fn add(diagnostics: &[Diagnostic], sources: &Sources, files: &mut BTreeMap<PathBuf, Vec<Reported>>) {
    for (path, one) in reported(diagnostics, sources) {
        let known = files.entry(path).or_default();
        // Composites that several others name have their faults once.
        if !known.contains(&one) {
            known.push(one);
        }
    }
}
