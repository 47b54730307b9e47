//! Composites together with all that they name.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use smol_str::SmolStr;

use super::{ComponentElement, ComponentType, Composite, ImplementationKind, Include, Origin, Part, Table, Version};
use crate::diagnostic::{Candidates, nearest};
use crate::source::{FileId, Location, Text};
use crate::syntax::ElementId;

/// The files of one fleet: the composites that were asked for, and those that they name.
///
/// [`Contribution::of`] links names among the composites it is given;
/// [`load_named`](crate::contribution::Finder::load_named) also looks for those in files.
#[derive(Debug, Default)]
pub struct Contribution {
    composites: Vec<Composite>,
    asked_for: usize,
    /// The number of composites that were asked for; the others were found by their names.
    given: usize,
    /// The places of those that were there at first by their names.
    by_name: HashMap<String, Vec<usize>>,
    /// The number of names that may still be searched for the one that was meant.
    candidates: Candidates,
    links: HashMap<(FileId, ElementId), Link>,
    libraries: HashMap<(FileId, ElementId), LibraryLink>,
    component_types: Vec<ComponentType>,
    /// By the element of the implementation; `None` for one that was looked for and is not there.
    described: HashMap<(FileId, ElementId), Option<usize>>,
    /// Tables whose names are expressions: by the file of the composite, and by the name that it comes to.
    tables: HashMap<(FileId, SmolStr), Arc<Table>>,
}

/// The target of the name of a composite.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Link {
    /// To this composite of the contribution.
    To(usize),
    /// To a file that has no composite that could be read; that is reported.
    Faulty,
    /// Nowhere.
    Missing(Missing),
}

/// The target of the `library`, or of the `module`, of an implementation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LibraryLink {
    /// To this file, whose classes are in the registry.
    To(PathBuf),
    /// To a file that is no plugin, or cannot be used: what is wrong with it.
    Faulty(String),
    /// To a file that must not be read; its path without links.
    Outside(PathBuf),
    /// Nowhere: the files that it would have been.
    Missing(Vec<PathBuf>),
    /// To code in another language that declares no class that could be used.
    Undeclared(Vec<ClassFault>),
}

/// A fault of the code of a class in another language.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ClassFault {
    /// The attribute of the implementation that it is about: `module` or `class`.
    pub part: String,
    /// The fault, with its place in the code if it has one.
    pub message: String,
    /// Lines of help.
    pub help: Vec<String>,
    /// The texts that are probably meant.
    pub instead: Vec<String>,
}

/// The knowledge about a composite that was not found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Missing {
    /// Names that are spelt alike, as they would be written in place of the wrong one.
    pub near: Vec<String>,
    /// The places that were searched and what was seen there, a sentence each.
    pub searched: Vec<String>,
    /// The namespace of a composite of this name that is of another one.
    pub elsewhere: Option<String>,
    /// The place of its `targetNamespace` where that is misspelt.
    pub misspelt: Option<Location>,
}

/// A place in a composite that names another one.
#[derive(Clone, Copy, Debug)]
pub struct Naming<'a> {
    /// The element that has the name.
    pub origin: Origin,
    /// The name, a QName.
    pub name: &'a Text,
}

impl<'a> Naming<'a> {
    /// The target of an include; `None` when it lacks a name.
    pub fn of_include(include: &'a Include) -> Option<Self> {
        (!include.name.is_empty()).then_some(Self { origin: include.origin, name: &include.name })
    }

    /// The target of `implementation.composite`.
    pub fn of_component(component: &'a ComponentElement) -> Option<Self> {
        let implementation = component.implementation.as_ref()?;
        match &implementation.kind {
            ImplementationKind::Composite { name } => {
                Some(Self { origin: implementation.origin(), name: name.as_ref()? })
            }
            _ => None,
        }
    }
}

impl Composite {
    /// All places in it that name other composites, in no order.
    pub fn namings(&self) -> impl Iterator<Item = Naming<'_>> {
        let includes = self.includes.iter().filter_map(Naming::of_include);
        includes.chain(self.components.iter().filter_map(Naming::of_component))
    }

    /// Its target namespace; empty for none.
    pub fn namespace(&self) -> &str {
        self.target_namespace.as_ref().map_or("", |namespace| namespace.as_str())
    }

    /// The namespaces that a QName in it may mean, the likeliest first, and its local part. `None` in place of the
    /// namespaces when its prefix is bound to none: then any will do.
    ///
    /// A name without a prefix is of the default namespace. Where that is one of SCA, which holds no user's composites,
    /// the composite's own is meant.
    pub fn resolve_name<'n>(&self, naming: Naming<'n>) -> (Option<Vec<String>>, &'n str) {
        let element = naming.origin.element(&self.document);
        match naming.name.as_str().split_once(':') {
            Some((prefix, local)) => {
                (element.resolve_prefix(prefix).map(|namespace| vec![namespace.to_owned()]), local)
            }
            None => {
                let default = element.resolve_prefix("").unwrap_or_default();
                let mut all = Vec::with_capacity(2);
                if !default.is_empty() && Version::from_namespace(default).is_none() {
                    all.push(default.to_owned());
                }
                for namespace in [self.namespace(), ""] {
                    if !all.iter().any(|known| known == namespace) {
                        all.push(namespace.to_owned());
                    }
                }
                (Some(all), naming.name.as_str())
            }
        }
    }
}

impl Contribution {
    /// These composites as one fleet. Names of composites are linked among them.
    pub fn of(composites: Vec<Composite>) -> Self {
        Self::with(composites, Vec::new())
    }

    /// These composites as one fleet, and others that they can name.
    pub fn with(composites: Vec<Composite>, others: Vec<Composite>) -> Self {
        let asked_for = composites.len();
        let mut composites = composites;
        composites.extend(others);
        let mut by_name: HashMap<String, Vec<usize>> = HashMap::new();
        for (place, composite) in composites.iter().enumerate() {
            by_name.entry(composite.name.as_str().to_owned()).or_default().push(place);
        }
        let mut all = Self { asked_for, given: composites.len(), composites, by_name, ..Self::default() };
        for place in 0..all.composites.len() {
            all.link_known(place);
        }
        all
    }

    /// The table whose name is written so in a file, and comes to a composite by an expression; see
    /// [`read_tables`](crate::contribution::read_tables).
    pub fn table(&self, file: FileId, name: &str) -> Option<&Table> {
        self.tables.get(&(file, SmolStr::from(name))).map(|table| &**table)
    }

    /// Adds such a table.
    pub fn add_table(&mut self, file: FileId, name: &str, table: Arc<Table>) {
        self.tables.insert((file, name.into()), table);
    }

    /// Every composite: those asked for, then those that they name.
    pub fn composites(&self) -> &[Composite] {
        &self.composites
    }

    /// The composites that were asked for.
    pub fn asked_for(&self) -> &[Composite] {
        &self.composites[..self.asked_for]
    }

    /// The target of the name at an element; `None` where it was not resolved.
    pub fn link(&self, origin: Origin) -> Option<&Link> {
        self.links.get(&(origin.file(), origin.element))
    }

    /// The target of the `library` or `module` of an implementation; `None` where it was not resolved.
    pub fn library(&self, implementation: Origin) -> Option<&LibraryLink> {
        self.libraries.get(&(implementation.file(), implementation.element))
    }

    /// Says where the `library` or `module` of an implementation leads.
    pub fn set_library(&mut self, implementation: Origin, link: LibraryLink) {
        self.libraries.insert((implementation.file(), implementation.element), link);
    }

    /// The component type in a file beside an implementation.
    pub fn component_type(&self, implementation: Origin) -> Option<&ComponentType> {
        let place = *self.described.get(&(implementation.file(), implementation.element))?;
        Some(&self.component_types[place?])
    }

    /// True if there are implementations with a component type, or without one that should be there.
    pub(crate) fn describes_any(&self) -> bool {
        !self.described.is_empty()
    }

    /// True if a component type was looked for and not found.
    pub fn lacks_component_type(&self, implementation: Origin) -> bool {
        self.described.get(&(implementation.file(), implementation.element)) == Some(&None)
    }

    /// Every component type that was read.
    pub fn component_types(&self) -> &[ComponentType] {
        &self.component_types
    }

    /// Adds a component type; its place.
    pub fn add_component_type(&mut self, component_type: ComponentType) -> usize {
        self.component_types.push(component_type);
        self.component_types.len() - 1
    }

    pub(crate) fn describe(&mut self, implementation: Origin, place: Option<usize>) {
        self.described.insert((implementation.file(), implementation.element), place);
    }

    /// Adds a composite that is named by another one, and links what it names among those that are known; its place.
    pub(crate) fn add(&mut self, composite: Composite) -> usize {
        self.composites.push(composite);
        self.link_known(self.composites.len() - 1);
        self.composites.len() - 1
    }

    pub(crate) fn set_link(&mut self, origin: Origin, link: Link) {
        self.links.insert((origin.file(), origin.element), link);
    }

    /// The place of a composite that was there at first.
    fn find(&self, namespaces: Option<&[String]>, local: &str) -> Option<usize> {
        let named = self.by_name.get(local)?;
        match namespaces {
            Some(namespaces) => {
                let of =
                    |namespace: &String| named.iter().find(|place| self.composites[**place].namespace() == namespace);
                namespaces.iter().find_map(of).copied()
            }
            None => named.first().copied(),
        }
    }

    fn link_known(&mut self, place: usize) {
        let composite = &self.composites[place];
        let mut candidates = std::mem::take(&mut self.candidates);
        let mut links = Vec::new();
        for naming in composite.namings() {
            let (namespaces, local) = composite.resolve_name(naming);
            let link = match self.find(namespaces.as_deref(), local) {
                Some(found) => Link::To(found),
                None => Link::Missing(self.missing(naming.name, local, &mut candidates)),
            };
            links.push((naming.origin, link));
        }
        self.candidates = candidates;
        links.into_iter().for_each(|(origin, link)| self.set_link(origin, link));
    }

    fn missing(&self, name: &Text, local: &str, candidates: &mut Candidates) -> Missing {
        let known = self.composites[..self.given].iter().map(|composite| composite.name.as_str());
        let is_wanted = candidates.admit(self.given);
        let near = is_wanted.then(|| nearest(local, known.filter(|known| *known != local))).flatten();
        let prefix = name.as_str().strip_suffix(local).unwrap_or_default();
        Missing {
            near: near.map(|near| format!("{prefix}{near}")).into_iter().collect(),
            searched: Vec::new(),
            elsewhere: None,
            misspelt: None,
        }
    }
}
