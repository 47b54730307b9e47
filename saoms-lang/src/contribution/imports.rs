//! Imports and exports of contributions, from `sca-contribution.xml`.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::index::{self, Index};
use crate::diagnostic::{Candidates, Diagnostics, quoted};
use crate::limits::FOLDERS_BESIDE;
use crate::load::MAX_SIZE;
use crate::load::description::{self, Description, Kind};
use crate::source::{OpenTexts, Sources, identity};
use crate::syntax::escaped;

/// The descriptions of contributions, each read once and when it is needed.
#[derive(Default)]
pub(super) struct Imports {
    /// The contributions that are given together.
    given: Vec<Neighbour>,
    /// Those that are in the folders around contributions.
    beside: HashMap<PathBuf, Rc<[Neighbour]>>,
    descriptions: HashMap<PathBuf, Option<Description>>,
    /// Those from which one imports something, as long as the same ones are given.
    exporters: HashMap<(PathBuf, Kind, String), Rc<[PathBuf]>>,
    max_size: u64,
}

/// A contribution that others may import from.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Neighbour {
    folder: PathBuf,
    identity: PathBuf,
}

impl Neighbour {
    fn of(folder: PathBuf) -> Self {
        Self { identity: identity(&folder), folder }
    }
}

impl Imports {
    /// For descriptions of which nothing is to be told.
    pub(super) fn untold(max_size: u64) -> Self {
        Self { max_size, ..Self::default() }
    }

    /// For a fleet whose composites are in these contributions. What was read is kept.
    pub(super) fn turn_to_fleet(&mut self, given: impl Iterator<Item = PathBuf>, max_size: u64) {
        let mut seen = HashSet::new();
        let given = given.filter(|folder| seen.insert(folder.clone())).map(Neighbour::of);
        let given: Vec<Neighbour> = given.collect();
        self.max_size = max_size;
        if self.given != given {
            self.given = given;
            self.exporters.clear();
        }
    }

    /// The folders of the contributions from which that in `root` imports this: exporters that are given together with
    /// it, that are in the folder beside it, or where the import says `location`. Nothing where it does not import it.
    pub(super) fn exporters(
        &mut self,
        root: &Path,
        kind: Kind,
        what: &str,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> Rc<[PathBuf]> {
        if !self.imports(root, kind, what, sources, diagnostics) {
            return Rc::default();
        }
        let key = (root.to_owned(), kind, what.to_owned());
        if let Some(known) = self.exporters.get(&key) {
            return Rc::clone(known);
        }
        let mut all = self.others(root, kind, what);
        all.retain(|other| {
            let description = self.description(other, sources, diagnostics);
            description.is_some_and(|one| one.exports.iter().any(|entry| entry.is(kind, what)))
        });
        let all: Rc<[PathBuf]> = all.into();
        self.exporters.insert(key, Rc::clone(&all));
        all
    }

    fn imports(
        &mut self,
        root: &Path,
        kind: Kind,
        what: &str,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> bool {
        let description = self.description(root, sources, diagnostics);
        description.is_some_and(|one| one.imports.iter().any(|entry| entry.is(kind, what)))
    }

    /// The composite of this name that the contribution in `root` imports.
    pub(super) fn find(
        &mut self,
        index: &mut Index,
        root: &Path,
        namespaces: Option<&[String]>,
        local: &str,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> Option<PathBuf> {
        namespaces.unwrap_or_default().iter().find_map(|namespace| {
            let from = self.exporters(root, Kind::Namespace, namespace, sources, diagnostics);
            from.iter().find_map(|root| index.find(root, Some(std::slice::from_ref(namespace)), local))
        })
    }

    /// True if the description of the contribution in `root` could not be read, which is reported: what it imports is
    /// not known.
    pub(super) fn is_faulty(
        &mut self,
        root: &Path,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> bool {
        self.description(root, sources, diagnostics).is_some_and(|one| one.is_faulty)
    }

    /// The reason why a composite of these namespaces cannot be found through the description of the contribution in
    /// `root`; empty without a description.
    pub(super) fn hints(
        &mut self,
        (index, candidates): (&mut Index, &mut Candidates),
        root: &Path,
        namespaces: Option<&[String]>,
        local: &str,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> Vec<String> {
        let mut hints = Vec::new();
        let Some(own) = self.description(root, sources, diagnostics) else { return hints };
        let own = quoted(&own.path.display().to_string());
        for namespace in namespaces.unwrap_or_default().iter().filter(|one| !one.is_empty()) {
            let is_imported = self.imports(root, Kind::Namespace, namespace, sources, diagnostics);
            let shown = quoted(namespace);
            let from = self.exporters(root, Kind::Namespace, namespace, sources, diagnostics);
            let mut others = self.others(root, Kind::Namespace, namespace);
            if !candidates.admit(others.len()) {
                others.clear();
            }
            let holder = others.into_iter().find(|other| {
                let is_known = self.description(other, sources, diagnostics).is_some();
                is_known && index.find(other, Some(std::slice::from_ref(namespace)), local).is_some()
            });
            let Some(holder) = holder else {
                hints.extend(is_imported.then(|| match from.first() {
                    Some(other) => format!(
                        "{own} imports the namespace {shown}, and the contribution in {}, which exports it, has no such composite",
                        quoted(&other.display().to_string())
                    ),
                    None => format!(
                        "{own} imports the namespace {shown}, which no contribution that is known exports: name a composite of it beside this one, or write its folder as `location` of the `import`"
                    ),
                }));
                continue;
            };
            let other = quoted(&holder.display().to_string());
            let is_exported = self.description(&holder, sources, diagnostics).is_some_and(|description| {
                description.exports.iter().any(|entry| entry.is(Kind::Namespace, namespace))
            });
            let mut lacking = Vec::new();
            if !is_imported {
                lacking.push(format!("write `<import namespace=\"{}\"/>` in {own}", escaped(namespace)));
            }
            if !is_exported {
                let description =
                    quoted(&description::path_in(&holder).unwrap_or(holder).display().to_string());
                lacking
                    .push(format!("write `<export namespace=\"{}\"/>` in {description}", escaped(namespace)));
            }
            hints.push(format!("the contribution in {other} has it: {}", lacking.join(", and ")));
        }
        hints
    }

    /// The contributions that that in `root` may import a namespace from, with the namespaces that they export.
    pub(super) fn around(&mut self, root: &Path, namespace: &str) -> Vec<(PathBuf, Vec<String>)> {
        let (mut sources, mut untold) = (Sources::new(), Diagnostics::new());
        _ = self.description(root, &mut sources, &mut untold);
        let mut all = self.others(root, Kind::Namespace, namespace);
        all.truncate(FOLDERS_BESIDE);
        let mut exported = |other: PathBuf| {
            let exports = &self.description(&other, &mut sources, &mut untold)?.exports;
            let exports = exports.iter().filter_map(|entry| entry.namespace()).map(str::to_owned).collect();
            Some((other, exports))
        };
        all.into_iter().filter_map(&mut exported).collect()
    }

    /// The contributions that that in `root` may import this from, the likeliest first.
    fn others(&mut self, root: &Path, kind: Kind, what: &str) -> Vec<PathBuf> {
        let own = self.descriptions.get(root).and_then(Option::as_ref);
        let entries = own.iter().flat_map(|one| &one.imports).filter(|entry| entry.is(kind, what));
        let located: Vec<Neighbour> =
            entries.filter_map(|entry| Some(Neighbour::of(root.join(entry.location.as_ref()?)))).collect();
        let beside = self.beside.entry(root.to_owned()).or_insert_with_key(|root| beside(root));
        let own = identity(root);
        let mut seen = HashSet::from([own.as_path()]);
        let all = located.iter().chain(&self.given).chain(beside.iter());
        all.filter(|other| seen.insert(&other.identity)).map(|other| other.folder.clone()).collect()
    }

    fn description(
        &mut self,
        root: &Path,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> Option<&Description> {
        let max_size = self.max_size;
        let known = self
            .descriptions
            .entry(root.to_owned())
            .or_insert_with(|| Description::of(root, max_size, sources, diagnostics));
        known.as_ref()
    }
}

/// The files of the composites that the contribution of `folder` imports from others, which export them. What is wrong
/// with their descriptions is not told.
pub fn imported_near(folder: &Path, open: &OpenTexts) -> Vec<PathBuf> {
    let (mut sources, mut diagnostics) = (Sources::with_open(open.clone()), Diagnostics::new());
    let mut imports = Imports::untold(MAX_SIZE);
    let root = index::root(folder);
    let description = imports.description(&root, &mut sources, &mut diagnostics);
    let entries = description.into_iter().flat_map(|one| &one.imports);
    let namespaces: Vec<String> = entries.filter_map(|entry| entry.namespace()).map(str::to_owned).collect();
    let mut index = Index::new(open.clone());
    let mut all = Vec::new();
    for namespace in namespaces {
        let from = imports.exporters(&root, Kind::Namespace, &namespace, &mut sources, &mut diagnostics);
        for other in from.iter() {
            let composites = index.contribution(other).0.into_iter();
            all.extend(composites.filter(|path| index.is_of(path, &namespace)));
        }
    }
    all
}

/// The files of the composites in contributions beside that of `folder` that import what it exports. What is wrong with
/// their descriptions is not told.
pub fn importing_near(folder: &Path, open: &OpenTexts) -> Vec<PathBuf> {
    let (mut sources, mut diagnostics) = (Sources::with_open(open.clone()), Diagnostics::new());
    let mut imports = Imports::untold(MAX_SIZE);
    let root = index::root(folder);
    let description = imports.description(&root, &mut sources, &mut diagnostics);
    let entries = description.into_iter().flat_map(|one| &one.exports);
    let exported: Vec<String> = entries.filter_map(|entry| entry.namespace()).map(str::to_owned).collect();
    if exported.is_empty() {
        return Vec::new();
    }
    let mut index = Index::new(open.clone());
    let mut all = Vec::new();
    let own = identity(&root);
    for Neighbour { folder: other, .. } in beside(&root).iter().filter(|one| one.identity != own) {
        let mut is_imported =
            |what: &String| imports.imports(other, Kind::Namespace, what, &mut sources, &mut diagnostics);
        if exported.iter().any(&mut is_imported) {
            all.extend(index.contribution(other).0);
        }
    }
    all
}

/// The folders of contributions in the folder that a contribution is in.
fn beside(root: &Path) -> Rc<[Neighbour]> {
    // `..`, and nothing for the folder that we are in, have no parent that they name.
    let around = match (root.file_name(), root.parent()) {
        (Some(_), Some(around)) => around.to_owned(),
        _ => root.join(".."),
    };
    let here = if around.as_os_str().is_empty() { Path::new(".") } else { &around };
    let entries = fs::read_dir(here).into_iter().flatten().take(FOLDERS_BESIDE).flatten();
    let mut all: Vec<PathBuf> = entries.map(|entry| around.join(entry.file_name())).collect();
    all.retain(|folder| description::path_in(folder).is_some());
    all.sort_unstable();
    all.into_iter().map(Neighbour::of).collect()
}
