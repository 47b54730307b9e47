//! Components and their implementations.

use smol_str::SmolStr;

use super::details::details;
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

details! {
    /// Rarely needed fields, boxed.
    ComponentDetails of ComponentElement {
        /// `path`, in the namespace of SAOMS: the path that it keeps when its composite is written anew.
        optional path: Text,
        /// `if`, in the namespace of SAOMS: it is there only where this is true.
        optional condition: Text,
        /// Its replicas, in the namespace of SAOMS; `None` for a single component.
        optional replicas: Replicas,
        /// `autowire`.
        copied autowire: Located<bool>,
        /// Its changes of the loops of its class, in order.
        list loops: LoopElement,
    }
}

impl ComponentElement {
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
