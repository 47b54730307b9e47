//! The files of composites: those that are open as the editor has them, others as they are on disk.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use saoms_lang::contribution::{composites_near, description_near, imported_near, importing_near};
use saoms_lang::load::MAX_SIZE;
use saoms_lang::source::{OpenTexts, identity};

use super::file::File;
use super::outline::{Implementation, Named};
use crate::editor::syntax::Places;

/// The time for which the names in a folder are kept if the editor does not report files that came or went.
const FRESH: Duration = Duration::from_secs(5);

/// The bytes of files that are not open and are read because of one that is.
const MOST_BYTES: usize = 64_000_000;

/// The extension of files that hold values alone.
const VALUES: [&str; 2] = ["csv", "txt"];

/// The files that were read, each as it is open or on disk, with the names in their folders.
#[derive(Debug, Default)]
pub struct Workspace {
    open: OpenTexts,
    files: HashMap<PathBuf, (Option<Stamp>, Arc<File>)>,
    listings: HashMap<PathBuf, (Instant, Listing)>,
    /// The files that paths as composites write them lead to, and when the first of them was found.
    identities: Option<(Instant, HashMap<PathBuf, PathBuf>)>,
    /// The folders that the editor has open.
    folders: Vec<PathBuf>,
    /// True if composites may name files that are in none of them, nor in their folder and contribution.
    allow_outside: bool,
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
    /// The files that paths as composites write them lead to.
    pub(crate) identities: HashMap<PathBuf, PathBuf>,
    pub(crate) bounds: Bounds,
}

/// The folders whose files, and those below, may be read because composites name them; `None` where all may.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bounds(pub(crate) Option<Vec<PathBuf>>);

impl Bounds {
    /// True if a file or a folder may be read.
    pub(crate) fn hold(&self, path: &Path) -> bool {
        let Some(folders) = &self.0 else { return true };
        identity(path).ancestors().any(|above| folders.iter().any(|folder| folder == above))
    }
}

impl Surroundings {
    /// The file itself; `None` where it cannot be read and others of its folder can.
    pub fn file(&self) -> Option<&File> {
        self.files.first().map(AsRef::as_ref)
    }
}

/// The stamp of a file that shows a change on disk: time and size.
type Stamp = (Option<SystemTime>, u64);

/// The shape of a file: what the fleets around it follow from, as numbers that change with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shape {
    /// Of what others find the file by, and of what a contribution says of its files.
    pub names: u64,
    /// Of what the file names: composites, and files with values.
    pub uses: u64,
}

impl Shape {
    fn of(file: &File) -> Self {
        if file.is_beside {
            return Self::default();
        }
        let (outline, text) = (&file.outline, &file.text);
        let (mut names, mut uses) = (DefaultHasher::new(), DefaultHasher::new());
        // Why a composite without a name is none, is said where it is missed.
        let head = if outline.name.is_some() { file.document.root().tag() } else { 0..text.len() };
        text[head].hash(&mut names);
        let texts = |all: &[Named]| all.iter().map(|one| one.text.clone()).collect::<Vec<String>>();
        (&outline.exports, texts(&outline.deployables)).hash(&mut names);
        (texts(&outline.includes), texts(&outline.beside)).hash(&mut uses);
        for component in &outline.components {
            if let Some(Implementation::Composite(name)) = &component.implementation {
                name.text.hash(&mut uses);
            }
        }
        Self { names: names.finish(), uses: uses.finish() }
    }
}

impl Workspace {
    /// Takes other texts as those that are open.
    pub fn set_open(&mut self, open: OpenTexts) {
        self.open = open;
    }

    /// One in which composites may name files anywhere, or only in their folder, in their contribution, and in the
    /// folders that the editor has open.
    pub fn new(allow_outside: bool) -> Self {
        Self { allow_outside, ..Self::default() }
    }

    /// Takes other folders as those that the editor has open.
    pub fn set_folders(&mut self, folders: &[PathBuf]) {
        self.folders = folders.iter().map(|folder| identity(folder)).collect();
    }

    /// What composites in a folder may name.
    fn bounds(&mut self, folder: &Path) -> Bounds {
        if self.allow_outside {
            return Bounds(None);
        }
        let description = self.listing(folder).description;
        let root = description.as_deref().and_then(Path::parent);
        let root = root.and_then(|root| if root.ends_with("META-INF") { root.parent() } else { Some(root) });
        let own = [Some(folder), root].into_iter().flatten().map(identity);
        Bounds(Some(own.chain(self.folders.iter().cloned()).collect()))
    }

    /// Looks at the disk anew.
    pub fn refresh(&mut self) {
        self.listings.clear();
        self.identities = None;
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
        let is_table = path.extension().is_some_and(|ending| VALUES.iter().any(|known| ending == *known));
        let mut identities = self.identities_of(&others);
        let mut is_beside = identities.values().any(|one| one == path);
        if !is_beside && is_table {
            is_beside = true;
            // The composite may be in another folder: one that was looked at before is found.
            let known: Vec<Arc<File>> = self.files.values().map(|(_, file)| Arc::clone(file)).collect();
            let owners = known.iter().filter(|file| !file.outline.beside.is_empty());
            let owner = owners.filter(|file| self.identities_of(&[Arc::clone(file)]).values().any(|one| one == path));
            if let Some(owner) = owner.map(|file| &file.path).min().and_then(|owner| owner.parent()) {
                folder = owner.to_owned();
                others = self.composites_in(&folder, path);
                identities = self.identities_of(&others);
            }
        }
        let file = self.file(path, is_beside);
        identities.extend(self.identities_of(file.as_slice()));
        let mut all: Vec<Arc<File>> = file.into_iter().chain(others).collect();
        let mut known: HashSet<PathBuf> = all.iter().map(|file| file.path.clone()).collect();
        let bounds = self.bounds(&folder);
        for path in identities.values().collect::<BTreeSet<_>>() {
            if bounds.hold(path) && known.insert(path.clone()) {
                all.extend(self.file(path, true));
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
        Surroundings { files: all, own, known, identities, bounds }
    }

    /// What files that have the same others around them have in common: the description of their contribution, or else
    /// their folder.
    pub fn group(&mut self, path: &Path) -> PathBuf {
        let folder = path.parent().unwrap_or(Path::new(""));
        self.listing(folder).description.unwrap_or_else(|| folder.to_owned())
    }

    /// The shape of a file.
    pub fn shape(&mut self, path: &Path) -> Shape {
        let is_table = path.extension().is_some_and(|ending| VALUES.iter().any(|known| ending == *known));
        match self.file(path, is_table) {
            Some(file) => Shape::of(&file),
            None => Shape::default(),
        }
    }

    /// The files that composites take values from, by the paths that they write.
    fn identities_of(&mut self, composites: &[Arc<File>]) -> HashMap<PathBuf, PathBuf> {
        let known = self.identities.take().filter(|(then, _)| then.elapsed() < FRESH);
        let (_, known) = self.identities.insert(known.unwrap_or_else(|| (Instant::now(), HashMap::new())));
        let written = composites.iter().flat_map(|file| {
            let folder = file.path.parent().unwrap_or(Path::new(""));
            file.outline.beside.iter().map(move |name| folder.join(&name.text))
        });
        let found = written.map(|path| {
            let found = known.entry(path.clone()).or_insert_with(|| identity(&path)).clone();
            (path, found)
        });
        found.collect()
    }

    /// All composites in these folders, and those around the files that are open.
    pub fn all(&mut self, folders: &[PathBuf], open: &[PathBuf]) -> Vec<Arc<File>> {
        let folders: BTreeSet<PathBuf> = folders.iter().map(|path| identity(path)).collect();
        let mut all: BTreeMap<PathBuf, Arc<File>> = BTreeMap::new();
        for folder in folders {
            all.extend(self.composites_in(&folder, Path::new("")).into_iter().map(|file| (file.path.clone(), file)));
        }
        for path in open {
            let folder = path.parent().filter(|_| !all.contains_key(path)).map(Path::to_owned);
            let beside = folder.map(|folder| self.composites_in(&folder, Path::new(""))).unwrap_or_default();
            all.extend(beside.into_iter().map(|file| (file.path.clone(), file)));
        }
        all.into_values().collect()
    }

    /// The composites that one in a folder can name, and what describes its contribution, but for one file. Of a folder
    /// with more in it than an editor can hold at hand, those that are open, and the first others.
    fn composites_in(&mut self, folder: &Path, but: &Path) -> Vec<Arc<File>> {
        let listed = self.listing(folder);
        let others = listed.composites.iter().chain(&listed.description).filter(|other| *other != but);
        let mut left = MOST_BYTES;
        let file = |one: &PathBuf| {
            let is_open = self.open.get(one).is_some();
            if left == 0 && !is_open {
                return None;
            }
            let file = self.file(one, false)?;
            left = left.saturating_sub(if is_open { 0 } else { file.text.len() });
            Some(file)
        };
        others.filter_map(file).collect()
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
