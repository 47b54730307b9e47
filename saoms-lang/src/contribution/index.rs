//! Index of the composites in folders, by namespace and name. No more is read than a search needs.

use std::collections::{BTreeSet, HashMap, HashSet, VecDeque};
use std::ffi::{OsStr, OsString};
use std::fs::{self, FileType};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::head::{Head, head};
use crate::diagnostic::quoted;
use crate::limits::{ASKED_FOLDER_ENTRIES, FLEET_ENTRIES, FOLDERS_ABOVE};
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
    heads: HashMap<PathBuf, Option<Head>>,
    /// The composites in folders; of one name those first whose files are called as they are.
    names: HashMap<PathBuf, ByName<Vec<PathBuf>>>,
    /// The progress of the search in contributions, by their folders.
    walks: HashMap<PathBuf, Walk>,
    /// The composites of contributions that were looked through.
    seen: HashMap<PathBuf, Rc<Seen>>,
    /// The composites of contributions by the names of their files; none of a folder that nobody describes as one.
    files: HashMap<PathBuf, HashMap<OsString, Vec<PathBuf>>>,
    roots: HashMap<PathBuf, PathBuf>,
    /// The names that were searched, by folder: names are used again and again.
    found: HashMap<Wanted, Option<PathBuf>>,
    /// Of contributions that were looked through, the files called as composites that are none as far as could be read:
    /// the first of each name.
    unread: HashMap<PathBuf, HashMap<OsString, PathBuf>>,
    left: usize,
    /// True if there were more entries than are looked at.
    is_cut: bool,
    open: OpenTexts,
}

/// Values by the local name of a composite and then its namespace.
type ByName<T> = HashMap<String, HashMap<String, T>>;

/// A folder, namespaces and a local name.
type Wanted = (PathBuf, Option<Vec<String>>, String);

/// The composites in a folder, and the folders in it, sorted.
#[derive(Debug, Default)]
pub(super) struct Listing {
    composites: Vec<PathBuf>,
    folders: Vec<PathBuf>,
    /// Definitions of policies.
    definitions: Vec<PathBuf>,
}

/// A way through the folders of a contribution, the upper ones first, that goes on where it stopped.
struct Walk {
    waiting: VecDeque<PathBuf>,
    seen: HashSet<PathBuf>,
    /// The folders behind it, in their order.
    behind: Vec<PathBuf>,
    /// The first of them that holds a composite of a name.
    holders: ByName<usize>,
}

/// The composites that were seen in a contribution.
pub(super) struct Seen {
    /// Sorted by their paths.
    pub(super) heads: Vec<Head>,
    /// The first of each local name.
    firsts: HashMap<String, usize>,
}

impl Seen {
    /// The first composite of this local name.
    pub(super) fn named(&self, local: &str) -> Option<&Head> {
        self.firsts.get(local).map(|place| &self.heads[*place])
    }
}

impl Index {
    /// Nothing is known yet but the texts that count in place of files.
    pub(super) fn new(open: OpenTexts) -> Self {
        Self {
            folders: HashMap::new(),
            heads: HashMap::new(),
            names: HashMap::new(),
            walks: HashMap::new(),
            seen: HashMap::new(),
            files: HashMap::new(),
            roots: HashMap::new(),
            found: HashMap::new(),
            unread: HashMap::new(),
            left: FLEET_ENTRIES,
            is_cut: false,
            open,
        }
    }

    /// For another fleet as many entries of folders that are not known yet are looked at.
    pub(super) fn turn_to_fleet(&mut self) {
        self.left = FLEET_ENTRIES;
    }

    /// In a folder that somebody asks for, more entries are looked at.
    pub(super) fn turn_to_folder(&mut self) {
        self.left = ASKED_FOLDER_ENTRIES;
    }

    /// Lets only so many more entries be looked at.
    #[cfg(test)]
    pub(super) fn limit(&mut self, left: usize) {
        self.left = left;
    }

    /// The file of the composite with this name in one of these namespaces, or in any, as a file in `folder` means it.
    pub(super) fn find(&mut self, folder: &Path, namespaces: Option<&[String]>, local: &str) -> Option<PathBuf> {
        let wanted = (folder.to_owned(), namespaces.map(<[String]>::to_vec), local.to_owned());
        if let Some(known) = self.found.get(&wanted) {
            return known.clone();
        }
        let found = self.look_for(folder, namespaces, local);
        self.found.insert(wanted, found.clone());
        found
    }

    fn look_for(&mut self, folder: &Path, namespaces: Option<&[String]>, local: &str) -> Option<PathBuf> {
        if let Some(found) = self.find_in(folder, namespaces, local) {
            return Some(found);
        }
        let root = self.root(folder);
        let mut walk = self.walks.remove(&root).unwrap_or_else(|| Walk::from(root.clone()));
        let holder = walk.holders.get(local).and_then(|holders| fitting(holders, namespaces).min());
        let mut found = holder.and_then(|place| self.find_in(&walk.behind[*place], namespaces, local));
        while found.is_none()
            && let Some(next) = walk.waiting.pop_front()
        {
            if walk.seen.insert(next.clone()) {
                walk.waiting.extend(self.listing(&next).folders.iter().cloned());
                for (local, of_namespaces) in self.names(&next) {
                    let holders = walk.holders.entry(local.clone()).or_default();
                    for namespace in of_namespaces.keys() {
                        holders.entry(namespace.clone()).or_insert(walk.behind.len());
                    }
                }
                found = self.find_in(&next, namespaces, local);
                walk.behind.push(next);
            }
        }
        self.walks.insert(root, walk);
        found
    }

    /// The other files that hold a composite of the same name and namespace as one that was found: in its folder, and
    /// those of its file's name in the folders of a contribution that is described as such.
    pub(super) fn twins(&mut self, found: &Path) -> Vec<PathBuf> {
        let Some(Head { namespace, local, .. }) = self.head(found).clone() else { return Vec::new() };
        let folder = found.parent().unwrap_or(Path::new(""));
        let here = self.names(folder).get(&local).and_then(|named| named.get(&namespace));
        let mut all: Vec<PathBuf> = here.into_iter().flatten().cloned().collect();
        let root = self.root(folder);
        let of_its_name = found.file_name().and_then(|name| self.files(&root).get(name));
        let elsewhere = of_its_name.into_iter().flatten().filter(|path| path.parent() != found.parent());
        let elsewhere: Vec<PathBuf> = elsewhere.cloned().collect();
        let is_same = |head: &Head| head.namespace == namespace && head.local == local;
        all.extend(elsewhere.into_iter().filter(|path| self.head(path).as_ref().is_some_and(is_same)));
        let own = identity(found);
        all.retain(|path| identity(path) != own);
        all
    }

    fn find_in(&mut self, folder: &Path, namespaces: Option<&[String]>, local: &str) -> Option<PathBuf> {
        let named = self.names(folder).get(local)?;
        let firsts = fitting(named, namespaces).filter_map(|paths| paths.first());
        firsts.min_by_key(|path| (!is_called(path, local), *path)).cloned()
    }

    fn names(&mut self, folder: &Path) -> &ByName<Vec<PathBuf>> {
        if !self.names.contains_key(folder) {
            let mut names: ByName<Vec<PathBuf>> = HashMap::new();
            for path in &self.listing(folder).composites {
                if let Some(Head { namespace, local, .. }) = self.head(path).clone() {
                    names.entry(local).or_default().entry(namespace).or_default().push(path.clone());
                }
            }
            for (local, of_namespaces) in &mut names {
                for paths in of_namespaces.values_mut() {
                    paths.sort_by_key(|path| !is_called(path, local));
                }
            }
            self.names.insert(folder.to_owned(), names);
        }
        &self.names[folder]
    }

    fn files(&mut self, root: &Path) -> &HashMap<OsString, Vec<PathBuf>> {
        if !self.files.contains_key(root) {
            let mut files: HashMap<OsString, Vec<PathBuf>> = HashMap::new();
            let all = if describes(root) { self.contribution(root).0 } else { Vec::new() };
            for path in all {
                if let Some(name) = path.file_name() {
                    files.entry(name.to_owned()).or_default().push(path);
                }
            }
            self.files.insert(root.to_owned(), files);
        }
        &self.files[root]
    }

    /// The composites of the contribution of `folder`, which was looked through for a name that it does not have.
    pub(super) fn seen(&mut self, folder: &Path) -> Rc<Seen> {
        let root = self.root(folder);
        if let Some(known) = self.seen.get(&root) {
            return Rc::clone(known);
        }
        let folders = self.walks.get(&root).map_or_else(Vec::new, |walk| walk.behind.clone());
        let paths = folders.iter().flat_map(|folder| self.listing(folder).composites.clone());
        let paths: Vec<PathBuf> = paths.collect();
        let mut heads: Vec<Head> = paths.iter().filter_map(|path| self.head(path).clone()).collect();
        heads.sort_by(|one, other| one.path.cmp(&other.path));
        let mut firsts = HashMap::new();
        for (place, head) in heads.iter().enumerate() {
            firsts.entry(head.local.clone()).or_insert(place);
        }
        let seen = Rc::new(Seen { heads, firsts });
        self.seen.insert(root, Rc::clone(&seen));
        seen
    }

    /// The files in a folder whose endings say that they are composites, and which are none as far as could be read.
    pub(super) fn unread(&mut self, folder: &Path) -> Vec<PathBuf> {
        let all = self.listing(folder).composites.clone();
        all.into_iter().filter(|path| self.head(path).is_none()).collect()
    }

    /// The file in the contribution of `folder`, which was looked through for a name that it does not have, that is
    /// called as a composite of this name is, and is none as far as could be read: that is probably meant.
    pub(super) fn unread_named(&mut self, folder: &Path, local: &str) -> Option<PathBuf> {
        let root = self.root(folder);
        if !self.unread.contains_key(&root) {
            let folders = self.walks.get(&root).map_or_else(Vec::new, |walk| walk.behind.clone());
            let mut all: HashMap<OsString, PathBuf> = HashMap::new();
            for path in folders.iter().flat_map(|folder| self.unread(folder)) {
                if let Some(stem) = path.file_stem() {
                    all.entry(stem.to_owned()).or_insert(path);
                }
            }
            self.unread.insert(root.clone(), all);
        }
        self.unread[&root].get(OsStr::new(local)).cloned()
    }

    /// The places that were searched for composites, as a sentence.
    pub(super) fn searched(&mut self, folder: &Path) -> String {
        let root = self.root(folder);
        let shown = if root.as_os_str().is_empty() { Path::new(".") } else { &root };
        let shown = quoted(&shown.display().to_string());
        match self.is_cut {
            true => format!(
                "looked among some ten thousand files in {shown} and below, and not in all; name the file of the composite beside this one"
            ),
            false => format!("looked in the files `*.composite` in {shown} and below"),
        }
    }

    /// The folder of the contribution that `folder` is in.
    pub(super) fn root(&mut self, folder: &Path) -> PathBuf {
        if let Some(known) = self.roots.get(folder) {
            return known.clone();
        }
        let found = root(folder);
        self.roots.insert(folder.to_owned(), found.clone());
        found
    }

    /// The composites of the contribution in a folder, sorted, and the folders of other contributions below it.
    pub(super) fn contribution(&mut self, root: &Path) -> (Vec<PathBuf>, Vec<PathBuf>) {
        let (mut composites, mut others) = (Vec::new(), Vec::new());
        let mut waiting = vec![root.to_owned()];
        let mut seen = HashSet::new();
        while let Some(next) = waiting.pop() {
            if next != root && describes(&next) {
                others.push(next);
            } else if seen.insert(next.clone()) {
                let listing = self.listing(&next);
                composites.extend(listing.composites.iter().cloned());
                waiting.extend(listing.folders.iter().cloned());
            }
        }
        composites.sort_unstable();
        others.sort_unstable();
        (composites, others)
    }

    /// The files of definitions in a contribution, sorted.
    pub(super) fn definitions(&mut self, root: &Path) -> Vec<PathBuf> {
        let (mut all, mut waiting) = (Vec::new(), vec![root.to_owned()]);
        while let Some(next) = waiting.pop() {
            if next == root || !describes(&next) {
                let listing = self.listing(&next);
                all.extend_from_slice(&listing.definitions);
                waiting.extend_from_slice(&listing.folders);
            }
        }
        all.sort_unstable();
        all
    }

    /// The namespaces of the composites in a contribution.
    pub(super) fn namespaces(&mut self, root: &Path) -> BTreeSet<String> {
        let composites = self.contribution(root).0.into_iter();
        composites.filter_map(|path| Some(self.head(&path).as_ref()?.namespace.clone())).collect()
    }

    /// True if every file was looked at.
    pub(super) fn is_complete(&self) -> bool {
        !self.is_cut
    }

    /// Makes a file that was found for one in `folder` one of its contribution.
    pub(super) fn adopt(&mut self, folder: &Path, found: &Path) {
        let root = self.root(folder);
        let own = found.parent().unwrap_or(Path::new("")).to_owned();
        self.roots.entry(own).or_insert(root);
    }

    pub(super) fn listing(&mut self, folder: &Path) -> Rc<Listing> {
        if let Some(known) = self.folders.get(folder) {
            return Rc::clone(known);
        }
        let mut listing = Listing::default();
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        for entry in fs::read_dir(here).into_iter().flatten().flatten() {
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
                Ok(kind) if name.ends_with(".composite") && may_be_read(kind, &path) => {
                    listing.composites.push(path);
                }
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

    /// True if a file holds a composite of this namespace.
    pub(super) fn is_of(&mut self, path: &Path, namespace: &str) -> bool {
        self.head(path).as_ref().is_some_and(|head| head.namespace == namespace)
    }

    pub(super) fn head(&mut self, path: &Path) -> &Option<Head> {
        self.heads.entry(path.to_owned()).or_insert_with(|| head(path, &self.open))
    }
}

/// True if what is in a folder is a file, or a link to one or to nowhere, which is told when it is read. Of a pipe
/// nobody knows that it ever ends.
fn may_be_read(kind: FileType, path: &Path) -> bool {
    kind.is_file() || kind.is_symlink() && fs::metadata(path).map_or(true, |about| about.is_file())
}

impl From<PathBuf> for Walk {
    fn from(root: PathBuf) -> Self {
        let waiting = VecDeque::from([root]);
        Self { waiting, seen: HashSet::new(), behind: Vec::new(), holders: HashMap::new() }
    }
}

/// The composites of one of these namespaces, or of any.
fn fitting<'a, T>(
    of_namespaces: &'a HashMap<String, T>,
    namespaces: Option<&'a [String]>,
) -> impl Iterator<Item = &'a T> {
    let meant = namespaces.into_iter().flatten().filter_map(|namespace| of_namespaces.get(namespace));
    meant.chain(of_namespaces.values().filter(move |_| namespaces.is_none()))
}

/// True if a file is called as a composite, as most are that hold it.
fn is_called(path: &Path, local: &str) -> bool {
    path.file_stem().is_some_and(|stem| stem == local)
}

/// The files `*.composite` whose composites one in `folder` can name: those in it, and those of its contribution, as
/// [`load_named`](super::load_named) looks for them. Texts that count in place of files are among them.
pub fn composites_near(folder: &Path, open: &OpenTexts) -> Vec<PathBuf> {
    let mut index = Index::new(open.clone());
    let mut all = index.listing(folder).composites.clone();
    let mut waiting = VecDeque::from([index.root(folder)]);
    let mut seen = HashSet::new();
    while let Some(next) = waiting.pop_front() {
        if seen.insert(next.clone()) {
            let listing = index.listing(&next);
            if next != folder {
                all.extend(listing.composites.iter().cloned());
            }
            waiting.extend(listing.folders.iter().cloned());
        }
    }
    all
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
pub(super) fn root(folder: &Path) -> PathBuf {
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
