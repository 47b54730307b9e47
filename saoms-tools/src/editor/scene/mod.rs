//! A file together with all that it has to do with: what every question of an editor is answered from.

pub(crate) mod contracts;
pub(crate) mod expressions;
pub(crate) mod file;
mod fleets;
pub(crate) mod loops;
mod names;
pub(crate) mod occurrences;
pub(crate) mod outline;
pub(crate) mod symbol;
pub(crate) mod topics;
mod units;
pub(crate) mod workspace;

use std::collections::{BTreeSet, HashMap, HashSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use saoms_lang::model::Version;
use saoms_lang::registry::{RegisteredClass, Registry};
use saoms_lang::source::identity;
use saoms_lang::syntax::{Element, ElementId};

use super::syntax::{Places, local};
use file::File;
use fleets::Fleets;
use outline::{Component, End, Implementation, Named};
use symbol::Symbol;
use units::Units;
use workspace::{Bounds, Surroundings};

pub use fleets::SceneFleet;

/// A file and those around it: composites, then the files beside them that hold values, then composites of
/// contributions from which it imports, then those of contributions that import from it. Files are named by their
/// places; that of the file itself is 0.
#[derive(Debug)]
pub struct Scene {
    /// The files.
    pub files: Vec<Arc<File>>,
    /// The number of files in the contribution of the first one.
    own: usize,
    /// The number of files in it or imported by it: the rest are of contributions that import from it.
    known: usize,
    pub(crate) registry: Arc<Registry>,
    /// By the local names of their composites, and the namespaces.
    by_name: HashMap<String, NamedComposites>,
    /// The includes of each file.
    includes: Vec<Vec<usize>>,
    units: Units,
    /// By the places of files, as far as they were needed.
    users: Vec<OnceLock<Vec<usize>>>,
    fleets: OnceLock<Fleets>,
    /// The files that hold values, by the paths that composites write.
    beside: HashMap<PathBuf, usize>,
    /// What its files may name.
    pub(crate) bounds: Bounds,
}

/// The files of the composites of one local name.
#[derive(Debug, Default)]
struct NamedComposites {
    all: Vec<usize>,
    /// By their namespaces.
    of: HashMap<String, Vec<usize>>,
}

impl Scene {
    /// The scene of a file with those around it, and the classes that they can name.
    pub fn new(Surroundings { files, own, known, identities, bounds }: Surroundings, registry: Arc<Registry>) -> Self {
        let mut by_name: HashMap<String, NamedComposites> = HashMap::new();
        for (place, file) in files.iter().enumerate() {
            if let Some(name) = &file.outline.name {
                let named = by_name.entry(name.text.clone()).or_default();
                named.all.push(place);
                named.of.entry(file.outline.namespace.clone()).or_default().push(place);
            }
        }
        let users = files.iter().map(|_| OnceLock::new()).collect();
        let beside = beside(&files, &identities);
        let (includes, units, fleets) = (Vec::new(), Units::default(), OnceLock::new());
        let mut scene = Self { files, own, known, registry, by_name, includes, units, users, fleets, beside, bounds };
        scene.includes = (0..scene.files.len()).map(|file| scene.included(file)).collect();
        scene.units = Units::new(&scene.includes);
        scene
    }

    /// True if a file belongs to another contribution than the first one.
    pub(crate) fn is_imported(&self, file: usize) -> bool {
        file >= self.own
    }

    /// True if a file is of a contribution that imports from that of the first one, which cannot name it.
    pub(crate) fn imports_this(&self, file: usize) -> bool {
        file >= self.known
    }

    /// The file of values that a composite calls so.
    pub(crate) fn beside(&self, file: usize, name: &Named) -> Option<usize> {
        self.beside.get(&self.files[file].path.parent()?.join(&name.text)).copied()
    }

    /// The file that is asked about.
    pub fn file(&self) -> &File {
        &self.files[0]
    }

    fn included(&self, file: usize) -> Vec<usize> {
        self.files[file].outline.includes.iter().filter_map(|name| self.composite(file, name)).collect()
    }

    /// The file of the composite that a QName in this file means: of several of one name that in its folder.
    pub(crate) fn composite(&self, file: usize, name: &Named) -> Option<usize> {
        let (from, found) = (&self.files[file], self.by_name.get(local(&name.text))?);
        let of = |namespace: &str| -> Option<usize> {
            let all = found.of.get(namespace)?;
            let folder = from.path.parent();
            let is_near = |other: &&usize| **other == file || self.files[**other].path.parent() == folder;
            let near = if all.len() == 1 { None } else { all.iter().find(is_near) };
            near.or(all.first()).copied()
        };
        let bound = |prefix| from.element(name.element).resolve_prefix(prefix);
        match name.text.split_once(':') {
            Some((prefix, _)) => match bound(prefix) {
                Some(namespace) => of(namespace),
                None => found.all.first().copied(),
            },
            // As the model resolves names without a prefix.
            None => {
                let default = bound("").filter(|namespace| Version::from_namespace(namespace).is_none());
                let all = [default, Some(from.outline.namespace.as_str()), Some("")];
                all.into_iter().flatten().find_map(of)
            }
        }
    }

    /// The components of the composite that a file is part of, each with its file.
    pub(crate) fn components_of(&self, file: usize) -> impl Iterator<Item = (usize, &Component)> {
        let of = |file: &usize| (*file, &self.files[*file].outline.components);
        self.unit_of(file).iter().map(of).flat_map(|(file, all)| all.iter().map(move |one| (file, one)))
    }

    /// The files with components that the composite of a file implements: what its references target is there.
    pub(crate) fn users(&self, file: usize) -> &[usize] {
        self.users[file].get_or_init(|| {
            let outer = self.including(file);
            let is_used =
                |other: usize, one: &Component| self.inner(other, one).is_some_and(|one| outer.contains(&one));
            let uses = |other: &usize| self.files[*other].outline.components.iter().any(|one| is_used(*other, one));
            (0..self.files.len()).filter(uses).collect()
        })
    }

    /// The files in whose composites the component of an end is looked for: that of the end, or those around it.
    pub(crate) fn scopes<'s>(&'s self, file: &'s usize, end: &End) -> &'s [usize] {
        if end.is_outer { self.users(*file) } else { std::slice::from_ref(file) }
    }

    /// The component of this name in the composite that a file is part of.
    pub(crate) fn component(&self, file: usize, name: &str) -> Option<(usize, &Component)> {
        let own = self.files[file].names().component(name).map(|place| (file, place));
        let (file, place) = own.or_else(|| self.unit(file).component(name))?;
        Some((file, &self.files[file].outline.components[place]))
    }

    /// The component of the file that an element is, or is in.
    pub(crate) fn component_around(&self, element: ElementId) -> Option<&Component> {
        self.component_in(0, element)
    }

    /// The same of any file.
    pub(crate) fn component_in(&self, file: usize, element: ElementId) -> Option<&Component> {
        let file = &self.files[file];
        let components = &file.outline.components;
        let mut here = Some(element);
        while let Some(one) = here {
            if let Ok(place) = components.binary_search_by_key(&one, |known| known.name.element) {
                return Some(&components[place]);
            }
            here = file.element(one).parent().map(Element::id);
        }
        None
    }

    /// The value that a property of a component gives, that of the composite's property where it names one.
    pub(crate) fn given(&self, file: usize, property: ElementId) -> Option<&str> {
        let own = self.value_of(file, property);
        own.or_else(|| {
            let source = self.files[file].outline.sources_of(property).next()?;
            self.parameter_value(file, &source.text)
        })
    }

    /// The simple value of a property of the composite that a file is part of.
    pub(crate) fn parameter_value(&self, file: usize, name: &str) -> Option<&str> {
        let Symbol::Parameter { file, name } = self.parameter(file, name) else { return None };
        self.value_of(file, self.property(file, &name)?.element)
    }

    /// The simple value of a property of a file: its attribute `value`, or the text inside.
    pub(crate) fn value_of(&self, file: usize, property: ElementId) -> Option<&str> {
        Some(&self.files[file].text[self.place_of_value(file, property)?])
    }

    /// The place.
    pub(crate) fn place_of_value(&self, file: usize, property: ElementId) -> Option<Range<usize>> {
        let property = self.files[file].element(property);
        property.value("value").or_else(|| property.text_place())
    }

    /// The class of a component.
    pub(crate) fn class(&self, component: &Component) -> Option<&RegisteredClass> {
        match component.implementation.as_ref()? {
            Implementation::Class(name) => self.registry.get(&name.text).map(AsRef::as_ref),
            Implementation::Composite(_) => None,
        }
    }

    /// The file of the composite that implements a component of a file.
    pub(crate) fn inner(&self, file: usize, component: &Component) -> Option<usize> {
        match &component.implementation {
            Some(Implementation::Composite(name)) => self.composite(file, name),
            _ => None,
        }
    }

    /// All files of that composite.
    pub(crate) fn inside(&self, file: usize, component: &Component) -> &[usize] {
        self.inner(file, component).map_or(&[], |found| self.with_included(found))
    }

    /// The property of this name that a file declares for its composite.
    pub(crate) fn property(&self, file: usize, name: &str) -> Option<&Named> {
        let file = &self.files[file];
        Some(&file.outline.properties[file.names().property(name)?])
    }
}

/// The files of values by the paths that composites write for them.
fn beside(files: &[Arc<File>], identities: &HashMap<PathBuf, PathBuf>) -> HashMap<PathBuf, usize> {
    let known: HashMap<&Path, usize> = files.iter().map(|file| file.path.as_path()).zip(0..).collect();
    let written = files.iter().flat_map(|file| {
        let folder = file.path.parent().unwrap_or(Path::new(""));
        file.outline.beside.iter().map(|name| folder.join(&name.text))
    });
    let written: BTreeSet<PathBuf> = written.collect();
    let found = written.into_iter().filter_map(|path| {
        let place = match identities.get(&path) {
            Some(identity) => *known.get(identity.as_path())?,
            None => *known.get(identity(&path).as_path())?,
        };
        Some((path, place))
    });
    found.collect()
}

/// The files reached from these, themselves first.
fn reached<'n>(start: Vec<usize>, next: impl Fn(usize) -> &'n [usize]) -> Vec<usize> {
    let mut seen: HashSet<usize> = start.iter().copied().collect();
    let mut all = start;
    let mut at = 0;
    while let Some(&one) = all.get(at) {
        at += 1;
        all.extend(next(one).iter().copied().filter(|further| seen.insert(*further)));
    }
    all
}
