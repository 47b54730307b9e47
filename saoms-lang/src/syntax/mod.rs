//! Composites as trees: XML 1.0 with namespaces, read by a parser that never fails.
//!
//! [`parse`] gives a lossless tree of any text and the list of its faults. The tokens of a text tile it, so every byte
//! is kept. Nothing is recursive, so depth costs no stack. Names and values stay in the text: the tree holds spans.
//!
//! The steps, each with a file: `lexer` cuts the text into tokens (quick-xml finds the ends of markup), `start_tag`
//! reads attributes, `nest` finds which end tag belongs to which start tag, `resolve` binds prefixes to namespaces.
//! What cannot be relied on behind a fault is marked in the tree ([`Element::is_damaged`]), so that nobody reports the
//! same mistake a second time.

mod attribute;
mod characters;
mod document;
mod element;
mod element_text;
mod escape;
mod fault;
mod lexer;
mod names;
mod namespaces;
mod nest;
mod parse;
mod prolog;
mod reference;
mod resolve;
mod start_tag;
#[cfg(test)]
mod tests;
mod token;
mod value;
mod writer;

pub use attribute::Attribute;
pub use document::{Document, ElementId};
pub use element::Element;
pub use escape::escaped;
pub(crate) use names::{is_local_name, is_qualified_name};
pub use parse::{Parse, parse};
pub use token::TokenKind;
pub(crate) use value::SourceMap;
pub use writer::NewElement;

/// The namespace to which the prefix `xml` is bound always.
pub const XML_NAMESPACE: &str = "http://www.w3.org/XML/1998/namespace";
/// The namespace of namespace declarations themselves.
pub const XMLNS_NAMESPACE: &str = "http://www.w3.org/2000/xmlns/";
