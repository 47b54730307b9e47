//! Components and their implementations.

use smol_str::SmolStr;

use super::origin::parts;
use super::{LoopElement, Origin, Property, ReferenceElement, Replicas, ServiceElement};
use crate::source::{Located, Text};

/// A component: a configured use of an implementation.
#[derive(Clone, Debug, PartialEq)]
pub struct ComponentElement {
    /// The origin in its file.
    pub origin: Origin,
    /// `name`; empty, at the tag, when the file has none.
    pub name: Text,
    /// Its implementation.
    pub implementation: Option<Implementation>,
    /// Its properties in order.
    pub properties: Vec<Property>,
    /// Its services in order.
    pub services: Vec<ServiceElement>,
    /// Its references in order.
    pub references: Vec<ReferenceElement>,
    /// Rarely needed fields, which the methods give.
    pub details: Option<Box<ComponentDetails>>,
}

/// Rarely needed fields, boxed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComponentDetails {
    /// `path`, in the namespace of SAOMS: the path that it keeps when its composite is written anew.
    pub path: Option<Text>,
    /// `if`, in the namespace of SAOMS: it is there only where this is true.
    pub condition: Option<Text>,
    /// Its replicas, in the namespace of SAOMS; `None` for a single component.
    pub replicas: Option<Replicas>,
    /// `autowire`.
    pub autowire: Option<Located<bool>>,
    /// Its changes of the loops of its class, in order.
    pub loops: Vec<LoopElement>,
}

impl ComponentElement {
    /// `path`, in the namespace of SAOMS: the path that it keeps when its composite is written anew.
    pub fn path(&self) -> Option<&Text> {
        self.details.as_ref()?.path.as_ref()
    }

    /// `if`, in the namespace of SAOMS: it is there only where this is true.
    pub fn condition(&self) -> Option<&Text> {
        self.details.as_ref()?.condition.as_ref()
    }

    /// Its replicas, in the namespace of SAOMS; `None` for a single component.
    pub fn replicas(&self) -> Option<&Replicas> {
        self.details.as_ref()?.replicas.as_ref()
    }

    /// `autowire`.
    pub fn autowire(&self) -> Option<Located<bool>> {
        self.details.as_ref()?.autowire
    }

    /// Its changes of the loops of its class, in order.
    pub fn loops(&self) -> &[LoopElement] {
        self.details.as_ref().map_or(&[], |details| &details.loops)
    }

    /// The first property of this name.
    pub fn property(&self, name: &str) -> Option<&Property> {
        self.properties.iter().find(|property| property.name == name)
    }

    /// The first service of this name.
    pub fn service(&self, name: &str) -> Option<&ServiceElement> {
        self.services.iter().find(|service| service.name == name)
    }

    /// The first reference of this name.
    pub fn reference(&self, name: &str) -> Option<&ReferenceElement> {
        self.references.iter().find(|reference| reference.name == name)
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
    /// The origin in its file.
    pub origin: Origin,
    /// The kind, with the name that it gives.
    pub kind: ImplementationKind,
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
        /// The kind of another runtime: the text behind `implementation.`, as `script`.
        kind: SmolStr,
        /// True if its element is of an SCA namespace.
        is_sca: bool,
    },
}

parts!(ComponentElement, Implementation);
