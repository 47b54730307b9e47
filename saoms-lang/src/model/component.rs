//! Components, with their implementations, loops and replicas.

use std::sync::Arc;

use smol_str::SmolStr;

use super::{Origin, Property, ReferenceElement, ServiceElement};
use crate::source::{FileId, Located, Text};

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
    /// `path`, in the namespace of SAOMS: the path that it keeps when its composite is written anew.
    pub path: Option<Box<Text>>,
    /// `site`, in the namespace of SAOMS: the site of the component and of all that is inside it.
    pub site: Option<Box<Text>>,
    /// `node`, in the namespace of SAOMS: the program that runs the component and all that is inside it.
    pub node: Option<Box<Text>>,
    /// `if`, in the namespace of SAOMS: it is there only where this is true.
    pub condition: Option<Box<Text>>,
    /// Its replicas, in the namespace of SAOMS; `None` for a single component.
    pub replicas: Option<Box<Replicas>>,
    /// `autowire`.
    pub autowire: Option<Located<bool>>,
    /// Its changes of the loops of its class, in order.
    pub loops: Vec<LoopElement>,
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

    /// The class that the registry is asked for: that of `implementation.java`, `implementation.rust` or
    /// `implementation.python`.
    pub fn class(&self) -> Option<&Text> {
        match &self.implementation.as_ref()?.kind {
            ImplementationKind::Java { class } | ImplementationKind::Rust { class, .. } => class.as_ref(),
            ImplementationKind::Python(class) => class.name.as_ref(),
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

/// A class in Python, beside other kinds of implementations, which are many and have less to name.
#[derive(Clone, Debug, PartialEq)]
pub struct PythonClass {
    /// `module`
    pub module: Option<Text>,
    /// `class`
    pub class: Option<Text>,
    /// The name in the registry: that of the module, a dot, and that of the class, at the place of the latter.
    pub name: Option<Text>,
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
        library: Option<Text>,
    },
    /// `implementation.python`, in the SCA namespace or in that of SAOMS.
    Python(Box<PythonClass>),
    /// Any other, of SCA or foreign; its element has the attributes.
    Other {
        /// The kind of another runtime: the text behind `implementation.`, as `script`.
        kind: SmolStr,
        /// True if its element is of an SCA namespace.
        is_sca: bool,
    },
}

/// A `loop` of a component: it adds, replaces, removes, moves or parametrises one.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopElement {
    /// The origin in its file.
    pub origin: Origin,
    /// `name`: what the loop is called within the component; empty, at the tag, when the file has none.
    pub name: Text,
    /// `class`: a name in the registry.
    pub class: Option<Text>,
    /// `before`: the loop that it stands directly before.
    pub before: Option<Text>,
    /// `after`: the loop that it stands directly after.
    pub after: Option<Text>,
    /// `remove`.
    pub remove: Option<Located<bool>>,
    /// Its properties in order.
    pub properties: Vec<Property>,
    /// True if something in it is faulty, which is reported: it may be meant to say more.
    pub is_misread: bool,
}

impl LoopElement {
    /// True if it takes the loop of its name away.
    pub fn is_removal(&self) -> bool {
        self.remove.is_some_and(|remove| remove.value)
    }
}

/// Replicas of a component.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replicas {
    /// `count`: an expression; how many there are. `None` when only the others are given, or a name that uses the
    /// index.
    pub count: Option<Text>,
    /// The attribute that probably stands for `count`, where that is not given: it is faulty, which is reported.
    pub misread_count: Option<MisreadCount>,
    /// `from`: an expression; the index of the first.
    pub from: Option<Text>,
    /// `overrides`: the file of the table.
    pub overrides: Option<Text>,
    /// The content of that file; `None` until [`read_values`](crate::contribution::read_values), and where it cannot be
    /// read.
    pub table: Option<Arc<Table>>,
}

/// The reason why an attribute is not read as the number of replicas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MisreadCount {
    /// A component has no such attribute, or it is empty.
    Attribute,
    /// Its namespace is nearly that of SAOMS.
    Namespace,
}

/// A table of what differs from one replica to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The file.
    pub file: FileId,
    /// The heading of the first column: `index` or `name`.
    pub key: Text,
    /// The properties of the other columns.
    pub properties: Vec<Text>,
    /// The lines below the first.
    pub rows: Vec<Row>,
}

/// A line of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The replica that it is about.
    pub key: Text,
    /// A value for each property; `None` for a replica that has its own.
    pub values: Vec<Option<Text>>,
}

parts!(ComponentElement, Implementation, LoopElement);
