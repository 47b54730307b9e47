//! Components and their implementations.

use smol_str::SmolStr;

use super::origin::parts;
use super::{Loop, Origin, Policy, Properties, Property, Reference, Replicas, Service};
use crate::source::{Located, Text};

/// A component: a configured use of an implementation.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Where it comes from.
    pub origin: Origin,
    /// `name`; empty, at the tag, when the file has none.
    pub name: Text,
    /// Its implementation.
    pub implementation: Option<Implementation>,
    /// Its properties in order.
    pub properties: Properties,
    /// Its services in order.
    pub services: Vec<Service>,
    /// Its references in order.
    pub references: Vec<Reference>,
    /// What few components have; the methods give it.
    pub details: Option<Box<ComponentDetails>>,
    /// Whether its properties are a text each, and its services and references have no more than names and targets, as most do: there is
    /// nothing else to look for in them.
    pub(crate) has_plain_parts: bool,
}

/// What few components have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComponentDetails {
    /// `path`, in the namespace of SAOMS: the path that it keeps when its composite is written anew.
    pub path: Option<Text>,
    /// `if`, in the namespace of SAOMS: it is there only where this is true.
    pub condition: Option<Text>,
    /// What is said about its replicas, in the namespace of SAOMS; `None` for a component that stands for itself alone.
    pub replicas: Option<Replicas>,
    /// `autowire`.
    pub autowire: Option<Located<bool>>,
    /// `constrainingType` (1.0).
    pub constraining_type: Option<Text>,
    /// What it says about its loops, in order.
    pub loops: Vec<Loop>,
    /// Intents and policy sets.
    pub policy: Policy,
    /// The order of the names of its services and references, where there are many.
    pub(crate) names: Option<Box<Names>>,
}

/// Up to here parts are found by looking at all of them.
const FEW: usize = 64;

/// The places of the services and the references of a component in the order of their names.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Names {
    services: Vec<u32>,
    references: Vec<u32>,
}

impl Names {
    /// `None` where there are few.
    pub(crate) fn of(services: &[Service], references: &[Reference]) -> Option<Box<Self>> {
        if services.len().max(references.len()) <= FEW {
            return None;
        }
        Some(Box::new(Self {
            services: in_order(services.iter().map(|one| one.name.as_str()).collect()),
            references: in_order(references.iter().map(|one| one.name.as_str()).collect()),
        }))
    }
}

/// The places of names in their order; of those of one name the first stands first.
fn in_order(names: Vec<&str>) -> Vec<u32> {
    // A file has fewer bytes.
    let mut places: Vec<u32> = (0..names.len() as u32).collect();
    places.sort_by_key(|place| names[*place as usize]);
    places
}

/// The first of this name.
fn find<'p, T>(all: &'p [T], order: Option<&[u32]>, name: &str, of: fn(&T) -> &str) -> Option<&'p T> {
    let Some(order) = order.filter(|order| order.len() == all.len()) else {
        return all.iter().find(|one| of(one) == name);
    };
    let at = order.partition_point(|place| of(&all[*place as usize]) < name);
    order.get(at).map(|place| &all[*place as usize]).filter(|one| of(one) == name)
}

impl Component {
    /// Finds out whether its parts are plain.
    pub(crate) fn find_plain_parts(&mut self) {
        let Self { properties, services, references, .. } = self;
        self.has_plain_parts = properties.iter().all(|one| one.details.is_none() && one.simple.is_some())
            && services.iter().all(|one| one.promote.is_none() && one.contract.is_none())
            && references.iter().all(|one| one.details.is_none() && one.contract.is_none());
    }

    /// Whether it has plain parts and nothing else than a class: it names no composite, no library and no file, and is no replica.
    pub(crate) fn is_usual(&self) -> bool {
        let is_class = |one: &Implementation| {
            matches!(
                one.kind,
                ImplementationKind::Java { .. } | ImplementationKind::Rust { library: None, .. }
            )
        };
        self.has_plain_parts && self.details.is_none() && self.implementation.as_ref().is_none_or(is_class)
    }

    /// Whether it has no more than one property, one service and one reference.
    pub(crate) fn has_single_parts(&self) -> bool {
        self.properties.len() <= 1 && self.services.len() <= 1 && self.references.len() <= 1
    }

    /// Whether it has no name and says nothing.
    pub(crate) fn is_nothing(&self) -> bool {
        self.name.is_empty()
            && self.implementation.is_none()
            && self.details.is_none()
            && self.properties.is_empty()
            && self.services.is_empty()
            && self.references.is_empty()
    }

    /// `path`, in the namespace of SAOMS: the path that it keeps when its composite is written anew.
    pub fn path(&self) -> Option<&Text> {
        self.details.as_ref()?.path.as_ref()
    }

    /// `if`, in the namespace of SAOMS: it is there only where this is true.
    pub fn condition(&self) -> Option<&Text> {
        self.details.as_ref()?.condition.as_ref()
    }

    /// What is said about its replicas, in the namespace of SAOMS; `None` for a component that stands for itself alone.
    pub fn replicas(&self) -> Option<&Replicas> {
        self.details.as_ref()?.replicas.as_ref()
    }

    /// `autowire`.
    pub fn autowire(&self) -> Option<Located<bool>> {
        self.details.as_ref()?.autowire
    }

    /// `constrainingType` (1.0).
    pub fn constraining_type(&self) -> Option<&Text> {
        self.details.as_ref()?.constraining_type.as_ref()
    }

    /// What it says about its loops, in order.
    pub fn loops(&self) -> &[Loop] {
        self.details.as_ref().map_or(&[], |details| &details.loops)
    }

    /// Intents and policy sets.
    pub fn policy(&self) -> &Policy {
        self.details.as_ref().map_or(&Policy::NONE, |details| &details.policy)
    }

    /// The first property of this name.
    pub fn property(&self, name: &str) -> Option<&Property> {
        self.properties.iter().find(|property| property.name == name)
    }

    /// The first service of this name.
    pub fn service(&self, name: &str) -> Option<&Service> {
        let order = self.names().map(|names| &names.services[..]);
        find(&self.services, order, name, |service| &service.name)
    }

    /// The first reference of this name.
    pub fn reference(&self, name: &str) -> Option<&Reference> {
        let order = self.names().map(|names| &names.references[..]);
        find(&self.references, order, name, |reference| &reference.name)
    }

    fn names(&self) -> Option<&Names> {
        self.details.as_ref()?.names.as_deref()
    }

    /// The class that the registry is asked for: that of `implementation.java` or `implementation.rust`.
    pub fn class(&self) -> Option<&Text> {
        match &self.implementation.as_ref()?.kind {
            ImplementationKind::Java { class } | ImplementationKind::Rust { class, .. } => class.as_ref(),
            _ => None,
        }
    }
}

/// The implementation of a component.
#[derive(Clone, Debug, PartialEq)]
pub struct Implementation {
    /// Where it comes from.
    pub origin: Origin,
    /// Which kind, with what it names.
    pub kind: ImplementationKind,
    /// Intents and policy sets.
    pub policy: Policy,
}

/// A kind of implementation with what it names. `None` where the file leaves out a required attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum ImplementationKind {
    /// `implementation.java`
    Java {
        /// `class`
        class: Option<Text>,
    },
    /// `implementation.composite`
    Composite {
        /// `name`: the QName of a composite.
        name: Option<Text>,
    },
    /// `implementation.rust`, in the SCA namespace or in that of SAOMS.
    Rust {
        /// `class`: a name in the registry.
        class: Option<Text>,
        /// `library`: the plugin that has the class.
        library: Option<Box<Text>>,
    },
    /// Any other, of SCA or foreign; its element has the attributes.
    Other {
        /// What follows `implementation.` in its name, as `script`.
        kind: SmolStr,
        /// Whether its element is of an SCA namespace.
        is_sca: bool,
    },
}

parts!(Component, Implementation);
