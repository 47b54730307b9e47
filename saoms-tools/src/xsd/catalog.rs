//! A catalog of the files that describe namespaces.

use super::XsdSchema;
use super::node::{Documented, NewElement};

/// An XML catalog (OASIS XML Catalogs 1.1) by which an editor finds the schema of a file from the namespace of its
/// root.
pub fn catalog(schemas: &[XsdSchema]) -> String {
    let entry = |schema: &XsdSchema| NewElement::new("uri").with("name", schema.namespace).with("uri", schema.file);
    NewElement::new("catalog")
        .with("xmlns", "urn:oasis:names:tc:entity:xmlns:xml:catalog")
        .children(schemas.iter().map(entry))
        .document()
}
