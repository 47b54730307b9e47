//! The SCA assembly model as one file states it: every name and value with its place.
//!
//! A [`Composite`] is what [`load`](crate::load) makes of one file. Nothing is resolved: includes, promotions, targets
//! and sources of properties are texts with places. Values that the file leaves out are `None` or empty, defaults are
//! for the checker to apply. Foreign elements and attributes are not copied: they are in the composite's
//! [`Document`](crate::syntax::Document), reached through each part's [`Origin`].

mod component;
mod component_type;
mod composite;
mod contract;
mod contribution;
mod details;
mod looping;
mod origin;
mod property;
mod replicas;
mod severity;
mod version;

pub use component::{ComponentDetails, ComponentElement, Implementation, ImplementationKind};
pub use component_type::ComponentType;
pub use composite::{Composite, Include, WireDetails, WireElement};
pub use contract::{
    Binding, Callback, Contract, InterfaceElement, InterfaceKind, Multiplicity, ReferenceDetails, ReferenceElement,
    ServiceElement,
};
pub use contribution::{Contribution, LibraryLink, Link, Missing, Naming};
pub use looping::LoopElement;
pub use origin::{Origin, Part};
pub use property::{ComponentProperty, Property, PropertyDetails, ValueDocument};
pub use replicas::{Replicas, Row, Table};
pub use severity::SeverityRule;
pub use version::{SAOMS_NAMESPACE, Version};
