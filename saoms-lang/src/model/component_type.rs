//! Component types: what a file beside an implementation says about it.

use std::sync::Arc;

use super::origin::parts;
use super::{Origin, Property, ReferenceElement, ServiceElement, Version};
use crate::syntax::Document;

/// Component types: services, references and properties of an implementation, as a `.componentType` file states them.
#[derive(Clone, Debug)]
pub struct ComponentType {
    /// The origin in its file.
    pub origin: Origin,
    /// The whole document.
    pub document: Arc<Document>,
    /// The version of SCA that its namespace stands for.
    pub version: Version,
    /// Its services in order.
    pub services: Vec<ServiceElement>,
    /// Its references in order.
    pub references: Vec<ReferenceElement>,
    /// Its properties in order; a value is the default of components.
    pub properties: Vec<Property>,
}

parts!(ComponentType);
