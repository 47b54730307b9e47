//! Composites with their includes, wires and severities, and component types.

use std::sync::Arc;

use super::{ComponentElement, Origin, Property, ReferenceElement, RunSettings, ServiceElement, Version};
use crate::diagnostic::SeverityLevel;
use crate::source::{FileId, Located, Location, Text};
use crate::syntax::Document;

/// A composite: components, what they are wired to, and what of them is promoted.
#[derive(Clone, Debug)]
pub struct Composite {
    /// The origin in its file.
    pub origin: Origin,
    /// The whole document: foreign elements and attributes, complex values, prefixes.
    pub document: Arc<Document>,
    /// The version of SCA of its namespace.
    pub version: Version,
    /// `name`; empty, at the tag, when the file has none.
    pub name: Text,
    /// `targetNamespace`
    pub target_namespace: Option<Text>,
    /// `local`
    pub local: Option<Located<bool>>,
    /// `autowire`
    pub autowire: Option<Located<bool>>,
    /// Its includes in order.
    pub includes: Vec<Include>,
    /// Its properties in order.
    pub properties: Vec<Property>,
    /// Its services in order.
    pub services: Vec<ServiceElement>,
    /// Its references in order.
    pub references: Vec<ReferenceElement>,
    /// Its components in order.
    pub components: Vec<ComponentElement>,
    /// Its wires in order.
    pub wires: Vec<WireElement>,
    /// Its severity settings in order, those in its elements included.
    pub severities: Vec<SeverityRule>,
    /// What it says of the run.
    pub run: RunSettings,
}

/// An inclusion of all that another composite holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Include {
    /// The origin in its file.
    pub origin: Origin,
    /// `name`: the QName of a composite; empty, at the tag, when the file has none.
    pub name: Text,
    /// `uri`: the file of the composite, as Tuscany understands it.
    pub uri: Option<Text>,
    /// `if`, in the namespace of SAOMS: it is there only where this is true.
    pub condition: Option<Text>,
}

/// A wire from a reference to a service.
#[derive(Clone, Debug, PartialEq)]
pub struct WireElement {
    /// The origin in its file.
    pub origin: Origin,
    /// `source`: `component` or `component/reference`; `None` when the file has none.
    pub source: Option<Text>,
    /// `target`: `component`, `component/service` or `component/service/binding`; `None` when the file has none.
    pub target: Option<Text>,
    /// `replace` (1.1)
    pub replace: Option<Located<bool>>,
    /// `if`, in the namespace of SAOMS: it is there only where this is true.
    pub condition: Option<Text>,
}

/// A `severity`: it sets that of the diagnostics of one code in the element that it stands in.
#[derive(Clone, Debug, PartialEq)]
pub struct SeverityRule {
    /// The origin in its file.
    pub origin: Origin,
    /// `code`, as `S4001`.
    pub code: Text,
    /// `level`.
    pub level: Located<SeverityLevel>,
    /// `reason`.
    pub reason: Text,
    /// True if it is wrong, which is reported: diagnostics of its code are then suppressed.
    pub is_wrong: bool,
    /// The element that it stands in; `None` for the composite itself.
    pub within: Option<Location>,
}

/// Component types: services, references and properties of an implementation, as a `.componentType` file states them.
#[derive(Clone, Debug)]
pub struct ComponentType {
    /// The origin in its file.
    pub origin: Origin,
    /// The whole document.
    pub document: Arc<Document>,
    /// The version of SCA of the namespace.
    pub version: Version,
    /// Its services in order.
    pub services: Vec<ServiceElement>,
    /// Its references in order.
    pub references: Vec<ReferenceElement>,
    /// Its properties in order; a value is the default of components.
    pub properties: Vec<Property>,
}

parts!(Composite, Include, WireElement, SeverityRule, ComponentType);

impl Composite {
    /// The file it was read from.
    pub fn file(&self) -> FileId {
        self.origin.tag.file
    }

    /// The first component of this name.
    pub fn component(&self, name: &str) -> Option<&ComponentElement> {
        self.components.iter().find(|component| component.name == name)
    }
}
