//! The finder: one for all contributions of a check, so that each file is read once.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::component_types;
use super::imports::Imports;
use super::index::Index;
use crate::diagnostic::{Candidates, Diagnostics, Severity, quoted};
use crate::limits::{EXPLAINED_FILE_BYTES, EXPLAINED_FILES, EXPLAINED_NAMES, OFFERED_NAMES};
use crate::load::{load_file, read};
use crate::source::{OpenTexts, Sources};

/// Finds what composites name in other files, and looks at each folder and each first tag of a file once: one for all
/// fleets of a folder lets checks of them take time that grows with their number, and not with its square.
///
/// It does not see what changes on disk while it is used.
pub struct Finder {
    pub(super) index: Index,
    pub(super) imports: Imports,
    /// The contributions around others, of whose descriptions nothing is told.
    pub(super) around: Option<Imports>,
    /// The number of right names that may still be compared with wrong ones.
    pub(super) candidates: Candidates,
    /// Of how many more names that lead nowhere it is kept where they were looked for.
    pub(super) explained: usize,
    /// True if folders may hold component types.
    folders: HashMap<PathBuf, bool>,
    /// The component types that were searched for and exist.
    side_files: HashMap<PathBuf, bool>,
    /// The files of folders that are called as composites and are none, with the reason.
    unread: HashMap<PathBuf, Vec<(PathBuf, String)>>,
}

impl Finder {
    /// Nothing is known yet but the texts that count in place of files.
    pub fn new(open: OpenTexts) -> Self {
        Self {
            index: Index::new(open),
            imports: Imports::default(),
            around: None,
            candidates: Candidates::default(),
            explained: EXPLAINED_NAMES,
            folders: HashMap::new(),
            side_files: HashMap::new(),
            unread: HashMap::new(),
        }
    }

    /// True if there is a component type with this path.
    pub(super) fn has_component_type(&mut self, path: &Path) -> bool {
        let folder = path.parent().unwrap_or(Path::new(""));
        let may_be = match self.folders.get(folder) {
            Some(known) => *known,
            None => *self.folders.entry(folder.to_owned()).or_insert_with(|| component_types::any_in(folder)),
        };
        may_be && *self.side_files.entry(path.to_owned()).or_insert_with(|| path.is_file())
    }

    /// The reasons why files are not read that may hold a composite of this name, the file of that name first.
    pub(super) fn unread(&mut self, folder: &Path, local: &str, open: &OpenTexts) -> Vec<String> {
        if !self.unread.contains_key(folder) {
            let all = self.index.unread(folder).into_iter().take(EXPLAINED_FILES);
            let all = all.filter_map(|path| Some((reason(&path, open)?, path)));
            let all = all.map(|(reason, path)| (path, reason)).collect();
            self.unread.insert(folder.to_owned(), all);
        }
        let all = &self.unread[folder];
        let is_called_so = |path: &Path| path.file_stem().is_some_and(|stem| stem == local);
        let first = all.iter().filter(|(path, _)| is_called_so(path));
        let others = all.iter().filter(|(path, _)| !is_called_so(path));
        let shown = |(path, reason): &(PathBuf, String)| {
            format!("{} is no composite: {reason}", quoted(&path.display().to_string()))
        };
        first.chain(others).take(OFFERED_NAMES).map(shown).collect()
    }
}

/// The fault of a file that should be a composite.
fn reason(path: &Path, open: &OpenTexts) -> Option<String> {
    let (mut sources, mut diagnostics) = (Sources::with_open(open.clone()), Diagnostics::new());
    let file = read(path, EXPLAINED_FILE_BYTES, &mut sources, &mut diagnostics);
    file.and_then(|file| load_file(file, &sources, &mut diagnostics));
    let fault = diagnostics.into_sorted().into_iter().find(|one| one.severity == Severity::Error)?;
    Some(fault.message)
}
