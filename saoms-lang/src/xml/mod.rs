//! XML 1.0 with namespaces, read into a flat tree in which everything knows its place.
//!
//! The tree is an array of elements in document order; nothing of it is recursive, so depth costs no stack. Names and
//! values stay in the text: only spans are stored. Comments and processing instructions are checked and not kept.

mod arena;
mod attribute;
mod characters;
mod curly;
mod eight;
mod element;
mod escape;
mod fault;
mod form;
mod mend;
mod names;
mod namespaces;
mod node;
mod parse;
mod prolog;
mod reference;
mod shape;
mod slips;
mod tag;
mod tangle;
#[cfg(test)]
mod tests;
mod tree;
mod unbound;
mod value;

pub use attribute::Attribute;
pub use element::Element;
pub use escape::escaped;
pub(crate) use mend::{Mended, mend};
pub use node::Node;
pub use parse::{Parsed, Tangle, parse};
pub use tree::{Document, ElementId};
pub(crate) use value::Writing;

/// The namespace to which the prefix `xml` is bound always.
pub const XML_NAMESPACE: &str = "http://www.w3.org/XML/1998/namespace";
/// The namespace of namespace declarations themselves.
pub const XMLNS_NAMESPACE: &str = "http://www.w3.org/2000/xmlns/";
