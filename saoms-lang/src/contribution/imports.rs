//! Imports and exports of contributions, from `sca-contribution.xml`.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use super::head::Head;
use super::index::{self, Index};
use crate::diagnostic::{Candidates, Diagnostic, Diagnostics, codes, quoted};
use crate::limits::FOLDERS_BESIDE;
use crate::load::description::{self, Description, Entry, Kind};
use crate::load::{MAX_SIZE, ReadContext};
use crate::source::{Location, OpenTexts, Sources, identity};
use crate::syntax::escaped;

/// The descriptions of contributions, each read once and when it is needed.
#[derive(Default)]
pub(super) struct Imports {
    /// The contributions that are given together.
    given: Vec<Neighbour>,
    /// Those that are in the folders around contributions.
    beside: HashMap<PathBuf, Vec<Neighbour>>,
    descriptions: HashMap<PathBuf, Option<Description>>,
    /// The contributions that import something from a folder that must not be read, with what it is.
    refused: HashSet<(PathBuf, String)>,
}

/// A contribution that others may import from.
struct Neighbour {
    folder: PathBuf,
    identity: PathBuf,
}

impl Neighbour {
    fn of(folder: PathBuf) -> Self {
        Self { identity: identity(&folder), folder }
    }

    /// True if the contribution in a folder may read this one: it may be read anyway, or is beside it, and no link to
    /// elsewhere.
    fn is_open(&self, own: &Path, open: &OpenTexts) -> bool {
        open.outside(&self.folder).is_none() || self.identity.parent() == own.parent()
    }
}

impl Imports {
    /// For a fleet whose composites are in these contributions. What was read is kept.
    pub(super) fn turn_to_fleet(&mut self, given: impl Iterator<Item = PathBuf>) {
        let mut seen = HashSet::new();
        self.given = given.filter(|folder| seen.insert(folder.clone())).map(Neighbour::of).collect();
    }

    /// The folders of the contributions from which that in `root` imports this: exporters that are given together with
    /// it, that are in the folder beside it, or where the import says `location`. Nothing where it does not import it.
    pub(super) fn exporters(
        &mut self,
        root: &Path,
        kind: Kind,
        what: &str,
        context: &mut ReadContext<'_>,
    ) -> Vec<PathBuf> {
        if !self.imports(root, kind, what, context) {
            return Vec::new();
        }
        let mut all = self.others(root, kind, what, context);
        all.retain(|other| {
            let description = self.description(other, context);
            description.is_some_and(|one| one.exports.iter().any(|entry| entry.is(kind, what)))
        });
        all
    }

    fn imports(&mut self, root: &Path, kind: Kind, what: &str, context: &mut ReadContext<'_>) -> bool {
        let description = self.description(root, context);
        description.is_some_and(|one| one.imports.iter().any(|entry| entry.is(kind, what)))
    }

    /// Reports that an import of the contribution in `root` names a folder that must not be read, if it does.
    pub(super) fn refuse_outside(&self, entry: &Entry, root: &Path, context: &mut ReadContext<'_>) {
        let Some((folder, at)) = &entry.location else { return };
        let neighbour = Neighbour::of(root.join(folder));
        if !neighbour.is_open(&identity(root), context.sources.open()) {
            outside(&neighbour, *at, context.diagnostics);
        }
    }

    /// The composite of this name that the contribution in `root` imports.
    pub(super) fn find(
        &mut self,
        index: &mut Index,
        root: &Path,
        namespaces: Option<&[String]>,
        local: &str,
        context: &mut ReadContext<'_>,
    ) -> Option<Head> {
        namespaces.unwrap_or_default().iter().find_map(|namespace| {
            let from = self.exporters(root, Kind::Namespace, namespace, context);
            from.iter().find_map(|root| index.find(root, Some(std::slice::from_ref(namespace)), local))
        })
    }

    /// True if what the contribution in `root` imports of these namespaces is not known, which is reported: its
    /// description could not be read, or names a folder that must not be.
    pub(super) fn is_unknown(
        &mut self,
        root: &Path,
        namespaces: Option<&[String]>,
        context: &mut ReadContext<'_>,
    ) -> bool {
        let is_refused = |one: &String| self.refused.contains(&(root.to_owned(), one.clone()));
        namespaces.unwrap_or_default().iter().any(is_refused)
            || self.description(root, context).is_some_and(|one| one.is_faulty)
    }

    /// The reason why a composite of these namespaces cannot be found through the description of the contribution in
    /// `root`; empty without a description.
    pub(super) fn hints(
        &mut self,
        (index, candidates): (&mut Index, &mut Candidates),
        root: &Path,
        namespaces: Option<&[String]>,
        local: &str,
        context: &mut ReadContext<'_>,
    ) -> Vec<String> {
        let mut hints = Vec::new();
        let Some(own) = self.description(root, context) else { return hints };
        let own = quoted(&own.path.display().to_string());
        for namespace in namespaces.unwrap_or_default().iter().filter(|one| !one.is_empty()) {
            let is_imported = self.imports(root, Kind::Namespace, namespace, context);
            let shown = quoted(namespace);
            let from = self.exporters(root, Kind::Namespace, namespace, context);
            let mut others = self.others(root, Kind::Namespace, namespace, context);
            if !candidates.admit(others.len()) {
                others.clear();
            }
            let holder = others.into_iter().find(|other| {
                let is_known = self.description(other, context).is_some();
                is_known && index.find(other, Some(std::slice::from_ref(namespace)), local).is_some()
            });
            let Some(holder) = holder else {
                hints.extend(is_imported.then(|| match from.first() {
                    Some(other) => format!(
                        "{own} imports the namespace {shown}, and the contribution in {}, which exports it, has no such composite",
                        quoted(&other.display().to_string())
                    ),
                    None => format!(
                        "{own} imports the namespace {shown}, which no known contribution exports: name a composite of it beside this one, or write its folder as `location` of the `import`"
                    ),
                }));
                continue;
            };
            let other = quoted(&holder.display().to_string());
            let is_exported = self.description(&holder, context).is_some_and(|description| {
                description.exports.iter().any(|entry| entry.is(Kind::Namespace, namespace))
            });
            let mut lacking = Vec::new();
            if !is_imported {
                lacking.push(format!("write `<import namespace=\"{}\"/>` in {own}", escaped(namespace)));
            }
            if !is_exported {
                let description = quoted(&description::path_in(&holder).unwrap_or(holder).display().to_string());
                lacking.push(format!("write `<export namespace=\"{}\"/>` in {description}", escaped(namespace)));
            }
            hints.push(format!("the contribution in {other} has it: {}", lacking.join(", and ")));
        }
        hints
    }

    /// The contributions that that in `root` may import a namespace from, with the namespaces that they export.
    pub(super) fn around(&mut self, root: &Path, namespace: &str, max_size: u64) -> Vec<(PathBuf, Vec<String>)> {
        let (sources, diagnostics) = (&mut Sources::new(), &mut Diagnostics::new());
        let context = &mut ReadContext { max_size, sources, diagnostics };
        _ = self.description(root, context);
        let mut all = self.others(root, Kind::Namespace, namespace, context);
        all.truncate(FOLDERS_BESIDE);
        let exports = |other: PathBuf| {
            let exports = namespaces(&self.description(&other, context)?.exports);
            Some((other, exports))
        };
        all.into_iter().filter_map(exports).collect()
    }

    /// The contributions that that in `root` may import this from, the likeliest first. A folder that an import names
    /// and that must not be read is reported.
    fn others(&mut self, root: &Path, kind: Kind, what: &str, context: &mut ReadContext<'_>) -> Vec<PathBuf> {
        let own = identity(root);
        let description = self.descriptions.get(root).and_then(Option::as_ref);
        let entries = description.iter().flat_map(|one| &one.imports).filter(|entry| entry.is(kind, what));
        let located = entries.filter_map(|entry| entry.location.as_ref());
        let open = context.sources.open().clone();
        let is_open = |(folder, at): &(PathBuf, Location)| {
            let neighbour = Neighbour::of(root.join(folder));
            if neighbour.is_open(&own, &open) {
                return Some(neighbour);
            }
            outside(&neighbour, *at, context.diagnostics);
            self.refused.insert((root.to_owned(), what.to_owned()));
            None
        };
        let located: Vec<Neighbour> = located.filter_map(is_open).collect();
        let beside = self.beside.entry(root.to_owned()).or_insert_with_key(|root| beside(root));
        let beside = beside.iter().filter(|one| one.is_open(&own, &open));
        let mut seen = HashSet::from([own.as_path()]);
        let all = located.iter().chain(&self.given).chain(beside);
        all.filter(|other| seen.insert(&other.identity)).map(|other| other.folder.clone()).collect()
    }

    fn description(&mut self, root: &Path, context: &mut ReadContext<'_>) -> Option<&Description> {
        if description::path_in(root).is_some() {
            // What describes itself as a contribution is there for others to read.
            context.sources.open().permit(root);
        }
        let known = self.descriptions.entry(root.to_owned());
        known.or_insert_with(|| Description::of(root, context)).as_ref()
    }
}

/// Reports an import that names a folder that must not be read, once.
fn outside(neighbour: &Neighbour, at: Location, diagnostics: &mut Diagnostics) {
    if diagnostics.iter().any(|one| one.code == &codes::FILE_OUTSIDE && one.location == at) {
        return;
    }
    let message = "this folder is outside the folder of the contribution and not beside it, and is not read";
    let folder = quoted(&neighbour.identity.display().to_string());
    diagnostics.push(
        Diagnostic::new(&codes::FILE_OUTSIDE, at, message)
            .help(format!("move {folder} beside the contribution, or allow it with `--allow-outside`")),
    );
}

/// The namespaces that are imported or exported.
fn namespaces(entries: &[Entry]) -> Vec<String> {
    entries.iter().filter_map(Entry::namespace).map(str::to_owned).collect()
}

/// The files of the composites that the contribution of `folder` imports from others, which export them. Faults of
/// their descriptions are not reported.
pub fn imported_near(folder: &Path, open: &OpenTexts) -> Vec<PathBuf> {
    let (sources, diagnostics) = (&mut Sources::with_open(open.clone()), &mut Diagnostics::new());
    let context = &mut ReadContext { max_size: MAX_SIZE, sources, diagnostics };
    let (mut imports, mut index, root) = (Imports::default(), Index::new(open.clone()), index::root(folder));
    let mut all = Vec::new();
    for namespace in imports.description(&root, context).map_or_else(Vec::new, |one| namespaces(&one.imports)) {
        for other in imports.exporters(&root, Kind::Namespace, &namespace, context) {
            let composites = index.heads(&other).into_iter().filter(|one| one.namespace == namespace);
            all.extend(composites.map(|one| one.path));
        }
    }
    all
}

/// The files of the composites in contributions beside that of `folder` that import what it exports. Faults of their
/// descriptions are not reported.
pub fn importing_near(folder: &Path, open: &OpenTexts) -> Vec<PathBuf> {
    let (sources, diagnostics) = (&mut Sources::with_open(open.clone()), &mut Diagnostics::new());
    let context = &mut ReadContext { max_size: MAX_SIZE, sources, diagnostics };
    let (mut imports, mut index, root) = (Imports::default(), Index::new(open.clone()), index::root(folder));
    let given = imports.description(&root, context).map_or_else(Vec::new, |one| namespaces(&one.exports));
    let own = identity(&root);
    let mut others = beside(&root);
    others.retain(|other| {
        let is_given = |what: &String| imports.imports(&other.folder, Kind::Namespace, what, context);
        other.identity != own && given.iter().any(is_given)
    });
    others.iter().flat_map(|other| index.contents(&other.folder).composites).collect()
}

/// The folders of contributions in the folder that a contribution is in.
fn beside(root: &Path) -> Vec<Neighbour> {
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
