//! Answers for editors: completion, hovering, definitions, references, renaming, outlines; and checks of what is open.
//!
//! Each question is a pure function of a [`Scene`] (a file, the files around it, the classes) and a byte of the file.
//! The answers are ranges of bytes and plain types; a protocol maps them to its own.

mod allow;
mod check;
mod complete;
mod describe;
mod folding;
mod formatting;
mod hover;
mod links;
mod navigate;
mod rename;
mod scene;
mod selection;
mod symbols;
mod syntax;
#[cfg(any(test, fuzzing))]
pub mod testing;
#[cfg(test)]
mod tests;

use std::ops::Range;

pub use check::{
    CheckOptions, CheckUpdate, Checker, ClassCache, EditorDiagnostic, Fix, FixAction, PluginSearch, RangeEdit,
    RelatedPlace, fix_all, fixes, touching,
};
pub use complete::{Insert, Proposal, ProposalKind, complete};
pub use folding::{Fold, folds};
pub use formatting::formatted;
pub use hover::hover;
pub use links::links;
pub use navigate::{DefinitionTarget, definition, references};
pub use rename::{prepare as prepare_rename, rename};
pub use scene::file::File;
pub use scene::symbol::FileRange;
pub use scene::workspace::{Surroundings, Workspace};
pub use scene::{Scene, SceneFleet};
pub use selection::{linked_tags, selections};
pub use symbols::{DocumentSymbol, SymbolKind, WorkspaceSymbol, document_symbols, workspace_symbols};

/// New text for a range of bytes of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileEdit {
    /// The bytes that are replaced.
    pub range: Range<usize>,
    /// The text in their place.
    pub text: String,
}

impl FileEdit {
    pub(crate) fn new(range: Range<usize>, text: impl Into<String>) -> Self {
        Self { range, text: text.into() }
    }
}
