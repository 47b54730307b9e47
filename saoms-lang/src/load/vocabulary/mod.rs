//! Vocabulary: attributes and content of the elements of SCA (the XML schemas of SCA 1.0 and SCA Assembly 1.1) and of
//! SAOMS.
//!
//! The loader holds files to these tables; the XML schema for editors is made of them, too. Where the schemas of the
//! two versions differ and both could be meant, what either allows is known.

/// Attributes that several elements have: `NAME = known "name" Holds: "doc";`, with `known`, `required`, `old` or
/// `new`.
macro_rules! attributes {
    ($($NAME:ident = $made:ident $name:literal $holds:ident: $doc:literal;)*) => {
        $(const $NAME: Known = attribute!($made $name $holds $doc);)*
    };
}

/// An attribute: a row of a table, or one of [`attributes!`] by its name.
macro_rules! attribute {
    ($made:ident $name:literal $holds:ident $doc:expr) => {
        super::$made($name, super::Holds::$holds, $doc)
    };
    ($NAME:ident) => {
        $NAME
    };
}

/// Elements: `NAME = "name": "doc" { attributes } [children]`.
macro_rules! kinds {
    ($($(#[$meta:meta])* $vis:vis $NAME:ident = $name:literal: $doc:literal {
        $($row:ident $($attribute:literal $holds:ident: $about:expr)?;)*
    } $children:tt)*) => {
        $($(#[$meta])* $vis static $NAME: super::Kind = super::Kind {
            name: $name,
            doc: $doc,
            attributes: &[$(attribute!($row $($attribute $holds $about)?)),*],
            children: kinds!(@children $children),
        };)*
    };
    (@children $names:ident) => { $names };
    (@children $names:tt) => { &$names };
}

mod elements;
mod files;

pub use elements::{
    BINDING_REST, BINDING_SCA, BUILT_IN_TYPES, CALLBACK, COMPONENT, COMPONENT_PROPERTY, COMPONENT_REFERENCE,
    COMPONENT_SERVICE, COMPOSITE, COMPOSITE_PROPERTY, COMPOSITE_REFERENCE, COMPOSITE_SERVICE, EXTENSIONS,
    IMPLEMENTATION_COMPOSITE, IMPLEMENTATION_JAVA, IMPLEMENTATION_PYTHON, IMPLEMENTATION_RUST, INCLUDE, INTENTS,
    INTERFACE_JAVA, INTERFACE_RUST, INTERFACE_WSDL, LOOP, OPERATION, OWN_ATTRIBUTES, OWN_ELEMENTS, POLICY_SET,
    SEVERITY, SEVERITY_PARENTS, WIRE, XML_SCHEMA,
};
use elements::{KINDS, OTHERS};
pub(super) use elements::{POLICIES, own_parents};
pub use files::CONTRIBUTION;
pub(crate) use files::DEFINITIONS;
pub(super) use files::{COMPONENT_TYPE, definition, is_of_definitions};

use crate::model::Version;

/// An element whose attributes and content are known.
#[derive(Debug)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// The purpose, in a sentence or two.
    pub doc: &'static str,
    /// Its attributes.
    pub attributes: &'static [Known],
    /// The SCA elements that it can hold; a name that ends with a dot means all that start so.
    pub children: &'static [&'static str],
}

/// An attribute that is known.
#[derive(Debug)]
pub struct Known {
    /// Its name.
    pub name: &'static str,
    /// The type of its value.
    pub holds: Holds,
    /// The meaning, in a sentence or two.
    pub doc: &'static str,
    /// True if the element has to have it.
    pub required: bool,
    /// True if it is of 1.0 alone: a mistake in 1.1.
    pub only_1_0: bool,
    /// True if it is of 1.1 alone: understood in 1.0 as well, with a warning.
    pub only_1_1: bool,
}

const fn known(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { name, holds, doc, required: false, only_1_0: false, only_1_1: false }
}

const fn required(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { required: true, ..known(name, holds, doc) }
}

const fn old(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { only_1_0: true, ..known(name, holds, doc) }
}

const fn new(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { only_1_1: true, ..known(name, holds, doc) }
}

/// The type of the value of an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Holds {
    /// A name that its author gives: without blanks and `/`.
    Name,
    /// The name of a property of the class.
    PropertyName,
    /// The name of a service of the class.
    ServiceName,
    /// The name of a reference of the class.
    ReferenceName,
    /// The name of a class of components.
    Class,
    /// The name of an interface.
    Interface,
    /// The name of a loop within a component.
    LoopName,
    /// The name of a class of loops.
    LoopClass,
    /// The name of a composite, with the prefix of its namespace.
    Composite,
    /// A component, or a component and one of its services or references: `Robot001/world`.
    End,
    /// Any number of such ends between blanks.
    Ends,
    /// The value of a property.
    Value,
    /// The source of the value of a property: `$name`, with a path into a complex value.
    Source,
    /// `true` or `false`.
    Boolean,
    /// `0..1`, `1..1`, `0..n` or `1..n`.
    Multiplicity,
    /// The type of a value, with a prefix of its namespace.
    Type,
    /// A global element of a schema, with a prefix of its namespace.
    Element,
    /// The file of a value, beside the composite.
    File,
    /// The table of what differs among replicas, beside the composite.
    Table,
    /// The library of a plugin.
    Library,
    /// The namespace of a composite.
    Namespace,
    /// A URI.
    Uri,
    /// Names with prefixes, between blanks.
    Names,
    /// An expression that comes to a whole number, as `2 * robots`.
    Number,
    /// An expression that comes to true or false, as `robots > 10`.
    Condition,
    /// A duration, as `500ms`.
    Duration,
    /// The name of an environment variable.
    Variable,
    /// The code of a diagnostic, such as `S4001`.
    Code,
    /// `allow`, `note`, `warning` or `error`.
    Level,
    /// `end`, `hold` or `goOn`.
    Hangup,
    /// Any text.
    Text,
}

impl Kind {
    /// True if an element of this version has the attribute.
    pub fn has(&self, name: &str, version: Version) -> bool {
        self.find(name, version).is_some()
    }

    /// The declaration of an attribute of an element of this version.
    pub(super) fn find(&self, name: &str, version: Version) -> Option<&'static Known> {
        self.of(version).find(|known| known.name == name)
    }

    /// The attributes in this version.
    pub fn of(&self, version: Version) -> impl Iterator<Item = &'static Known> {
        self.attributes.iter().filter(move |known| !(known.only_1_0 && version.is_1_1()))
    }

    /// The names of the attributes in this version.
    pub(super) fn names(&self, version: Version) -> impl Iterator<Item = &'static str> {
        self.of(version).map(|known| known.name)
    }

    /// The kind of an element of this name inside this one; `None` where it cannot stand, or where its parts are not
    /// known.
    pub fn child(&self, name: &str) -> Option<&'static Kind> {
        if std::ptr::eq(self, &CONTRIBUTION) {
            return files::PARTS.iter().find(|part| part.name == name);
        }
        let mut named = KINDS.into_iter().filter(|kind| kind.name == name);
        let found = if std::ptr::eq(self, &COMPOSITE) { named.next() } else { named.next_back() };
        found.filter(|_| children(self).any(|child| child == name))
    }
}

/// The elements of SCA in composites.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    let others = OTHERS.iter().map(|(name, _)| *name);
    KINDS.into_iter().chain(POLICIES).map(|kind| kind.name).chain(others)
}

/// The elements that `kind` can hold, all variants by name.
pub fn children(kind: &Kind) -> impl Iterator<Item = &'static str> {
    kind.children.iter().flat_map(|child| {
        let itself = (!child.ends_with('.')).then_some(*child);
        let variants = names().filter(move |name| itself.is_none() && name.starts_with(child));
        itself.into_iter().chain(variants)
    })
}

/// The purpose of an element whose parts are not known here.
pub fn other(name: &str) -> Option<&'static str> {
    let policies = POLICIES.into_iter().map(|kind| (kind.name, kind.doc));
    policies.chain(OTHERS.iter().copied()).find(|(known, _)| *known == name).map(|(_, doc)| doc)
}

/// The attributes that SAOMS adds to an element.
pub fn own_attributes(kind: &'static Kind) -> impl Iterator<Item = &'static Known> {
    let place = match kind {
        _ if std::ptr::eq(kind, &COMPOSITE_PROPERTY) => "composite/property",
        _ if std::ptr::eq(kind, &COMPONENT_REFERENCE) => "component/reference",
        _ => kind.name,
    };
    OWN_ATTRIBUTES.iter().filter(move |(of, _)| *of == place).map(|(_, known)| known)
}

/// Their names.
pub(super) fn own_names(kind: &'static Kind) -> impl Iterator<Item = &'static str> {
    own_attributes(kind).map(|known| known.name)
}

/// True if SAOMS adds the attribute to the element.
pub(super) fn is_own(kind: &'static Kind, attribute: &str) -> bool {
    own_names(kind).any(|known| known == attribute)
}
