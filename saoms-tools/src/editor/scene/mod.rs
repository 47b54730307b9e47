//! A file together with all that it has to do with: what every question of an editor is answered from.

pub(crate) mod contracts;
pub(crate) mod expressions;
pub(crate) mod file;
pub(crate) mod loops;
pub(crate) mod occurrences;
pub(crate) mod outline;
pub(crate) mod symbol;
pub(crate) mod topics;
pub(crate) mod workspace;

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use saoms_lang::model::Version;
use saoms_lang::registry::{RegisteredClass, Registry};
use saoms_lang::source::identity;
use saoms_lang::syntax::{Element, ElementId};

use super::syntax::{Places, local};
use file::File;
use outline::{Component, End, Implementation, Named};
use symbol::Symbol;
use workspace::Surroundings;

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
    /// By the local names of their composites.
    by_name: HashMap<String, Vec<usize>>,
    /// The includes of each file.
    includes: Vec<Vec<usize>>,
    /// By the places of files, as far as somebody asked.
    units: Vec<OnceLock<Unit>>,
    /// By the places of files, as far as somebody asked.
    users: Vec<OnceLock<Vec<usize>>>,
    /// The files that hold values, by the paths that composites write.
    beside: HashMap<PathBuf, usize>,
}

/// Composites that are checked as one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFleet {
    /// The files of its composites, by their places in the scene.
    pub files: Vec<usize>,
    /// True if others elsewhere may use it, so that what it leaves open is no fault.
    pub may_be_part: bool,
}

/// The files whose components, wires and properties form one composite.
#[derive(Debug)]
struct Unit {
    files: Vec<usize>,
    /// Each component by its name: its file, and its place in it.
    components: HashMap<String, (usize, usize)>,
    /// Those whose names have expressions.
    patterns: Vec<(usize, usize)>,
}

impl Scene {
    /// The scene of a file with those around it, and the classes that they can name.
    pub fn new(Surroundings { files, own, known }: Surroundings, registry: Arc<Registry>) -> Self {
        let mut by_name: HashMap<String, Vec<usize>> = HashMap::new();
        for (place, file) in files.iter().enumerate() {
            if let Some(name) = &file.outline.name {
                by_name.entry(name.text.clone()).or_default().push(place);
            }
        }
        let units = files.iter().map(|_| OnceLock::new()).collect();
        let users = files.iter().map(|_| OnceLock::new()).collect();
        let beside = beside(&files);
        let includes = Vec::new();
        let mut scene = Self { files, own, known, registry, by_name, includes, units, users, beside };
        scene.includes = (0..scene.files.len()).map(|file| scene.included(file)).collect();
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

    fn unit(&self, file: usize) -> &Unit {
        self.units[file].get_or_init(|| {
            let includers = |place: usize| -> Vec<usize> {
                (0..self.includes.len()).filter(|other| self.includes[*other].contains(&place)).collect()
            };
            let outer = reached(vec![file], includers);
            let files = reached(outer, |place| self.includes[place].clone());
            let (mut components, mut patterns) = (HashMap::new(), Vec::new());
            for &file in &files {
                for (place, component) in self.files[file].outline.components.iter().enumerate() {
                    components.entry(component.name.text.clone()).or_insert((file, place));
                    patterns.extend(component.name.text.contains("${").then_some((file, place)));
                }
            }
            Unit { files, components, patterns }
        })
    }

    /// The files that form one composite with this one: it itself, those that include it, and what all these include.
    pub(crate) fn unit_of(&self, file: usize) -> &[usize] {
        &self.unit(file).files
    }

    /// This file and what it includes, in turn.
    pub(crate) fn with_included(&self, file: usize) -> Vec<usize> {
        reached(vec![file], |place| self.includes[place].clone())
    }

    /// The fleets that the first file is part of, as a check of the whole folder has them: what the description of the
    /// contribution calls deployable is one, and every other composite that no composite names is one of its own. A
    /// file of values is part of those that take values from it.
    pub fn fleets(&self) -> Vec<SceneFleet> {
        let (names, users) = self.naming();
        let described =
            self.files.iter().enumerate().flat_map(|(file, one)| {
                one.outline.deployables.iter().filter_map(move |name| self.composite(file, name))
            });
        let deployed: BTreeSet<usize> = described.collect();
        let is_alone = |one: &usize| users[*one].is_empty() && !deployed.contains(one);
        let composites = (0..self.own).filter(|one| self.files[*one].outline.name.is_some());
        let others = composites.filter(is_alone).count();
        let may_be_part = others + usize::from(!deployed.is_empty()) > 1;
        let start: Vec<usize> = match self.file() {
            one if one.is_beside => self.owners(),
            // A description is wrong or right whatever runs.
            one if one.is_description() => match deployed.first() {
                Some(first) => vec![*first],
                None => (1..self.own).find(is_alone).into_iter().collect(),
            },
            _ => vec![0],
        };
        if start.is_empty() {
            return Vec::new();
        }
        let alone = reached(start.clone(), |place| users[place].clone()).into_iter().filter(is_alone);
        let alone =
            alone.map(|root| SceneFleet { files: vec![root], may_be_part: may_be_part || self.is_exported(root) });
        let mut fleets: Vec<SceneFleet> = alone.collect();
        let deployed: Vec<usize> = deployed.into_iter().collect();
        let mut named = reached(deployed.clone(), |place| names[place].clone()).into_iter();
        if named.any(|one| start.contains(&one)) {
            fleets.insert(0, SceneFleet { files: deployed, may_be_part: false });
        }
        // Composites that go around in circles have nothing around them.
        if fleets.is_empty() { vec![SceneFleet { files: vec![start[0]], may_be_part: false }] } else { fleets }
    }

    /// True if the contribution gives a composite to others.
    fn is_exported(&self, place: usize) -> bool {
        let namespace = &self.files[place].outline.namespace;
        self.files[..self.own].iter().any(|one| one.outline.exports.contains(namespace))
    }

    /// The composites that each file names, by includes and implementations, and those of the contribution that name
    /// it.
    fn naming(&self) -> (Vec<Vec<usize>>, Vec<Vec<usize>>) {
        let (mut names, mut users) = (Vec::new(), vec![Vec::new(); self.files.len()]);
        for place in 0..self.files.len() {
            let components = &self.files[place].outline.components;
            let implementations = components.iter().filter_map(|one| match &one.implementation {
                Some(Implementation::Composite(name)) => self.composite(place, name),
                _ => None,
            });
            let named: BTreeSet<usize> = self.includes[place].iter().copied().chain(implementations).collect();
            let others = named.iter().filter(|one| **one != place && !self.is_imported(place));
            others.for_each(|one| users[*one].push(place));
            names.push(named.into_iter().collect());
        }
        (names, users)
    }

    /// The files of the fleets that the first one is part of.
    pub(crate) fn fleet_files(&self) -> Vec<usize> {
        let (names, users) = self.naming();
        let start = if self.file().is_beside { self.owners() } else { vec![0] };
        let around = reached(start, |place| users[place].clone());
        reached(around, |place| names[place].clone())
    }

    /// The composites that take values from the first file.
    pub(crate) fn owners(&self) -> Vec<usize> {
        let owns = |file: &usize| self.files[*file].outline.beside.iter().any(|name| self.is_first(*file, name));
        (0..self.files.len()).filter(owns).collect()
    }

    /// True if a composite calls the first file so.
    pub(crate) fn is_first(&self, file: usize, name: &Named) -> bool {
        self.beside(file, name) == Some(0)
    }

    fn included(&self, file: usize) -> Vec<usize> {
        self.files[file].outline.includes.iter().filter_map(|name| self.composite(file, name)).collect()
    }

    /// The file of the composite that a QName in this file means.
    pub(crate) fn composite(&self, file: usize, name: &Named) -> Option<usize> {
        let (from, found) = (&self.files[file], self.by_name.get(local(&name.text))?);
        let of =
            |namespace: &str| found.iter().copied().find(|&other| self.files[other].outline.namespace == namespace);
        let bound = |prefix| from.element(name.element).resolve_prefix(prefix);
        match name.text.split_once(':') {
            Some((prefix, _)) => match bound(prefix) {
                Some(namespace) => of(namespace),
                None => found.first().copied(),
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
            let uses = |other: &usize| {
                let components = &self.files[*other].outline.components;
                components.iter().any(|one| self.inside(*other, one).contains(&file))
            };
            (0..self.files.len()).filter(uses).collect()
        })
    }

    /// The files in whose composites the component of an end is looked for: that of the end, or those around it.
    pub(crate) fn scopes<'s>(&'s self, file: &'s usize, end: &End) -> &'s [usize] {
        if end.is_outer { self.users(*file) } else { std::slice::from_ref(file) }
    }

    /// The component of this name in the composite that a file is part of.
    pub(crate) fn component(&self, file: usize, name: &str) -> Option<(usize, &Component)> {
        let &(file, place) = self.unit(file).components.get(name)?;
        Some((file, &self.files[file].outline.components[place]))
    }

    /// The components of a composite, in all its files, whose names have expressions.
    pub(crate) fn patterns(&self, file: usize) -> impl Iterator<Item = (usize, &Component)> {
        let all = self.unit(file).patterns.iter();
        all.map(|&(file, place)| (file, &self.files[file].outline.components[place]))
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
            let mut sources = self.files[file].outline.sources.iter();
            let source = sources.find(|one| one.element == property)?;
            self.parameter_value(file, &source.text)
        })
    }

    /// The simple value of a property of the composite that a file is part of.
    pub(crate) fn parameter_value(&self, file: usize, name: &str) -> Option<&str> {
        let Symbol::Parameter { file, name } = self.parameter(file, name) else { return None };
        let declared = self.files[file].outline.properties.iter().find(|one| one.text == name)?;
        self.value_of(file, declared.element)
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

    /// The files of the composite that implements a component of a file.
    pub(crate) fn inside(&self, file: usize, component: &Component) -> Vec<usize> {
        match &component.implementation {
            Some(Implementation::Composite(name)) => {
                self.composite(file, name).map_or_else(Vec::new, |found| self.with_included(found))
            }
            _ => Vec::new(),
        }
    }
}

/// The files of values by the paths that composites write for them.
fn beside(files: &[Arc<File>]) -> HashMap<PathBuf, usize> {
    let known: HashMap<&Path, usize> = files.iter().map(|file| file.path.as_path()).zip(0..).collect();
    let written = files.iter().flat_map(|file| {
        let folder = file.path.parent().unwrap_or(Path::new(""));
        file.outline.beside.iter().map(|name| folder.join(&name.text))
    });
    let written: BTreeSet<PathBuf> = written.collect();
    let found = written.into_iter().filter_map(|path| {
        let place = *known.get(identity(&path).as_path())?;
        Some((path, place))
    });
    found.collect()
}

/// The files reached from these, themselves first.
fn reached(start: Vec<usize>, next: impl Fn(usize) -> Vec<usize>) -> Vec<usize> {
    let mut seen: BTreeSet<usize> = start.iter().copied().collect();
    let mut all = start;
    let mut at = 0;
    while let Some(&one) = all.get(at) {
        at += 1;
        all.extend(next(one).into_iter().filter(|further| seen.insert(*further)));
    }
    all
}
