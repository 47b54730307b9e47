//! Resolution of the composites and component types that composites name.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::finder::Finder;
use super::head::{Head, head};
use super::{component_types, read_values};
use crate::diagnostic::{Diagnostic, Diagnostics, Severity, codes, nearest_few, quoted};
use crate::limits::{FLEET_ENTRIES, OFFERED_NAMES};
use crate::load::description::Kind;
use crate::load::{ReadContext, STANDARD_INPUT, load_component_type, load_file, read};
use crate::model::{Composite, Contribution, ImplementationKind, Link, Missing, Naming, Origin};
use crate::source::{Location, Sources, Span, identity};
use crate::syntax::escaped;

impl Finder {
    /// Reads the composites that those of a contribution include or implement components with, and what those name in
    /// turn; and the component types of implementations, the files `X.componentType` beside them.
    ///
    /// They are looked for by namespace and name in the folder of the file that names them, and then in the whole
    /// contribution: the nearest folder above that has a `sca-contribution.xml`, in itself or in its `META-INF`, or
    /// that first folder where there is none. What is not there is looked for in the contributions that export its
    /// namespace (for component types, its package), where the description of its own imports that: those of the
    /// composites that are given together, those in folders beside it, and the folder that the import has as its
    /// `location`. Of a file that is not needed no more is read than its first tag, and a large folder is given up
    /// after some ten thousand entries. Texts that were not read from files are not looked at, but for
    /// [`STANDARD_INPUT`].
    ///
    /// A fault of a file that is found, or that has the name of one that is not, is reported; that one is not found is
    /// for the checker to say. What is wrong with the description of a contribution is reported once.
    pub fn load_named(
        &mut self,
        contribution: &mut Contribution,
        max_size: u64,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) {
        let context = &mut ReadContext { max_size, sources, diagnostics };
        self.index.limit(FLEET_ENTRIES);
        let path_of = |one: &Composite, sources: &Sources| PathBuf::from(sources.get(one.file()).path());
        let paths = contribution.composites().iter().map(|one| path_of(one, context.sources));
        let paths: Vec<PathBuf> = paths.collect();
        let given = paths.iter().filter_map(|path| path.parent());
        self.imports.turn_to_fleet(given.map(|folder| self.index.root(folder)));
        // By their paths, so that one file is one composite; `None` for one that could not be read.
        let mut known: HashMap<PathBuf, Option<usize>> =
            paths.iter().enumerate().map(|(place, path)| (identity(path), Some(place))).collect();
        let mut types = HashMap::new();
        let mut warned = HashSet::new();
        let mut next = 0;
        while let Some(composite) = contribution.composites().get(next) {
            next += 1;
            let path = path_of(composite, context.sources);
            let is_file = || path.is_file() || context.sources.open().get(&path).is_some();
            if path != Path::new(STANDARD_INPUT) && !is_file() {
                continue;
            }
            let is_open = |naming: &Naming<'_>| matches!(contribution.link(naming.origin), Some(Link::Missing(_)));
            let wanted = composite.namings().filter(is_open).map(|naming| Wanted::of(naming, composite));
            let wanted: Vec<Wanted> = wanted.collect();
            let folder = path.parent().unwrap_or(Path::new(""));
            let root = self.index.root(folder);
            for (origin, found) in self.described(composite, folder, &root, context) {
                let place = found.map(|found| {
                    *types.entry(found).or_insert_with_key(|path| {
                        let file = context.read(path)?;
                        let made = load_component_type(file, context.sources, context.diagnostics)?;
                        Some(contribution.add_component_type(made))
                    })
                });
                // Of a file that could not be read nothing more is said.
                if place != Some(None) {
                    contribution.describe(origin, place.flatten());
                }
            }
            for wanted in wanted {
                let found = self.find(&wanted, folder, &root, context);
                if let Some(found) = &found
                    && warned.insert(found.path.clone())
                    && !self.repeated.contains(&identity(&found.path))
                {
                    let warning = ambiguous(&wanted, &found.path, &self.index.twins(found));
                    warning.into_iter().for_each(|one| context.diagnostics.push(one));
                }
                // Faults of a file with this name are reported there, and nowhere else.
                let unread = || self.index.unread_named(folder, &wanted.local);
                let link = match found.map(|found| found.path).or_else(unread) {
                    None if self.imports.is_unknown(&root, wanted.namespaces.as_deref(), context) => Link::Faulty,
                    None => Link::Missing(self.missing(folder, &root, &wanted, context)),
                    Some(found) => {
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

    /// The composite that a file in `folder`, of the contribution in `root`, names.
    fn find(&mut self, wanted: &Wanted, folder: &Path, root: &Path, context: &mut ReadContext<'_>) -> Option<Head> {
        let (namespaces, local) = (wanted.namespaces.as_deref(), wanted.local.as_str());
        if let Some(own) = self.index.find(folder, namespaces, local) {
            self.index.adopt(folder, &own.path);
            return Some(own);
        }
        self.imports.find(&mut self.index, root, namespaces, local, context)
    }

    /// The implementations of a composite with the files that describe them, `None` where one that has to be there is
    /// not.
    fn described(
        &mut self,
        composite: &Composite,
        folder: &Path,
        root: &Path,
        context: &mut ReadContext<'_>,
    ) -> Vec<(Origin, Option<PathBuf>)> {
        // Those that are written alike have one file.
        let mut known: HashMap<&str, Option<Option<PathBuf>>> = HashMap::new();
        let mut all = Vec::new();
        for component in &composite.components {
            let Some(implementation) = &component.implementation else { continue };
            let element = implementation.origin.element(&composite.document);
            let written = match component.class() {
                Some(class) => class.as_str(),
                None => composite.document.piece(element.start_tag_span()),
            };
            let found = known.entry(written).or_insert_with(|| {
                let paths = component_types::paths(component, composite);
                // By its path in the contribution, or beside the composite under its last name.
                let beside = paths.iter().filter_map(|path| Some(folder.join(path.file_name()?)));
                let mut own = paths.iter().map(|path| root.join(path)).chain(beside);
                let found = own.find(|path| path.is_file()).or_else(|| {
                    let (package, _) = component.class()?.rsplit_once('.').filter(|_| !paths.is_empty())?;
                    let from = self.imports.exporters(root, Kind::Java, package, context);
                    from.iter().flat_map(|root| paths.iter().map(|path| root.join(path))).find(|path| path.is_file())
                });
                // A bundle of OSGi says nothing about services by itself. Its description is called as its file is,
                // which only `bundle` tells.
                let is_osgi = matches!(&implementation.kind, ImplementationKind::Other { kind, .. } if kind == "osgi");
                let is_needed = is_osgi && element.attribute("bundle").is_some() && !paths.is_empty();
                (found.is_some() || is_needed).then_some(found)
            });
            all.extend(found.clone().map(|found| (implementation.origin, found)));
        }
        all
    }

    /// The knowledge about a composite that is not found, named by a file in `folder`, of the contribution in `root`.
    fn missing(&mut self, folder: &Path, root: &Path, wanted: &Wanted, context: &mut ReadContext<'_>) -> Missing {
        let Some(left) = self.explained.checked_sub(1) else { return Missing::default() };
        self.explained = left;
        let seen = self.index.names_around(folder);
        let is_meant = |one: &&Head| wanted.namespaces.as_ref().is_none_or(|all| all.contains(&one.namespace));
        let heads = if self.candidates.admit(seen.len()) { seen.heads() } else { Vec::new() };
        let of_namespace = || heads.iter().copied().filter(is_meant);
        // The name of its file, perhaps with the ending.
        let file = wanted.local.strip_suffix(".composite").unwrap_or(&wanted.local);
        let is_file = |one: &&Head| one.path.file_stem().is_some_and(|stem| stem == file);
        let near = match of_namespace().find(is_file) {
            Some(one) => vec![one.local.as_str()],
            // The very name elsewhere is meant, and no composite is inside itself.
            None if seen.named(&wanted.local).is_some() => Vec::new(),
            None => {
                let others = of_namespace().map(|one| one.local.as_str()).filter(|local| *local != wanted.around);
                nearest_few(&wanted.local, others, OFFERED_NAMES)
            }
        };
        let near = near.into_iter().map(|near| format!("{}{near}", wanted.prefix)).collect();
        let mut searched = vec![self.index.searched(folder)];
        // Editors call files so, those for XML and others.
        let named = [".xml", ".composite.xml", ".composite.txt", ".Composite"];
        let mut named = named.map(|ending| folder.join(format!("{file}{ending}"))).into_iter();
        if let Some(found) = named.find(|path| path.is_file() && head(path, context.sources.open()).is_some()) {
            let right = folder.join(format!("{file}.composite"));
            let [found, right] = [found, right].map(|path| quoted(&path.display().to_string()));
            searched.push(format!("rename {found} to {right}: composites are looked for in files with this ending"));
        }
        let other = seen.named(&wanted.local);
        let elsewhere = other.map(|other| other.namespace.clone());
        let nameless = other.filter(|other| other.namespace.is_empty());
        let misspelt = nameless.and_then(|other| misspelt_namespace(&other.path, context));
        if let Some(other) = other {
            let (path, local) = (quoted(&other.path.display().to_string()), quoted(&other.local));
            let meant = wanted.namespaces.as_ref().and_then(|all| all.first()).filter(|_| other.namespace.is_empty());
            searched.push(match meant {
                Some(meant) => format!(
                    "{path} has a composite {local} without a target namespace: write {} in its start tag",
                    quoted(&format!("targetNamespace=\"{}\"", escaped(meant)))
                ),
                None => format!("{path} has a composite {local} of the namespace {}", quoted(&other.namespace)),
            });
        }
        let (namespaces, local) = (wanted.namespaces.as_deref(), wanted.local.as_str());
        searched.extend(self.unread(folder, local, context.sources.open()));
        let around = (&mut self.index, &mut self.candidates);
        searched.extend(self.imports.hints(around, root, namespaces, local, context));
        Missing { near, searched, elsewhere, misspelt }
    }
}

/// The place of the attribute of a composite that is called as its target namespace is but for case.
fn misspelt_namespace(path: &Path, context: &mut ReadContext<'_>) -> Option<Location> {
    let file = read(path, context.max_size, context.sources, &mut Diagnostics::new())?;
    let text = context.sources.get(file).text();
    let tag = &text[..text.find("<component").unwrap_or(text.len())];
    let start = tag.to_ascii_lowercase().find(" targetnamespace")? + 1;
    let end = start + "targetNamespace".len();
    (&text[start..end] != "targetNamespace").then(|| Span::new(start as u32, end as u32).in_file(file))
}

/// A composite that is named and not known.
struct Wanted {
    origin: Origin,
    /// The place of the name.
    at: Location,
    prefix: String,
    namespaces: Option<Vec<String>>,
    local: String,
    /// The name of the composite that names it.
    around: String,
}

impl Wanted {
    fn of(naming: Naming<'_>, around: &Composite) -> Self {
        let (namespaces, local) = around.resolve_name(naming);
        let prefix = naming.name.strip_suffix(local).unwrap_or_default().to_owned();
        Self {
            origin: naming.origin,
            at: naming.name.location,
            prefix,
            namespaces,
            local: local.to_owned(),
            around: around.name.to_string(),
        }
    }
}

/// The warning that a name fits several files, and that none of them is preferred.
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
        "there are two composites {} in one namespace: the one in {} is used, not the one in {others}",
        quoted(&wanted.local),
        name(found)
    );
    let one = Diagnostic::new(&codes::COMPOSITE_REPEATED, wanted.at, message);
    Some(one.severity(Severity::Warning).help("give each its own name, or move one of them to another contribution"))
}
