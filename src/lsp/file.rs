//! One composite as editors see it.

use std::path::PathBuf;
use std::sync::Arc;

use saoms_lang::load::vocabulary::{CONTRIBUTION, Kind};

use super::outline::Outline;
use super::position::Lines;
use super::syntax::{Tree, scan};

/// The text of a composite, or of a file beside one, and what is known of it.
#[derive(Debug)]
pub(super) struct File {
    pub(super) path: PathBuf,
    pub(super) text: Arc<str>,
    pub(super) lines: Lines,
    pub(super) tree: Tree,
    /// What is known of each element.
    pub(super) kinds: Vec<Option<&'static Kind>>,
    pub(super) outline: Outline,
    /// Whether it is a file beside composites, which holds values.
    pub(super) is_beside: bool,
}

impl File {
    pub(super) fn new(path: PathBuf, text: Arc<str>) -> Self {
        let tree = scan(&text);
        let kinds = tree.kinds(&text);
        let outline = Outline::of(&text, &tree, &kinds);
        Self { path, lines: Lines::new(&text), tree, kinds, outline, text, is_beside: false }
    }

    /// A file beside composites, which holds values.
    pub(super) fn beside(path: PathBuf, text: Arc<str>) -> Self {
        let (tree, kinds, outline) = (Tree::default(), Vec::new(), Outline::default());
        Self { path, lines: Lines::new(&text), tree, kinds, outline, text, is_beside: true }
    }

    /// Whether it describes a contribution.
    pub(super) fn is_description(&self) -> bool {
        self.kinds.first().is_some_and(|kind| kind.is_some_and(|kind| std::ptr::eq(kind, &CONTRIBUTION)))
    }
}
