//! What is known of the files around composites.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::component_type;
use super::declared::Declared;
use super::imports::Imports;
use super::shelf::Shelf;
use crate::diagnostic::Candidates;
use crate::source::OpenTexts;

/// Finds what composites name in other files, and looks at each folder and each first tag of a file once: one for all fleets of a folder lets checks
/// of them take time that grows with their number, and not with its square.
///
/// It does not see what changes on disk while it is used.
pub struct Finder {
    pub(super) shelf: Shelf,
    pub(super) imports: Imports,
    pub(super) declared: Declared,
    /// How many right names are still looked at for wrong ones.
    pub(super) candidates: Candidates,
    /// Whether folders may hold component types.
    folders: HashMap<PathBuf, bool>,
    /// Which of the component types that were looked for are there.
    side_files: HashMap<PathBuf, bool>,
}

impl Finder {
    /// Nothing is known yet but the texts that count in place of files.
    pub fn new(open: OpenTexts) -> Self {
        Self {
            shelf: Shelf::new(open),
            imports: Imports::default(),
            declared: Declared::default(),
            candidates: Candidates::default(),
            folders: HashMap::new(),
            side_files: HashMap::new(),
        }
    }

    /// Whether there is a component type with this path.
    pub(super) fn has_component_type(&mut self, path: &Path) -> bool {
        let folder = path.parent().unwrap_or(Path::new(""));
        let may_be = match self.folders.get(folder) {
            Some(known) => *known,
            None => *self.folders.entry(folder.to_owned()).or_insert_with(|| component_type::any_in(folder)),
        };
        may_be && *self.side_files.entry(path.to_owned()).or_insert_with(|| path.is_file())
    }
}
