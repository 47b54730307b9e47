//! Composites, includes and wires.

use std::sync::Arc;

use super::origin::parts;
use super::{Component, Origin, Policy, Property, Reference, Service, SeverityRule, Version};
use crate::source::{FileId, Located, Text};
use crate::xml::{Document, ElementId};

/// A composite: components, what they are wired to, and what of them is promoted.
#[derive(Clone, Debug)]
pub struct Composite {
    /// Where it comes from.
    pub origin: Origin,
    /// The whole document: foreign elements and attributes, complex values, prefixes.
    pub document: Arc<Document>,
    /// The version of SCA that its namespace stands for.
    pub version: Version,
    /// `name`; empty, at the tag, when the file has none.
    pub name: Text,
    /// `targetNamespace`
    pub target_namespace: Option<Text>,
    /// `local`
    pub local: Option<Located<bool>>,
    /// `autowire`
    pub autowire: Option<Located<bool>>,
    /// `constrainingType` (1.0)
    pub constraining_type: Option<Text>,
    /// Its includes in order.
    pub includes: Vec<Include>,
    /// Its properties in order.
    pub properties: Vec<Property>,
    /// Its services in order.
    pub services: Vec<Service>,
    /// Its references in order.
    pub references: Vec<Reference>,
    /// Its components in order.
    pub components: Vec<Component>,
    /// Its wires in order.
    pub wires: Vec<Wire>,
    /// What it says about severities, in order, that in its elements included.
    pub severities: Vec<SeverityRule>,
    /// Intents and policy sets.
    pub policy: Policy,
    /// The names in it of what other files declare, in order.
    pub outside: Vec<OutsideName>,
}

/// The name of something that another file declares.
#[derive(Clone, Debug, PartialEq)]
pub struct OutsideName {
    /// The name: a QName, or a URI of a part of a WSDL document.
    pub name: Text,
    /// The element that has it.
    pub element: ElementId,
    /// What it is the name of.
    pub kind: OutsideKind,
}

/// What other files declare.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutsideKind {
    /// An intent, in `definitions.xml`.
    Intent,
    /// A policy set, in `definitions.xml`.
    PolicySet,
    /// A type, in a schema.
    Type,
    /// A global element, in a schema.
    Element,
    /// An interface, in WSDL.
    Wsdl,
    /// A binding, in WSDL.
    WsdlBinding,
    /// A service, in WSDL.
    WsdlService,
    /// A port of a service, in WSDL: `Service/Port`.
    WsdlPort,
}

impl OutsideKind {
    /// Those in WSDL.
    pub const OF_WSDL: [Self; 4] = [Self::Wsdl, Self::WsdlBinding, Self::WsdlService, Self::WsdlPort];

    /// What it is, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Intent => "intent",
            Self::PolicySet => "policy set",
            Self::Type => "type",
            Self::Element => "element",
            Self::Wsdl => "interface of WSDL",
            Self::WsdlBinding => "binding of WSDL",
            Self::WsdlService => "service of WSDL",
            Self::WsdlPort => "port of WSDL",
        }
    }
}

/// An inclusion of all that another composite holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Include {
    /// Where it comes from.
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
pub struct Wire {
    /// Where it comes from.
    pub origin: Origin,
    /// `source`: `component` or `component/reference`; `None` when the file has none.
    pub source: Option<Text>,
    /// `target`: `component`, `component/service` or `component/service/binding`; `None` when the file has none.
    pub target: Option<Text>,
    /// What few wires have.
    pub details: Option<Box<WireDetails>>,
}

/// What few wires have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WireDetails {
    /// `replace` (1.1)
    pub replace: Option<Located<bool>>,
    /// `if`, in the namespace of SAOMS: it is there only where this is true.
    pub condition: Option<Text>,
}

impl Wire {
    /// `replace` (1.1)
    pub fn replace(&self) -> Option<Located<bool>> {
        self.details.as_ref()?.replace
    }

    /// `if`, in the namespace of SAOMS: it is there only where this is true.
    pub fn condition(&self) -> Option<&Text> {
        self.details.as_ref()?.condition.as_ref()
    }
}

parts!(Composite, Include, Wire);

impl Composite {
    /// The file it was read from.
    pub fn file(&self) -> FileId {
        self.origin.tag.file
    }

    /// The first component of this name.
    pub fn component(&self, name: &str) -> Option<&Component> {
        self.components.iter().find(|component| component.name == name)
    }
}
