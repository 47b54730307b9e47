//! The checker of the texts that an editor has open.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use saoms_api::host::contain::contained;
use saoms_lang::contribution::Finder;
use saoms_lang::source::OpenTexts;

use super::classes::ClassCache;
use super::diagnostic::EditorDiagnostic;
use super::fleets::{CheckedFleets, Fleet};
use crate::editor::scene::workspace::Workspace;

/// Wishes of the user for all checks.
#[derive(Clone, Copy, Debug, Default)]
pub struct CheckOptions {
    /// True if classes that are not known are taken as given.
    pub assume_classes: bool,
    /// True if composites may name files outside their folder and contribution.
    pub allow_outside: bool,
}

/// A result of a check, or of its first part.
#[derive(Debug)]
pub enum CheckUpdate {
    /// All diagnostics by file. Files without a fault are not among them.
    Diagnostics(BTreeMap<PathBuf, Arc<Vec<EditorDiagnostic>>>),
    /// A fault of the checker, which costs the diagnostics of one fleet.
    Failed(String),
}

/// The checker of open texts. It keeps what it found in a fleet until one of its files changes.
#[derive(Debug)]
pub struct Checker {
    classes: Arc<ClassCache>,
    options: CheckOptions,
    workspace: Workspace,
    fleets: CheckedFleets,
}

/// One call of [`Checker::check`].
struct Run<'r> {
    open: &'r OpenTexts,
    finder: Finder,
    is_wanted: &'r dyn Fn() -> bool,
    report: &'r mut dyn FnMut(CheckUpdate),
}

impl Checker {
    /// A checker that has seen no text.
    pub fn new(classes: Arc<ClassCache>, options: CheckOptions) -> Self {
        Self { classes, options, workspace: Workspace::default(), fleets: CheckedFleets::default() }
    }

    /// Checks all fleets that what changed in the open texts has to do with, those of changed files first. What is
    /// wrong is reported when these are checked, and when all are. `looks_anew` says that files came or went; the check
    /// is given up, with nothing more to report, once it `is_wanted` no longer.
    pub fn check(
        &mut self,
        open: &OpenTexts,
        looks_anew: bool,
        is_wanted: &dyn Fn() -> bool,
        report: &mut dyn FnMut(CheckUpdate),
    ) {
        self.workspace.set_open(open.clone());
        if looks_anew {
            self.workspace.refresh();
        }
        let changed = self.fleets.update(open, looks_anew, &mut self.workspace, &self.classes);
        let mut run = Run { open, finder: Finder::new(open.clone()), is_wanted, report };
        let (first, others) = self.fleets.stale(&changed);
        if !first.iter().all(|fleet| self.one(fleet, &mut run)) {
            return;
        }
        if !first.is_empty() && !others.is_empty() {
            self.tell(&mut run);
        }
        let is_whole = others.iter().all(|fleet| self.one(fleet, &mut run));
        // A fleet that is broken does not lead to all of its files.
        if is_whole && self.fleets.unseen().iter().all(|fleet| self.one(fleet, &mut run)) {
            self.tell(&mut run);
        }
    }

    /// Checks one fleet; false where the check is not wanted any more.
    fn one(&mut self, fleet: &Fleet, run: &mut Run<'_>) -> bool {
        if !(run.is_wanted)() {
            return false;
        }
        // A fault of ours costs no more than one fleet, which is checked again when it changes.
        let found = contained(|| fleet.check(run.open, self.options, &mut run.finder, &self.classes));
        let found = found.unwrap_or_else(|failure| {
            (run.report)(CheckUpdate::Failed(failure.to_string()));
            fleet.unchecked()
        });
        self.fleets.add(fleet, found);
        true
    }

    fn tell(&self, run: &mut Run<'_>) {
        if (run.is_wanted)() {
            (run.report)(CheckUpdate::Diagnostics(self.fleets.diagnostics()));
        }
    }
}
