//! The SCA assembly model as one file states it: every name and value with its place.
//!
//! A [`Composite`] is what [`load`](crate::load) makes of one file. Nothing is resolved: includes, promotions, targets
//! and sources of properties are texts with places. Values that the file leaves out are `None` or empty, defaults are
//! for the checker to apply. Foreign elements and attributes are not copied: they are in the composite's
//! [`Document`], reached through each part's [`Origin`].

/// Parts of the model by their types.
macro_rules! parts {
    ($($part:ty),*) => {
        $(impl crate::model::Part for $part {
            fn origin(&self) -> crate::model::Origin {
                self.origin
            }
        })*
    };
}

mod component;
mod composite;
mod contract;
mod contribution;
mod http_address;
mod property;
mod run_settings;
mod web_path;

pub use component::{
    ComponentElement, Implementation, ImplementationKind, LoopElement, MisreadCount, PythonClass, Replicas, Row, Table,
};
pub use composite::{ComponentType, Composite, Include, SeverityRule, WireElement};
pub use contract::{
    Binding, Callback, Contract, InterfaceElement, InterfaceKind, Multiplicity, ReferenceElement, ServiceElement,
};
pub use contribution::{ClassFault, Contribution, LibraryLink, Link, Missing, Naming};
pub use http_address::{AddressFault, AddressHelp, HttpAddress};
pub use property::{ComponentProperty, Property, PropertyDetails, ValueDocument};
pub use run_settings::{Hangup, RunSettings};
pub use web_path::{RESERVED, WebPath};

use crate::source::{FileId, Location};
use crate::syntax::{Document, Element, ElementId};

/// The element that a part of the model was made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// The name in its start tag: where a diagnostic about the whole part points.
    pub tag: Location,
    /// The element in the document of the file.
    pub element: ElementId,
}

impl Origin {
    /// The origin of what is made from `element`.
    pub fn of(element: Element<'_>) -> Self {
        Self { tag: element.name_location(), element: element.id() }
    }

    /// The file.
    pub const fn file(self) -> FileId {
        self.tag.file
    }

    /// The element itself, in the document of the composite of the same file.
    pub fn element(self, document: &Document) -> Element<'_> {
        debug_assert_eq!(document.file(), self.file());
        document.element(self.element)
    }
}

/// A part of the model, which has an origin.
pub trait Part {
    /// The origin in its file.
    fn origin(&self) -> Origin;

    /// The name in its start tag.
    fn tag(&self) -> Location {
        self.origin().tag
    }
}

/// The namespace of what SAOMS adds to SCA.
pub const SAOMS_NAMESPACE: &str = "urn:saoms:1";

/// A version of SCA.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Version {
    /// SCA 1.0, by OSOA.
    Osoa10,
    /// The committee draft of SCA 1.1, by OASIS.
    Oasis200903,
    /// SCA 1.1, by OASIS.
    Oasis200912,
}

impl Version {
    /// All, the newest first.
    pub const ALL: [Self; 3] = [Self::Oasis200912, Self::Oasis200903, Self::Osoa10];

    /// The namespace of its vocabulary.
    pub const fn namespace(self) -> &'static str {
        match self {
            Self::Osoa10 => "http://www.osoa.org/xmlns/sca/1.0",
            Self::Oasis200903 => "http://docs.oasis-open.org/ns/opencsa/sca/200903",
            Self::Oasis200912 => "http://docs.oasis-open.org/ns/opencsa/sca/200912",
        }
    }

    /// The version of a namespace.
    pub fn from_namespace(namespace: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|version| version.namespace() == namespace)
    }

    /// True if it is 1.1, as a draft or as published.
    pub const fn is_1_1(self) -> bool {
        !matches!(self, Self::Osoa10)
    }

    /// The name that users know.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Osoa10 => "SCA 1.0",
            Self::Oasis200903 => "SCA 1.1 (draft)",
            Self::Oasis200912 => "SCA 1.1",
        }
    }
}
