//! One composite as editors see it.

use std::path::PathBuf;
use std::sync::Arc;

use saoms_lang::load::vocabulary::{CONTRIBUTION, Kind};

use super::outline::Outline;
use crate::editor::LineIndex;
use crate::editor::syntax::{Tree, scan};

/// The text of a composite, or of a file beside one, and what is known of it.
#[derive(Debug)]
pub struct File {
    /// Its path.
    pub path: PathBuf,
    /// The text.
    pub text: Arc<str>,
    /// The lines of the text.
    pub lines: LineIndex,
    pub(crate) tree: Tree,
    /// The kinds of the elements of the tree.
    pub(crate) kinds: Vec<Option<&'static Kind>>,
    pub(crate) outline: Outline,
    /// True for a file beside composites, which holds values.
    pub is_beside: bool,
}

impl File {
    /// A composite, or a description of a contribution.
    pub fn new(path: PathBuf, text: Arc<str>) -> Self {
        let tree = scan(&text);
        let kinds = tree.kinds(&text);
        let outline = Outline::of(&text, &tree, &kinds);
        Self { path, lines: LineIndex::new(&text), tree, kinds, outline, text, is_beside: false }
    }

    /// A file beside composites, which holds values.
    pub fn beside(path: PathBuf, text: Arc<str>) -> Self {
        let (tree, kinds, outline) = (Tree::default(), Vec::new(), Outline::default());
        Self { path, lines: LineIndex::new(&text), tree, kinds, outline, text, is_beside: true }
    }

    /// True if it describes a contribution.
    pub fn is_description(&self) -> bool {
        self.kinds.first().is_some_and(|kind| kind.is_some_and(|kind| std::ptr::eq(kind, &CONTRIBUTION)))
    }

    /// The names of the libraries of plugins that the composite names.
    pub fn libraries(&self) -> &[String] {
        &self.outline.libraries
    }
}
