//! One composite as editors see it.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use saoms_lang::load::vocabulary::{CONTRIBUTION, Kind};
use saoms_lang::source::{ColumnUnit, LineIndex};
use saoms_lang::syntax::{Document, Element, ElementId};

use super::names::Names;
use super::outline::Outline;
use crate::editor::syntax::{Cursor, kinds, parse};

/// The text of a composite, or of a file beside one, and what is known of it.
#[derive(Debug)]
pub struct File {
    /// Its path.
    pub path: PathBuf,
    /// The text.
    pub text: Arc<String>,
    /// The lines of the text, with columns in UTF-16.
    pub lines: LineIndex,
    /// The tree of the text; empty for a file beside composites.
    pub(crate) document: Document,
    /// The kinds of the elements of the tree.
    kinds: Vec<Option<&'static Kind>>,
    pub(crate) outline: Outline,
    /// The places of names in the outline, as far as they were needed.
    names: OnceLock<Names>,
    /// True for a file beside composites, which holds values.
    pub is_beside: bool,
}

impl File {
    /// A composite, or a description of a contribution.
    pub fn new(path: PathBuf, text: Arc<String>) -> Self {
        let document = parse(&text);
        let kinds = kinds(&document);
        let outline = Outline::of(&document, &kinds);
        Self {
            path,
            lines: LineIndex::new(&text, ColumnUnit::Utf16),
            document,
            kinds,
            outline,
            names: OnceLock::new(),
            text,
            is_beside: false,
        }
    }

    /// A file beside composites, which holds values.
    pub fn beside(path: PathBuf, text: Arc<String>) -> Self {
        let document = parse(&Arc::default());
        let (kinds, outline) = (Vec::new(), Outline::default());
        Self {
            path,
            lines: LineIndex::new(&text, ColumnUnit::Utf16),
            document,
            kinds,
            outline,
            names: OnceLock::new(),
            text,
            is_beside: true,
        }
    }

    /// True if it describes a contribution.
    pub fn is_description(&self) -> bool {
        self.kinds.first().is_some_and(|kind| kind.is_some_and(|kind| std::ptr::eq(kind, &CONTRIBUTION)))
    }

    /// The names of the libraries of plugins that the composite names.
    pub fn libraries(&self) -> &[String] {
        &self.outline.libraries
    }

    /// The places of names in the outline.
    pub(crate) fn names(&self) -> &Names {
        self.names.get_or_init(|| Names::of(&self.outline))
    }

    pub(crate) fn element(&self, id: ElementId) -> Element<'_> {
        self.document.element(id)
    }

    /// The knowledge about an element.
    pub(crate) fn kind(&self, id: ElementId) -> Option<&'static Kind> {
        self.kinds[id.0 as usize]
    }

    /// The part at a byte.
    pub(crate) fn cursor(&self, at: usize) -> Cursor<'_> {
        Cursor::at(&self.document, at)
    }
}
