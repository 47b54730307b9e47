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

mod contribution;
mod definitions;
mod elements;
mod own;
mod policy;
mod types;

pub(super) use contribution::COMPONENT_TYPE;
pub use contribution::CONTRIBUTION;
pub(crate) use definitions::DEFINITIONS;
pub(super) use definitions::{definition, is_of_definitions};
pub use elements::{
    BINDING_SCA, CALLBACK, COMPONENT, COMPONENT_PROPERTY, COMPONENT_REFERENCE, COMPONENT_SERVICE, COMPOSITE,
    COMPOSITE_PROPERTY, COMPOSITE_REFERENCE, COMPOSITE_SERVICE, IMPLEMENTATION_COMPOSITE, IMPLEMENTATION_JAVA,
    IMPLEMENTATION_RUST, INCLUDE, INTERFACE_JAVA, INTERFACE_RUST, INTERFACE_WSDL, LOOP, OTHERS, VARIANTS, WIRE,
};
pub(super) use own::own_parents;
pub use own::{OWN_ATTRIBUTES, OWN_ELEMENTS, SEVERITY, SEVERITY_PARENTS};
pub use policy::{EXTENSIONS, INTENTS, OPERATION, POLICY_SET};
pub use types::{BUILT_IN_TYPES, XML_SCHEMA};

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
    /// The SCA elements that it can hold; a name that ends with a dot stands for all that start so.
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
    /// The name of an environment variable.
    Variable,
    /// The code of a diagnostic, such as `S4001`.
    Code,
    /// `allow`, `note`, `warning` or `error`.
    Level,
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
            return contribution::PARTS.iter().find(|part| part.name == name);
        }
        let is_top = std::ptr::eq(self, &COMPOSITE);
        let found = match (name, is_top) {
            ("component", _) => &COMPONENT,
            ("include", _) => &INCLUDE,
            ("wire", _) => &WIRE,
            ("property", true) => &COMPOSITE_PROPERTY,
            ("property", false) => &COMPONENT_PROPERTY,
            ("service", true) => &COMPOSITE_SERVICE,
            ("service", false) => &COMPONENT_SERVICE,
            ("reference", true) => &COMPOSITE_REFERENCE,
            ("reference", false) => &COMPONENT_REFERENCE,
            ("callback", _) => &CALLBACK,
            ("implementation.java", _) => &IMPLEMENTATION_JAVA,
            ("implementation.composite", _) => &IMPLEMENTATION_COMPOSITE,
            ("implementation.rust", _) => &IMPLEMENTATION_RUST,
            ("interface.java", _) => &INTERFACE_JAVA,
            ("interface.rust", _) => &INTERFACE_RUST,
            ("interface.wsdl", _) => &INTERFACE_WSDL,
            ("binding.sca", _) => &BINDING_SCA,
            _ => return None,
        };
        children(self).any(|child| child == name).then_some(found)
    }
}

/// The elements that `kind` can hold, all variants by name.
pub fn children(kind: &Kind) -> impl Iterator<Item = &'static str> {
    kind.children.iter().flat_map(|child| {
        match VARIANTS.iter().find(|(prefix, _)| prefix == child) {
            Some((_, variants)) => *variants,
            None => std::slice::from_ref(child),
        }
        .iter()
        .copied()
    })
}

/// The purpose of an element whose parts are not known here.
pub fn other(name: &str) -> Option<&'static str> {
    OTHERS.iter().find(|(known, _)| *known == name).map(|(_, doc)| *doc)
}

/// The attributes that SAOMS adds to an element.
pub fn own_attributes(kind: &'static Kind) -> impl Iterator<Item = &'static Known> {
    let place = if std::ptr::eq(kind, &COMPOSITE_PROPERTY) { "composite/property" } else { kind.name };
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

/// True if SCA has an element of this name somewhere in a composite.
pub(super) fn is_known(name: &str) -> bool {
    let all = [&COMPOSITE, &COMPONENT, &COMPONENT_SERVICE, &BINDING_SCA, &COMPONENT_PROPERTY];
    name == "composite" || all.into_iter().flat_map(children).any(|known| known == name)
}
