//! Folders as contributions.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use super::finder::{Finder, misnamed_in};
use super::index::{DEPLOYABLES, Index, describes};
use crate::diagnostic::{Diagnostic, Diagnostics, Severity, codes, nearest, quoted};
use crate::limits::ASKED_FOLDER_ENTRIES;
use crate::load::description::{Deployable, Description};
use crate::load::{ReadContext, definitions, load_file, read};
use crate::model::{Composite, Contribution, Link};
use crate::source::{Location, Sources, Span, Text, identity};
use crate::syntax::escaped;

/// Composites in a folder that form one fleet: no other composite there names them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FolderFleet {
    /// Their files.
    pub files: Vec<PathBuf>,
    /// True if `sca-contribution.xml` says that they run. Others may be parts of fleets that are elsewhere.
    pub is_deployable: bool,
    /// True if it says that other contributions may take them, and not that they run.
    pub is_exported: bool,
}

/// A deployable composite that another one of its contribution uses.
#[derive(Clone, Debug)]
pub(crate) struct InnerDeployable {
    /// The place that calls it deployable.
    pub(crate) at: Location,
    /// The name of a composite that uses it.
    pub(crate) user: String,
}

impl Finder {
    /// Looks at a folder as a contribution, and at those in folders below it: the fleets in it. What
    /// `sca-contribution.xml` calls `deployable` is one fleet, and every other composite that no composite there names
    /// is one of its own.
    ///
    /// Reported is what is wrong with descriptions, with deployables that are not there, and with composites that share
    /// a name; and that there are no composites, more files than are looked at, or links that lead to no file. What is
    /// wrong with the composites themselves is found when they are loaded as fleets.
    pub fn load_folder(
        &mut self,
        folder: &Path,
        max_size: u64,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> Vec<FolderFleet> {
        let context = &mut ReadContext { max_size, sources, diagnostics };
        self.index.limit(ASKED_FOLDER_ENTRIES);
        let (mut fleets, mut has_definitions) = (Vec::new(), false);
        let mut waiting = vec![folder.to_owned()];
        while let Some(root) = waiting.pop() {
            let contents = self.index.contents(&root);
            waiting.extend(contents.folders.into_iter().rev());
            let description = Description::of(&root, context);
            if description.is_none() {
                misnamed_in(&root, context);
            }
            let contribution = Files::read(contents.composites, context);
            let repeated = contribution.repeated(describes(&root), context);
            self.repeated.extend(repeated.iter().map(|path| identity(path)));
            for path in contents.definitions {
                has_definitions |= definitions::check(&path, false, context);
            }
            if let Some(description) = &description {
                self.exchange(description, &root, context);
            }
            let deployables = description.iter().flat_map(|description| &description.deployables);
            let users = contribution.users();
            let mut deployed: Vec<Option<PathBuf>> = Vec::new();
            for one in deployables {
                let found = contribution.find(one, &mut self.index, &root, context.diagnostics);
                if let Some(path) = &found
                    && let Some(user) = users.get(path.as_path())
                {
                    let inner = InnerDeployable { at: one.name.location, user: user.name.to_string() };
                    self.inner_deployables.entry(path.clone()).or_insert(inner);
                }
                deployed.push(found);
            }
            let inside = root.join(DEPLOYABLES);
            deployed.extend(contribution.paths.iter().filter(|path| path.starts_with(&inside)).cloned().map(Some));
            contribution.fleets(deployed.into_iter().flatten().collect(), description.as_ref(), &mut fleets);
        }
        unreadable(&mut self.index, context.sources, context.diagnostics);
        let is_empty = fleets.is_empty() && !has_definitions && !context.diagnostics.has_errors();
        unlisted(folder, is_empty, &self.index, sources, diagnostics);
        fleets
    }

    /// Checks one description of the contribution in a folder: what is written in it, and whether what it calls
    /// deployable is there.
    pub(super) fn describe(&mut self, path: &Path, root: &Path, context: &mut ReadContext<'_>) {
        self.index.limit(ASKED_FOLDER_ENTRIES);
        let description = Description::read(path.to_owned(), context);
        self.exchange(&description, root, context);
        let files = self.index.contents(root).composites;
        let (max_size, unreported) = (context.max_size, &mut Diagnostics::new());
        let contribution =
            Files::read(files, &mut ReadContext { max_size, sources: context.sources, diagnostics: unreported });
        for deployable in &description.deployables {
            _ = contribution.find(deployable, &mut self.index, root, context.diagnostics);
        }
    }
}

/// The composites in a folder and in those below it, other contributions among them, in the order of their paths;
/// hidden files and generated ones are skipped. It is reported if there are none, or more files than the limit.
pub fn composites_below(folder: &Path, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Vec<PathBuf> {
    let mut index = Index::new(sources.open().clone());
    index.limit(ASKED_FOLDER_ENTRIES);
    let (mut all, mut waiting) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(root) = waiting.pop() {
        let contents = index.contents(&root);
        all.extend(contents.composites);
        waiting.extend(contents.folders);
    }
    all.sort_unstable();
    let is_empty = all.is_empty() && index.unreadable.is_empty();
    unreadable(&mut index, sources, diagnostics);
    unlisted(folder, is_empty, &index, sources, diagnostics);
    all
}

/// Reports the folders that could not be read: what is in them may be wrong, or be what others mean.
fn unreadable(index: &mut Index, sources: &mut Sources, diagnostics: &mut Diagnostics) {
    for (folder, error) in index.unreadable.drain(..) {
        let file = sources.add(folder.display().to_string(), "");
        let message = format!("the folder cannot be read: {error}");
        let one = Diagnostic::new(&codes::FILE_UNREADABLE, Span::empty(0).in_file(file), message);
        diagnostics.push(one.help("make it readable, or name the other folders and files one by one"));
    }
}

/// Reports a folder that has no composites, or too many files to look at all of them.
fn unlisted(folder: &Path, is_empty: bool, index: &Index, sources: &mut Sources, diagnostics: &mut Diagnostics) {
    let (message, help) = match (index.is_cut, is_empty) {
        (false, false) => return,
        (false, true) => ("the folder contains no composites", "the names of composites end with `.composite`"),
        (true, _) => ("the folder contains too many files", "name the folders in it one by one"),
    };
    let file = sources.add(folder.display().to_string(), "");
    let one = Diagnostic::new(&codes::FILE_IS_DIRECTORY, Span::empty(0).in_file(file), message);
    diagnostics.push(one.help(help));
}

/// The composites of one contribution.
struct Files {
    /// All of them, sorted.
    paths: Vec<PathBuf>,
    /// Those that could be read, and where each is among the paths.
    read: Contribution,
    places: Vec<usize>,
}

impl Files {
    /// Reads composites for the names in them. Their faults are reported when they are checked; a broken link is no
    /// composite, and reported.
    fn read(all: Vec<PathBuf>, context: &mut ReadContext<'_>) -> Self {
        let max_size = context.max_size;
        let (mut scratch, mut unreported) = (Sources::with_open(context.sources.open().clone()), Diagnostics::new());
        let (mut paths, mut composites, mut places) = (Vec::with_capacity(all.len()), Vec::new(), Vec::new());
        for path in all {
            let file = read(&path, max_size, &mut scratch, &mut unreported);
            if file.is_none() && path.is_symlink() && fs::metadata(&path).is_err() {
                context.read(&path);
                continue;
            }
            if let Some(composite) = file.and_then(|file| load_file(file, &scratch, &mut unreported)) {
                composites.push(composite);
                places.push(paths.len());
            }
            paths.push(path);
        }
        Self { paths, read: Contribution::with(Vec::new(), composites), places }
    }

    /// Reports composites of one namespace that have one name, and gives their files. A folder without a description
    /// need not be one contribution.
    fn repeated(&self, is_described: bool, context: &mut ReadContext<'_>) -> Vec<PathBuf> {
        let mut repeated = Vec::new();
        let mut first: HashMap<(&str, &str), usize> = HashMap::new();
        for (place, composite) in self.read.composites().iter().enumerate() {
            let name = (composite.namespace(), composite.name.as_str());
            if name.1.is_empty() {
                continue;
            }
            let Some(earlier) = first.get(&name) else {
                first.insert(name, place);
                continue;
            };
            repeated.extend([*earlier, place].map(|place| self.paths[self.places[place]].clone()));
            let mut place_of = |place: usize| {
                let path = &self.paths[self.places[place]];
                let file = read(path, context.max_size, context.sources, &mut Diagnostics::new())?;
                Some(self.read.composites()[place].name.location.span.in_file(file))
            };
            let (Some(at), Some(other)) = (place_of(place), place_of(*earlier)) else { continue };
            let message = format!("there are two composites {} in one namespace", quoted(name.1));
            let severity = if is_described { Severity::Error } else { Severity::Warning };
            let one = Diagnostic::new(&codes::COMPOSITE_REPEATED, at, message).severity(severity);
            context.diagnostics.push(one.label(other, "the first").help("give each its own name"));
        }
        repeated
    }

    /// The file of a deployable; one that is not there is reported.
    fn find(
        &self,
        deployable: &Deployable,
        index: &mut Index,
        root: &Path,
        diagnostics: &mut Diagnostics,
    ) -> Option<PathBuf> {
        let local = deployable.local();
        let namespaces = deployable.namespace.as_ref().map(std::slice::from_ref);
        // Also a file that could be read no further than its first tag.
        let found = index.find(root, namespaces, local).map(|found| found.path);
        let found = found.filter(|found| self.paths.binary_search(found).is_ok());
        // It may be in a folder that cannot be read, which is reported.
        if found.is_some() || !index.unreadable.is_empty() {
            return found;
        }
        let all = self.read.composites();
        let name = quoted(&deployable.name);
        let (at, prefix) = (deployable.name.location, deployable.name.as_str().strip_suffix(local));
        let of_namespace =
            |one: &&Composite| deployable.namespace.as_ref().is_none_or(|namespace| namespace == one.namespace());
        let message = format!("the contribution has no composite {name}");
        // Where there are none at all, they are put beside it by those who make the contribution of this folder and
        // others.
        let severity = if self.paths.is_empty() { Severity::Warning } else { Severity::Error };
        let one = Diagnostic::new(&codes::DEPLOYABLE_NOT_FOUND, at, message).severity(severity);
        // What else is wrong with the name is mended with it.
        diagnostics.withdraw(&codes::ATTRIBUTE_VALUE, at);
        let one = match deployable.namespace {
            Some(_) => one,
            None => one.help("write it with a prefix of the composite's target namespace"),
        };
        let names = all.iter().filter(of_namespace).map(|one| one.name.as_str());
        diagnostics.push(if let Some(meant) = nearest(local, names.clone()) {
            let meant = format!("{}{meant}", prefix.unwrap_or_default());
            one.suggest(format!("replace {name} with {}", quoted(&meant)), at, escaped(&meant))
        } else if let Some(other) = all.iter().find(|one| one.name == *local) {
            let namespace = other.namespace();
            let one = one.help(match namespace {
                "" => format!("it has {} in no namespace", quoted(local)),
                _ => format!("it has {} in the namespace {}", quoted(local), quoted(namespace)),
            });
            // The prefix may be that of other composites.
            let is_wrong =
                |declared: &&Text| names.clone().next().is_none() && nearest(declared, [namespace]).is_some();
            match deployable.declared.as_ref().filter(is_wrong) {
                Some(declared) => one.suggest(
                    format!("replace {} with {}", quoted(declared), quoted(namespace)),
                    declared.location,
                    escaped(namespace),
                ),
                None => one,
            }
        } else if all.is_empty() {
            one.help("it has no composites: is it made from several folders?")
        } else if names.clone().next().is_none() {
            one.help("it has no composite of this namespace")
        } else {
            let names: Vec<String> = names.take(10).map(quoted).collect();
            one.help(format!("it has {}", names.join(", ")))
        });
        None
    }

    /// The files of the composites that others use, each with the first of these.
    fn users(&self) -> HashMap<&Path, &Composite> {
        let mut users = HashMap::new();
        for (place, one) in self.read.composites().iter().enumerate() {
            let links = one.namings().filter_map(|naming| self.read.link(naming.origin));
            let used = links.filter_map(|link| match link {
                Link::To(used) if *used != place => Some(self.paths[self.places[*used]].as_path()),
                _ => None,
            });
            used.for_each(|path| _ = users.entry(path).or_insert(one));
        }
        users
    }

    /// The composites that run together, and every other composite that none here names.
    fn fleets(self, mut deployed: Vec<PathBuf>, description: Option<&Description>, fleets: &mut Vec<FolderFleet>) {
        let all = self.read.composites();
        let links: Vec<Vec<usize>> = all
            .iter()
            .map(|one| {
                let to = one.namings().filter_map(|naming| match self.read.link(naming.origin)? {
                    Link::To(place) => Some(*place),
                    _ => None,
                });
                to.collect()
            })
            .collect();
        let mut is_named = vec![false; all.len()];
        for (place, to) in links.iter().enumerate() {
            to.iter().filter(|to| **to != place).for_each(|to| is_named[*to] = true);
        }
        let mut seen = vec![false; all.len()];
        let reach = |start: usize, seen: &mut Vec<bool>| {
            let mut waiting = vec![start];
            while let Some(place) = waiting.pop() {
                if !std::mem::replace(&mut seen[place], true) {
                    waiting.extend(&links[place]);
                }
            }
        };
        let is_deployed: HashSet<PathBuf> = deployed.iter().cloned().collect();
        for (place, file) in self.places.iter().enumerate() {
            if is_deployed.contains(&self.paths[*file]) {
                reach(place, &mut seen);
            }
        }
        // The files of fleets of their own, each with whether it is exported: those that could not be read are some.
        let mut others: Vec<Option<bool>> = vec![Some(false); self.paths.len()];
        self.places.iter().for_each(|file| others[*file] = None);
        // Those in circles of names have no first one: what is left is reached from any of them.
        for is_left in [false, true] {
            for place in 0..all.len() {
                if !seen[place] && (is_left || !is_named[place]) {
                    let is_exported = description.is_some_and(|one| one.exports(all[place].namespace()));
                    others[self.places[place]] = Some(is_exported);
                    reach(place, &mut seen);
                }
            }
        }
        let mut known = HashSet::new();
        deployed.retain(|path| known.insert(path.clone()));
        if !deployed.is_empty() {
            fleets.push(FolderFleet { files: deployed, is_deployable: true, is_exported: false });
        }
        let others = self.paths.into_iter().zip(others).filter(|(path, _)| !is_deployed.contains(path));
        fleets.extend(others.filter_map(|(path, is_exported)| {
            Some(FolderFleet { files: vec![path], is_deployable: false, is_exported: is_exported? })
        }));
    }
}
