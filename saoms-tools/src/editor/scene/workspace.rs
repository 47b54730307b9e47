//! The files of composites: those that are open as the editor has them, others as they are on disk.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use saoms_lang::contribution::{composites_near, description_near, imported_near, importing_near};
use saoms_lang::load::MAX_SIZE;
use saoms_lang::source::{OpenTexts, identity};

use super::file::File;

/// The time for which the names in a folder are kept if the editor does not report files that came or went.
const FRESH: Duration = Duration::from_secs(5);

/// The extension of files that hold values alone.
const VALUES: [&str; 2] = ["csv", "txt"];

/// The files that were read, each as it is open or on disk, with the names in their folders.
#[derive(Debug, Default)]
pub struct Workspace {
    open: OpenTexts,
    files: HashMap<PathBuf, (Option<Stamp>, Arc<File>)>,
    listings: HashMap<PathBuf, (Instant, Listing)>,
}

/// The composites around a folder, what describes their contribution, and what that imports.
#[derive(Clone, Debug, Default)]
struct Listing {
    composites: Vec<PathBuf>,
    description: Option<PathBuf>,
    imported: Vec<PathBuf>,
    importing: Vec<PathBuf>,
}

/// A file and those around it, in the order of a [`Scene`](super::Scene).
#[derive(Clone, Debug)]
pub struct Surroundings {
    pub(crate) files: Vec<Arc<File>>,
    /// The number of them in its contribution.
    pub(crate) own: usize,
    /// The number of them in it or imported; the rest import from it.
    pub(crate) known: usize,
}

impl Surroundings {
    /// The file itself; `None` where it cannot be read and others of its folder can.
    pub fn file(&self) -> Option<&File> {
        self.files.first().map(AsRef::as_ref)
    }
}

/// The stamp of a file that shows a change on disk: time and size.
type Stamp = (Option<SystemTime>, u64);

impl Workspace {
    /// Takes other texts as those that are open.
    pub fn set_open(&mut self, open: OpenTexts) {
        self.open = open;
    }

    /// Looks at the disk anew.
    pub fn refresh(&mut self) {
        self.listings.clear();
    }

    /// A file; `None` where it cannot be read.
    fn file(&mut self, path: &Path, is_beside: bool) -> Option<Arc<File>> {
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
            if is_same && file.is_beside == is_beside {
                return Some(Arc::clone(file));
            }
        }
        let text = match open {
            Some(text) => text,
            None if stamp.is_some_and(|(_, size)| size > MAX_SIZE) => return None,
            None => fs::read_to_string(path).ok()?.into(),
        };
        let make = if is_beside { File::beside } else { File::new };
        let file = Arc::new(make(path.to_owned(), text));
        self.files.insert(path.to_owned(), (stamp, Arc::clone(&file)));
        Some(file)
    }

    /// The composites that one in this file can name, and it itself, first; then what describes their contribution, and
    /// the files that they take values from; then the composites that the contribution imports, and last those of
    /// contributions that import from it. Around such a file are the composites around one that takes values from it.
    pub fn around(&mut self, path: &Path) -> Surroundings {
        let mut folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let mut others = self.composites_in(&folder, path);
        let holds_values = |others: &[Arc<File>]| written(others).iter().any(|one| identity(one) == path);
        let is_table = path.extension().is_some_and(|ending| VALUES.iter().any(|known| ending == *known));
        let mut is_beside = holds_values(&others);
        if !is_beside && is_table {
            is_beside = true;
            // The composite may be in another folder: one that was looked at before is found.
            let known = self.files.values().map(|(_, file)| file);
            let owner = known.filter(|file| holds_values(std::slice::from_ref(file))).map(|file| &file.path).min();
            if let Some(owner) = owner.and_then(|owner| owner.parent()).map(Path::to_owned) {
                others = self.composites_in(&owner, path);
                folder = owner;
            }
        }
        let mut all: Vec<Arc<File>> = self.file(path, is_beside).into_iter().chain(others).collect();
        let mut known: HashSet<PathBuf> = all.iter().map(|file| file.path.clone()).collect();
        for path in written(&all).iter().map(|path| identity(path)) {
            if known.insert(path.clone()) {
                all.extend(self.file(&path, true));
            }
        }
        let own = all.len();
        let Listing { imported, importing, .. } = self.listing(&folder);
        let mut add = |paths: Vec<PathBuf>, all: &mut Vec<Arc<File>>| {
            let new: Vec<PathBuf> = paths.into_iter().filter(|path| known.insert(path.clone())).collect();
            all.extend(new.iter().filter_map(|path| self.file(path, false)));
            all.len()
        };
        let known = add(imported, &mut all);
        add(importing, &mut all);
        Surroundings { files: all, own, known }
    }

    /// All composites in these folders, and those around the files that are open.
    pub fn all(&mut self, folders: &[PathBuf], open: &[PathBuf]) -> Vec<Arc<File>> {
        let beside = open.iter().filter_map(|path| path.parent()).map(Path::to_owned);
        let folders: BTreeSet<PathBuf> = folders.iter().map(|path| identity(path)).chain(beside).collect();
        let mut all: Vec<Arc<File>> =
            folders.iter().flat_map(|folder| self.composites_in(folder, Path::new(""))).collect();
        all.sort_by(|one, other| one.path.cmp(&other.path));
        all.dedup_by(|one, other| one.path == other.path);
        all
    }

    /// The composites that one in a folder can name, and what describes its contribution, but for one file.
    fn composites_in(&mut self, folder: &Path, but: &Path) -> Vec<Arc<File>> {
        let listed = self.listing(folder);
        let others = listed.composites.iter().chain(&listed.description).filter(|other| *other != but);
        others.filter_map(|one| self.file(one, false)).collect()
    }

    fn listing(&mut self, folder: &Path) -> Listing {
        let is_fresh = |(then, _): &&(Instant, Listing)| then.elapsed() < FRESH;
        if let Some((_, known)) = self.listings.get(folder).filter(is_fresh) {
            return known.clone();
        }
        let composites = composites_near(folder, &self.open);
        let description = description_near(folder).map(|path| identity(&path));
        let found = |of: fn(&Path, &OpenTexts) -> Vec<PathBuf>| match &description {
            Some(_) => of(folder, &self.open).iter().map(|path| identity(path)).collect(),
            None => Vec::new(),
        };
        let (imported, importing) = (found(imported_near), found(importing_near));
        let found = Listing { composites, description, imported, importing };
        self.listings.insert(folder.to_owned(), (Instant::now(), found.clone()));
        found
    }
}

/// The files that composites take values from, by the paths that they write.
fn written(composites: &[Arc<File>]) -> BTreeSet<PathBuf> {
    let all = composites.iter().flat_map(|file| {
        let folder = file.path.parent().unwrap_or(Path::new(""));
        file.outline.beside.iter().map(move |name| folder.join(&name.text))
    });
    all.collect()
}
