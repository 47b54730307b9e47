//! Resolution of the composites and component types that composites name.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::finder::Finder;
use super::{component_types, read_values};
use crate::diagnostic::{Diagnostic, Diagnostics, Severity, codes, nearest_few, quoted};
use crate::limits::OFFERED_NAMES;
use crate::load::description::Kind;
use crate::load::{ReadContext, STANDARD_INPUT, load_component_type, load_file};
use crate::model::{ComponentElement, Composite, Contribution, ImplementationKind, Link, Missing, Naming, Origin};
use crate::source::{Location, Sources, identity};

/// Reads the composites that those of a contribution include or implement components with, and what those name in turn;
/// and the component types of implementations, the files `X.componentType` beside them.
///
/// They are looked for by namespace and name in the folder of the file that names them, and then in the whole
/// contribution: the nearest folder above that has a `sca-contribution.xml`, in itself or in its `META-INF`, or that
/// first folder where there is none. What is not there is looked for in the contributions that export its namespace
/// (for component types, its package), where the description of its own imports that: those of the composites that are
/// given together, those in folders beside it, and the folder that the import has as its `location`. No file is opened
/// that is not needed, and a large folder is given up after some ten thousand entries. Texts that were not read from
/// files are not looked at, but for [`STANDARD_INPUT`].
///
/// A fault of a file that is found, or that has the name of one that is not, is reported; that one is not found is
/// for the checker to say. A [`Finder`] does it for several contributions that are in the same folders.
pub fn load_named(
    contribution: &mut Contribution,
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) {
    Finder::new(sources.open().clone()).load_named(contribution, max_size, sources, diagnostics);
}

impl Finder {
    /// Does what [`load_named`] does. What is wrong with the description of a contribution is reported once.
    pub fn load_named(
        &mut self,
        contribution: &mut Contribution,
        max_size: u64,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) {
        let context = &mut ReadContext { max_size, sources, diagnostics };
        self.index.turn_to_fleet();
        // By their paths, so that one file is one composite; `None` for one that could not be read.
        let mut known: HashMap<PathBuf, Option<usize>> = HashMap::new();
        for (place, composite) in contribution.composites().iter().enumerate() {
            known.insert(identity(Path::new(context.sources.get(composite.file()).path())), Some(place));
        }
        let given = contribution.composites().iter();
        let given = given.filter_map(|one| Path::new(context.sources.get(one.file()).path()).parent());
        let given = given.map(|folder| self.index.root(folder));
        self.imports.turn_to_fleet(given);
        let mut types = HashMap::new();
        let mut warned = HashSet::new();
        let mut place = 0;
        while let Some(composite) = contribution.composites().get(place) {
            let at = place;
            place += 1;
            let path = PathBuf::from(context.sources.get(composite.file()).path());
            let is_open = |naming: &Naming<'_>| matches!(contribution.link(naming.origin), Some(Link::Missing(_)));
            let open = composite.namings().filter(is_open);
            let wanted: Vec<Wanted> = open
                .map(|naming| {
                    let (namespaces, local) = composite.resolve_name(naming);
                    let prefix = naming.name.as_str().strip_suffix(local).unwrap_or_default();
                    Wanted {
                        origin: naming.origin,
                        at: naming.name.location,
                        prefix: prefix.to_owned(),
                        namespaces,
                        local: local.to_owned(),
                    }
                })
                .collect();
            let described = described(composite);
            if wanted.is_empty() && described.is_empty()
                || !(path.is_file() || context.sources.open().get(&path).is_some() || path == Path::new(STANDARD_INPUT))
            {
                continue;
            }
            let folder = path.parent().unwrap_or(Path::new(""));
            let root = self.index.root(folder);
            let mut files = HashMap::new();
            for Described { written, paths, package, is_needed } in described {
                // By its path in the contribution, or beside the composite under its last name.
                let beside = paths.iter().filter_map(|path| Some(folder.join(path.file_name()?)));
                let mut all = paths.iter().map(|path| root.join(path)).chain(beside);
                let mut found = all.find(|path| self.has_component_type(path));
                if let (None, Some(package)) = (&found, &package) {
                    let from = self.imports.exporters(&root, Kind::Java, package, context);
                    let mut all = from.iter().flat_map(|root| paths.iter().map(|path| root.join(path)));
                    found = all.find(|path| self.has_component_type(path));
                }
                let place = found.map(|found| {
                    *types.entry(found).or_insert_with_key(|path| {
                        let file = context.read(path)?;
                        let made = load_component_type(file, context.sources, context.diagnostics)?;
                        Some(contribution.add_component_type(made))
                    })
                });
                // Of a file that could not be read nothing more is said.
                match place {
                    Some(Some(place)) => _ = files.insert(written, Some(place)),
                    None if is_needed => _ = files.insert(written, None),
                    _ => {}
                }
            }
            if !files.is_empty() {
                let composite = &contribution.composites()[at];
                let all = composite.components.iter().filter_map(|component| {
                    let (origin, written) = implementation(component, composite)?;
                    Some((origin, *files.get(written)?))
                });
                let all: Vec<(Origin, Option<usize>)> = all.collect();
                all.into_iter().for_each(|(origin, place)| contribution.describe(origin, place));
            }
            for wanted in wanted {
                let (namespaces, local) = (wanted.namespaces.as_deref(), wanted.local.as_str());
                let own = self.index.find(folder, namespaces, local);
                if let Some(found) = &own {
                    self.index.adopt(folder, found);
                }
                let found = own.or_else(|| self.imports.find(&mut self.index, &root, namespaces, local, context));
                // What is wrong with a file that is called so is told there, and nowhere else.
                let found = found.or_else(|| self.index.unread_named(folder, local));
                let link = match found {
                    None if self.imports.is_faulty(&root, context) => Link::Faulty,
                    None => Link::Missing(self.missing(folder, &root, &wanted, context)),
                    Some(found) => {
                        if warned.insert(found.clone()) {
                            let twins = self.index.twins(&found);
                            let warning = ambiguous(&wanted, &found, &twins);
                            warning.into_iter().for_each(|one| context.diagnostics.push(one));
                        }
                        let place = known.entry(identity(&found)).or_insert_with(|| {
                            let file = context.read(&found)?;
                            let ReadContext { sources, diagnostics, .. } = &mut *context;
                            let mut composite = load_file(file, sources, diagnostics)?;
                            read_values(&mut composite, max_size, sources, diagnostics);
                            Some(contribution.add(composite))
                        });
                        place.map_or(Link::Faulty, Link::To)
                    }
                };
                contribution.set_link(wanted.origin, link);
            }
        }
    }

    /// The knowledge about a composite that is not found, named by a file in `folder`, of the contribution in `root`.
    fn missing(&mut self, folder: &Path, root: &Path, wanted: &Wanted, context: &mut ReadContext<'_>) -> Missing {
        let Some(left) = self.explained.checked_sub(1) else { return Missing::default() };
        self.explained = left;
        let seen = self.index.seen(folder);
        let is_meant =
            |namespace: &str| wanted.namespaces.as_ref().is_none_or(|all| all.iter().any(|meant| meant == namespace));
        let mut near = Vec::new();
        if self.candidates.admit(seen.heads.len()) {
            let of_namespace = seen.heads.iter().filter(|one| is_meant(&one.namespace));
            near = nearest_few(&wanted.local, of_namespace.map(|one| one.local.as_str()), OFFERED_NAMES);
        }
        let near = near.into_iter().map(|near| format!("{}{near}", wanted.prefix)).collect();
        let mut searched = vec![self.index.searched(folder)];
        if let Some(other) = seen.named(&wanted.local) {
            searched.push(format!(
                "{} has a composite {} of the namespace {}",
                quoted(&other.path.display().to_string()),
                quoted(&other.local),
                quoted(&other.namespace)
            ));
        }
        let (namespaces, local) = (wanted.namespaces.as_deref(), wanted.local.as_str());
        searched.extend(self.unread(folder, local, context.sources.open()));
        let around = (&mut self.index, &mut self.candidates);
        searched.extend(self.imports.hints(around, root, namespaces, local, context));
        Missing { near, searched }
    }
}

/// Implementations that one file beside them may describe.
struct Described {
    /// Their common key, from [`implementation`].
    written: String,
    /// The files that it may be, the likeliest first.
    paths: Vec<PathBuf>,
    /// The package of their class.
    package: Option<String>,
    /// True if it has to be there.
    is_needed: bool,
}

/// The implementations of a composite that files beside them may describe; all that are written alike together.
fn described(composite: &Composite) -> Vec<Described> {
    let mut all: Vec<Described> = Vec::new();
    let mut seen: HashSet<&str> = HashSet::default();
    let mut before = "";
    for component in &composite.components {
        let Some((origin, written)) = implementation(component, composite) else { continue };
        if std::mem::replace(&mut before, written) == written || !seen.insert(written) {
            continue;
        }
        let paths = component_types::paths(component, composite);
        if paths.is_empty() {
            continue;
        }
        // A bundle of OSGi says nothing about services by itself. Its description is called as its file is, which only
        // `bundle` tells.
        let kind = component.implementation.as_ref().map(|implementation| &implementation.kind);
        let is_needed = matches!(kind, Some(ImplementationKind::Other { kind, .. }) if kind == "osgi")
            && origin.element(&composite.document).attribute("bundle").is_some();
        let package = component.class().and_then(|class| Some(class.rsplit_once('.')?.0.to_owned()));
        all.push(Described { written: written.to_owned(), paths, package, is_needed });
    }
    all
}

/// The origin of a component's implementation, and the text that says which file describes it: the class, or else the
/// whole tag.
fn implementation<'a>(component: &'a ComponentElement, composite: &'a Composite) -> Option<(Origin, &'a str)> {
    let implementation = component.implementation.as_ref()?;
    let written = match component.class() {
        Some(class) => class.as_str(),
        None => {
            let tag = implementation.origin.element(&composite.document).start_tag_span();
            &composite.document.text()[tag.start as usize..tag.end as usize]
        }
    };
    Some((implementation.origin, written))
}

struct Wanted {
    origin: Origin,
    /// The place of the name.
    at: Location,
    prefix: String,
    namespaces: Option<Vec<String>>,
    local: String,
}

/// The warning that a name leads to one of several files, which one of them nobody says.
fn ambiguous(wanted: &Wanted, found: &Path, twins: &[PathBuf]) -> Option<Diagnostic> {
    let is_beside = twins.iter().all(|twin| twin.parent() == found.parent());
    let name = |path: &Path| match path.file_name() {
        Some(name) if is_beside => quoted(&name.to_string_lossy()),
        _ => quoted(&path.display().to_string()),
    };
    let first = twins.first()?;
    let others = match twins.len() {
        1 => name(first),
        more => format!("{} and {} more", name(first), more - 1),
    };
    let message = format!(
        "there are two composites {} in one namespace: that in {} is taken, and not that in {others}",
        quoted(&wanted.local),
        name(found)
    );
    let one = Diagnostic::new(&codes::COMPOSITE_REPEATED, wanted.at, message);
    Some(one.severity(Severity::Warning).help("give each its own name, or move one of them to another contribution"))
}
