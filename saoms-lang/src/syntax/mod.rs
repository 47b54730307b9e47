//! Composites as trees: XML 1.0 with namespaces, read by a parser that never fails.
//!
//! [`parse`] gives a lossless tree of any text and the list of its faults. The tokens of a text tile it, so every byte
//! is kept. Nothing is recursive, so depth costs no stack. Names and values stay in the text: the tree holds spans.
//!
//! The steps, each with a file: `lexer` cuts the text into tokens (quick-xml finds the ends of markup), `start_tag`
//! reads attributes (`slips` says where a damaged one ends), `nest` finds which end tag belongs to which start tag,
//! `resolve` binds prefixes to namespaces. Parts that are unreliable because of a fault are marked in the tree
//! ([`Element::is_damaged`]), so that no rule reports the same mistake a second time.

mod attribute;
mod characters;
mod document;
mod element;
mod element_text;
mod fault;
mod lexer;
mod nest;
mod prolog;
mod reference;
mod resolve;
mod slips;
mod start_tag;
#[cfg(test)]
mod tests;
mod unseen;
mod value;

use std::sync::Arc;

pub use attribute::Attribute;
pub(crate) use characters::{is_local_name, is_qualified_name};
pub use document::{Document, ElementId, TokenKind};
pub use element::Element;
pub use saoms_api::host::escaped;
pub(crate) use unseen::{hidden_in, is_unseen, looks_like, named};
pub(crate) use value::SourceMap;

use fault::Input;
use lexer::Lexer;

use crate::diagnostic::Diagnostic;
use crate::source::FileId;

/// The namespace to which the prefix `xml` is bound always.
pub const XML_NAMESPACE: &str = "http://www.w3.org/XML/1998/namespace";
/// The namespace of namespace declarations themselves.
pub const XMLNS_NAMESPACE: &str = "http://www.w3.org/2000/xmlns/";

/// A text as XML: its tree and all that is not well-formed in it.
#[derive(Debug)]
pub struct Parse {
    /// The tree, of any text.
    pub document: Document,
    /// The faults in the order of their places; at most 1,000.
    pub faults: Vec<Diagnostic>,
}

impl Parse {
    /// The tree of a well-formed text.
    ///
    /// # Errors
    /// The first fault of any other text.
    pub fn well_formed(self) -> Result<Document, Box<Diagnostic>> {
        match self.faults.into_iter().next() {
            Some(fault) => Err(Box::new(fault)),
            None => Ok(self.document),
        }
    }
}

/// Reads a text of less than 4 GiB as XML 1.0 with namespaces. It is well-formed when there is no fault.
///
/// ```
/// use saoms_lang::{source::Sources, syntax};
///
/// let mut sources = Sources::new();
/// let file = sources.add("t", "<fleet size='2 &gt; 1'><robot name=a/>idle</fleet>");
/// let parse = syntax::parse(file, sources.get(file).text());
/// let fleet = parse.document.root();
/// assert_eq!(fleet.attribute("size").unwrap().value(), "2 > 1");
/// assert_eq!(fleet.text(), "idle");
/// assert_eq!(parse.faults[0].message, "the value of `name` is not in quotes");
/// assert_eq!(fleet.children().next().unwrap().attribute("name").unwrap().value(), "a");
/// ```
pub fn parse(file: FileId, text: &Arc<String>) -> Parse {
    let input = Input { file, text };
    let mut lexer = Lexer::new(input);
    lexer.run();
    characters::report_forbidden(&mut lexer);
    nest::nest(&mut lexer);
    let (namespaces, declared) = resolve::resolve(&mut lexer);
    let Lexer { mut tokens, mut elements, mut attributes, faults, .. } = lexer;
    // The tree stays as long as its fleet.
    tokens.shrink_to_fit();
    elements.shrink_to_fit();
    attributes.shrink_to_fit();
    let document = Document { file, text: Arc::clone(text), tokens, elements, attributes, namespaces, declared };
    Parse { document, faults: faults.into_sorted() }
}
