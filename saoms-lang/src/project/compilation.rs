//! The outcome of a compilation.

use super::PluginFault;
use crate::assembly::Assembly;
use crate::diagnostic::{Diagnostic, Severity};
use crate::model::{Composite, Contribution};
use crate::registry::Registry;
use crate::source::Sources;

/// The output of a compilation with all that was read and found on the way.
#[derive(Debug)]
pub struct Compilation<T = Assembly> {
    /// The output; `None` where there is an error.
    pub output: Option<T>,
    /// The composites, with those that they name.
    pub contribution: Contribution,
    /// The classes that they can name.
    pub registry: Registry,
    /// The texts that were read.
    pub sources: Sources,
    /// All diagnostics by file and place, with those that are allowed and kept for the record alone.
    pub diagnostics: Vec<Diagnostic>,
    /// Faults of plugins, which have no place in a composite.
    pub problems: Vec<PluginFault>,
}

impl<T> Compilation<T> {
    /// The first composite of the fleet.
    pub fn first(&self) -> Option<&Composite> {
        self.contribution.asked_for().first()
    }

    /// The diagnostics but for those that are allowed.
    pub fn reported(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics.iter().filter(|one| !one.is_allowed())
    }

    /// True if one of the diagnostics is an error.
    pub fn has_errors(&self) -> bool {
        self.reported().any(|one| one.severity == Severity::Error)
    }
}
