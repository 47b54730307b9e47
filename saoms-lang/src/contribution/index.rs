//! Index of the composites in folders, by namespace and name. Of a file no more is read than its first tag.

use std::collections::{HashMap, VecDeque};
use std::ffi::{OsStr, OsString};
use std::fs::{self, FileType};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::head::{Head, head};
use crate::diagnostic::quoted;
use crate::limits::{FLEET_ENTRIES, FOLDERS_ABOVE};
use crate::load::description;
use crate::source::{OpenTexts, identity};

/// The folder in a contribution whose composites are deployable, as Apache Tuscany has it.
pub(super) const DEPLOYABLES: &str = "META-INF/sca-deployables";
/// The name of files of intents and policy sets.
const DEFINITIONS: &str = "definitions.xml";
/// Folders that hold what tools made.
const SKIPPED: &[&str] = &["target", "node_modules"];

/// Index of the files in folders. Each folder and each first tag is read once.
pub(super) struct Index {
    folders: HashMap<PathBuf, Rc<Listing>>,
    /// The composites in folders.
    names: HashMap<PathBuf, Rc<Names>>,
    /// Those in folders and below.
    names_below: HashMap<PathBuf, Rc<Names>>,
    roots: HashMap<PathBuf, PathBuf>,
    left: usize,
    /// True if there were more entries than are looked at.
    pub(super) is_cut: bool,
    /// The folders that cannot be read, each with the reason.
    pub(super) unreadable: Vec<(PathBuf, io::Error)>,
    open: OpenTexts,
}

/// Files and folders of a folder or a contribution, sorted.
#[derive(Debug, Default)]
pub(super) struct Listing {
    pub(super) composites: Vec<PathBuf>,
    /// Definitions of policies.
    pub(super) definitions: Vec<PathBuf>,
    /// The folders in a folder; for a contribution those of other contributions below it.
    pub(super) folders: Vec<PathBuf>,
}

/// The files called as composites in folders.
#[derive(Default)]
pub(super) struct Names {
    /// By the local names of the composites in them, of one name the likeliest first.
    composites: HashMap<String, Vec<Head>>,
    /// Those that are none as far as could be read, by their own names: the first of each.
    unread: HashMap<OsString, PathBuf>,
}

impl Names {
    /// The likeliest composite of this name in one of these namespaces, or in any.
    fn find(&self, namespaces: Option<&[String]>, local: &str) -> Option<&Head> {
        let mut named = self.composites.get(local)?.iter();
        named.find(|one| namespaces.is_none_or(|meant| meant.contains(&one.namespace)))
    }

    /// All composites, sorted by their paths.
    pub(super) fn heads(&self) -> Vec<&Head> {
        let mut all: Vec<&Head> = self.composites.values().flatten().collect();
        all.sort_unstable_by_key(|head| &head.path);
        all
    }

    /// The number of composites.
    pub(super) fn len(&self) -> usize {
        self.composites.values().map(Vec::len).sum()
    }

    /// The first composite of this local name, by its path.
    pub(super) fn named(&self, local: &str) -> Option<&Head> {
        self.composites.get(local)?.iter().min_by_key(|head| &head.path)
    }

    fn extend(&mut self, other: &Self) {
        for (local, heads) in &other.composites {
            self.composites.entry(local.clone()).or_default().extend_from_slice(heads);
        }
        for (name, path) in &other.unread {
            self.unread.entry(name.clone()).or_insert_with(|| path.clone());
        }
    }
}

impl Index {
    /// Nothing is known yet but the texts that count in place of files.
    pub(super) fn new(open: OpenTexts) -> Self {
        Self {
            folders: HashMap::new(),
            names: HashMap::new(),
            names_below: HashMap::new(),
            roots: HashMap::new(),
            left: FLEET_ENTRIES,
            is_cut: false,
            unreadable: Vec::new(),
            open,
        }
    }

    /// Lets so many more entries of folders that are not known yet be looked at.
    pub(super) fn limit(&mut self, left: usize) {
        self.left = left;
    }

    /// The composite with this name in one of these namespaces, or in any, as a file in `folder` means it: in the
    /// folder, or else in its contribution, the upper folders first.
    pub(super) fn find(&mut self, folder: &Path, namespaces: Option<&[String]>, local: &str) -> Option<Head> {
        let here = self.names(folder).find(namespaces, local).cloned();
        here.or_else(|| self.names_around(folder).find(namespaces, local).cloned())
    }

    /// The other files that hold a composite of the same name and namespace as one that was found: in its folder, and
    /// those of its file's name in the folders of a contribution that is described as such.
    pub(super) fn twins(&mut self, found: &Head) -> Vec<PathBuf> {
        let folder = found.path.parent().unwrap_or(Path::new(""));
        let root = self.root(folder);
        let of_name = |names: &Names| -> Vec<PathBuf> {
            let named = names.composites.get(&found.local).into_iter().flatten();
            named.filter(|one| one.namespace == found.namespace).map(|one| one.path.clone()).collect()
        };
        let mut all = of_name(&self.names(folder));
        if describes(&root) {
            let elsewhere = of_name(&self.names_below(&root)).into_iter().filter(|path| {
                let other = path.parent().filter(|other| *other != folder);
                path.file_name() == found.path.file_name() && other.is_some_and(|other| self.root(other) == root)
            });
            let mut elsewhere: Vec<PathBuf> = elsewhere.collect();
            elsewhere.sort_unstable();
            all.extend(elsewhere);
        }
        let own = identity(&found.path);
        all.retain(|path| identity(path) != own);
        all
    }

    fn names(&mut self, folder: &Path) -> Rc<Names> {
        if let Some(known) = self.names.get(folder) {
            return Rc::clone(known);
        }
        let mut names = Names::default();
        for path in &self.listing(folder).composites {
            match (head(path, &self.open), path.file_stem()) {
                (Some(head), _) => names.composites.entry(head.local.clone()).or_default().push(head),
                (None, Some(name)) => _ = names.unread.insert(name.to_owned(), path.clone()),
                (None, None) => {}
            }
        }
        for (local, heads) in &mut names.composites {
            // As a rule a file is called as the composite in it.
            heads.sort_by_key(|head| head.path.file_stem().is_none_or(|stem| stem != local.as_str()));
        }
        let names = Rc::new(names);
        self.names.insert(folder.to_owned(), Rc::clone(&names));
        names
    }

    /// The composites in a folder and below, those of the upper folders first.
    fn names_below(&mut self, root: &Path) -> Rc<Names> {
        if let Some(known) = self.names_below.get(root) {
            return Rc::clone(known);
        }
        let mut names = Names::default();
        for folder in self.folders(root, |_| true).0 {
            names.extend(&self.names(&folder));
        }
        let names = Rc::new(names);
        self.names_below.insert(root.to_owned(), Rc::clone(&names));
        names
    }

    /// The composites in the contribution of `folder`.
    pub(super) fn names_around(&mut self, folder: &Path) -> Rc<Names> {
        let root = self.root(folder);
        self.names_below(&root)
    }

    /// The files in a folder whose endings say that they are composites, and which are none as far as could be read.
    pub(super) fn unread(&mut self, folder: &Path) -> Vec<PathBuf> {
        let mut all: Vec<PathBuf> = self.names(folder).unread.values().cloned().collect();
        all.sort_unstable();
        all
    }

    /// The file in the contribution of `folder` that is called as a composite of this name is, and is none as far as
    /// could be read: that is probably meant.
    pub(super) fn unread_named(&mut self, folder: &Path, local: &str) -> Option<PathBuf> {
        self.names_around(folder).unread.get(OsStr::new(local)).cloned()
    }

    /// The places that were searched for composites, as a sentence.
    pub(super) fn searched(&mut self, folder: &Path) -> String {
        let root = self.root(folder);
        let shown = if root.as_os_str().is_empty() { Path::new(".") } else { &root };
        let shown = quoted(&shown.display().to_string());
        match (self.is_cut, self.unreadable.first()) {
            (true, _) => format!(
                "searched only the first ten thousand files or so in {shown} and below; name the file of that \
                composite in the command as well"
            ),
            (false, Some((folder, error))) => format!(
                "searched the files `*.composite` in {shown} and below, but not in {}, which cannot be read: {error}",
                quoted(&folder.display().to_string())
            ),
            (false, None) => format!("searched the files `*.composite` in {shown} and below"),
        }
    }

    /// The folder of the contribution that `folder` is in.
    pub(super) fn root(&mut self, folder: &Path) -> PathBuf {
        self.roots.entry(folder.to_owned()).or_insert_with(|| root(folder)).clone()
    }

    /// The folders from one down, the upper ones first, as far as they are to be entered, and those that are not.
    pub(super) fn folders(&mut self, root: &Path, enters: impl Fn(&Path) -> bool) -> (Vec<PathBuf>, Vec<PathBuf>) {
        let (mut entered, mut others) = (Vec::new(), Vec::new());
        let mut waiting = VecDeque::from([root.to_owned()]);
        while let Some(next) = waiting.pop_front() {
            if next == root || enters(&next) {
                // Below the root of the file system are the files of everybody.
                let below = self.listing(&next);
                waiting.extend(below.folders.iter().filter(|_| next != Path::new("/")).cloned());
                entered.push(next);
            } else {
                others.push(next);
            }
        }
        (entered, others)
    }

    /// The folders of the contribution in a folder, and those of other contributions below it.
    fn own_folders(&mut self, root: &Path) -> (Vec<PathBuf>, Vec<PathBuf>) {
        self.folders(root, |folder| !describes(folder))
    }

    /// The files of the contribution in a folder.
    pub(super) fn contents(&mut self, root: &Path) -> Listing {
        let (own, folders) = self.own_folders(root);
        let mut all = Listing { folders, ..Listing::default() };
        for folder in own {
            let listing = self.listing(&folder);
            all.composites.extend_from_slice(&listing.composites);
            all.definitions.extend_from_slice(&listing.definitions);
        }
        for paths in [&mut all.composites, &mut all.definitions, &mut all.folders] {
            paths.sort_unstable();
        }
        all
    }

    /// The composites of the contribution in a folder, sorted by their paths.
    pub(super) fn heads(&mut self, root: &Path) -> Vec<Head> {
        let mut names = Names::default();
        for folder in self.own_folders(root).0 {
            names.extend(&self.names(&folder));
        }
        names.heads().into_iter().cloned().collect()
    }

    /// Makes a file that was found for one in `folder` one of its contribution.
    pub(super) fn adopt(&mut self, folder: &Path, found: &Path) {
        let root = self.root(folder);
        let own = found.parent().unwrap_or(Path::new("")).to_owned();
        self.roots.entry(own).or_insert(root);
    }

    fn listing(&mut self, folder: &Path) -> Rc<Listing> {
        if let Some(known) = self.folders.get(folder) {
            return Rc::clone(known);
        }
        let mut listing = Listing::default();
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let entries = match fs::read_dir(here) {
            Ok(entries) => Some(entries),
            // It is looked for because of a text that has no file.
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => None,
            Err(error) => {
                self.unreadable.push((here.to_owned(), error));
                None
            }
        };
        for entry in entries.into_iter().flatten() {
            let entry = match entry {
                Ok(entry) => entry,
                Err(error) => {
                    self.unreadable.push((here.to_owned(), error));
                    break;
                }
            };
            let Some(left) = self.left.checked_sub(1) else {
                self.is_cut = true;
                break;
            };
            self.left = left;
            let (name, path) = (entry.file_name(), folder.join(entry.file_name()));
            let name = name.to_string_lossy();
            // As for a pattern of a shell, what is hidden is not there: editors leave locks and copies beside files.
            if name.starts_with('.') {
                continue;
            }
            // Links to folders may lead around in circles, and are not followed.
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && SKIPPED.contains(&&*name) => {}
                Ok(kind) if kind.is_dir() => listing.folders.push(path),
                Ok(kind) if name.ends_with(".composite") && may_be_read(kind, &path) => listing.composites.push(path),
                Ok(kind) if name == DEFINITIONS && may_be_read(kind, &path) => listing.definitions.push(path),
                _ => {}
            }
        }
        for path in self.open.inside(here) {
            // It need not be on disk.
            let path = path.file_name().map_or_else(|| path.to_owned(), |name| folder.join(name));
            if path.extension().is_some_and(|ending| ending == "composite") {
                listing.composites.push(path);
            }
        }
        listing.composites.sort_unstable();
        listing.composites.dedup();
        listing.folders.sort_unstable();
        let listing = Rc::new(listing);
        self.folders.insert(folder.to_owned(), Rc::clone(&listing));
        listing
    }
}

/// True if what is in a folder is a file, or a link to one or to nowhere, which is reported when it is read. A pipe is
/// not read: it may never end.
fn may_be_read(kind: FileType, path: &Path) -> bool {
    kind.is_file() || kind.is_symlink() && fs::metadata(path).map_or(true, |about| about.is_file())
}

/// The files `*.composite` whose composites one in `folder` can name: those in it, and those of its contribution, as
/// [`load_named`](super::Finder::load_named) looks for them. Texts that count in place of files are among them.
pub fn composites_near(folder: &Path, open: &OpenTexts) -> Vec<PathBuf> {
    let mut index = Index::new(open.clone());
    let below = index.folders(&root(folder), |_| true).0.into_iter().filter(|below| below != folder);
    let all = std::iter::once(folder.to_owned()).chain(below);
    all.flat_map(|folder| index.listing(&folder).composites.clone()).collect()
}

/// The file that describes the contribution that a folder is in; `None` where there is none.
pub fn description_near(folder: &Path) -> Option<PathBuf> {
    description::path_in(&root(folder))
}

/// True if a folder has a description of a contribution, or says by its folders what is deployable: one of its own, and
/// not for the folder around it.
pub(super) fn describes(folder: &Path) -> bool {
    let is_described = || description::DESCRIPTIONS.iter().any(|name| folder.join(name).is_file());
    !folder.ends_with("META-INF") && (is_described() || folder.join(DEPLOYABLES).is_dir())
}

/// The nearest folder from `folder` up that describes a contribution; `folder` itself where there is none.
pub fn root(folder: &Path) -> PathBuf {
    // The folder that we are in, which an empty path means, has no absolute one by that name.
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(absolute) = std::path::absolute(here) else { return folder.to_owned() };
    let found = absolute.ancestors().take(FOLDERS_ABOVE).position(describes);
    let Some(above) = found else { return folder.to_owned() };
    // As the user wrote it, where that goes up far enough.
    let written = folder.ancestors().nth(above).filter(|written| above == 0 || written.file_name().is_some());
    written.or(absolute.ancestors().nth(above)).unwrap_or(folder).to_owned()
}

/// True if a file is called as those of definitions are.
pub(super) fn is_of_definitions(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name == DEFINITIONS)
}
