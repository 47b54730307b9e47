//! The files of composites: those that are open as the editor has them, others as they are on disk.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use saoms_core::load::{MAX_SIZE, composites_near, description_near};
use saoms_core::source::{OpenTexts, identity};

use super::file::File;

/// How long the names in a folder are believed where the editor does not say that files came or went.
const FRESH: Duration = Duration::from_secs(5);

/// All files that were looked at.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    open: OpenTexts,
    files: HashMap<PathBuf, (Option<Stamp>, Arc<File>)>,
    listings: HashMap<PathBuf, (Instant, Listing)>,
}

/// The composites around a folder, and what describes their contribution.
#[derive(Clone, Debug, Default)]
struct Listing {
    composites: Vec<PathBuf>,
    description: Option<PathBuf>,
}

/// By what a change on disk shows.
type Stamp = (Option<SystemTime>, u64);

impl Workspace {
    /// Takes other texts as those that are open.
    pub(super) fn set_open(&mut self, open: OpenTexts) {
        self.open = open;
    }

    /// Looks at the disk anew.
    pub(super) fn refresh(&mut self) {
        self.listings.clear();
    }

    /// A file; `None` where it cannot be read.
    fn file(&mut self, path: &Path, make: fn(PathBuf, Arc<str>) -> File) -> Option<Arc<File>> {
        let open = self.open.get(path).cloned();
        let stamp = match open {
            Some(_) => None,
            None => {
                let about = fs::metadata(path).ok().filter(fs::Metadata::is_file)?;
                Some((about.modified().ok(), about.len()))
            }
        };
        if let Some((known, file)) = self.files.get(path) {
            let is_same = match &open {
                Some(text) => Arc::ptr_eq(text, &file.text),
                None => *known == stamp,
            };
            if is_same {
                return Some(Arc::clone(file));
            }
        }
        let text = match open {
            Some(text) => text,
            None if stamp.is_some_and(|(_, size)| size > MAX_SIZE) => return None,
            None => fs::read_to_string(path).ok()?.into(),
        };
        let file = Arc::new(make(path.to_owned(), text));
        self.files.insert(path.to_owned(), (stamp, Arc::clone(&file)));
        Some(file)
    }

    /// The composites that one in this file can name, and it itself, first; then what describes their contribution, and the files that they take
    /// values from.
    pub(super) fn around(&mut self, path: &Path) -> Vec<Arc<File>> {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let is_fresh = |(then, _): &(Instant, Listing)| then.elapsed() < FRESH;
        if !self.listings.get(&folder).is_some_and(is_fresh) {
            let composites = composites_near(&folder, &self.open);
            let description = description_near(&folder).map(|path| identity(&path));
            let found = Listing { composites, description };
            self.listings.insert(folder.clone(), (Instant::now(), found));
        }
        let listed = self.listings.get(&folder).map(|(_, found)| found.clone()).unwrap_or_default();
        let others = listed.composites.iter().chain(&listed.description);
        let others = others.filter(|other| *other != path).map(PathBuf::as_path);
        let mut all: Vec<Arc<File>> =
            [path].into_iter().chain(others).filter_map(|one| self.file(one, File::new)).collect();
        let mut known: HashSet<PathBuf> = all.iter().map(|file| file.path.clone()).collect();
        let written = all.iter().flat_map(|file| {
            let folder = file.path.parent().unwrap_or(Path::new(""));
            file.outline.beside.iter().map(move |name| folder.join(&name.text))
        });
        let written: BTreeSet<PathBuf> = written.collect();
        for path in written.iter().map(|path| identity(path)) {
            if known.insert(path.clone()) {
                all.extend(self.file(&path, File::beside));
            }
        }
        all
    }
}
