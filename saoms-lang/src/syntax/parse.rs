//! The parser: from a text to its tree and its faults.

use std::sync::Arc;

use super::document::{Declared, Document};
use super::fault::Input;
use super::lexer::Lexer;
use super::{characters, nest, resolve};
use crate::diagnostic::Diagnostic;
use crate::source::FileId;

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
    let survey = characters::survey(text.as_bytes());
    let mut lexer = Lexer::new(input, &survey);
    lexer.run();
    if let Some(first) = survey.forbidden {
        characters::report(&mut lexer, first);
    }
    nest::nest(&mut lexer);
    let namespaces = resolve::resolve(&mut lexer);
    let Lexer { mut tokens, mut elements, mut attributes, faults, .. } = lexer;
    tokens.shrink_to_fit();
    elements.shrink_to_fit();
    attributes.shrink_to_fit();
    let document = Document {
        file,
        text: Arc::clone(text),
        tokens,
        elements,
        attributes,
        namespaces: namespaces.into_names(),
        declared: Declared::default(),
    };
    Parse { document, faults: faults.into_sorted() }
}
