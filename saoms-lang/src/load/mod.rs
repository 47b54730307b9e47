//! From text to the model, with everything that is wrong in it.
//!
//! [`read`] reads a file and [`load_file`] makes a [`Composite`] of its text. All faults of the file are reported in
//! one run, faults of the XML and of the model side by side. Nothing beyond the one file is looked at:
//! [`contribution`](crate::contribution) finds what it names.

mod attributes;
mod children;
mod component;
mod component_type;
mod composite;
mod contract;
mod damage;
pub(crate) mod definitions;
pub(crate) mod description;
mod encoding;
mod other_words;
mod property;
pub(crate) mod read;
mod root;
mod run_settings;
#[cfg(test)]
mod tests;
pub mod vocabulary;
mod wrong_place;

use std::sync::Arc;

pub(crate) use children::renaming;
pub use component_type::load_component_type;
pub use encoding::by_its_bytes as wide_encoding;
pub(crate) use read::ReadContext;
pub use read::{MAX_SIZE, STANDARD_INPUT, missing_file_help, read, read_from};
pub(crate) use wrong_place::is_given_otherwise;

use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::model::{Composite, SeverityRule, Version};
use crate::source::{FileId, Sources, Span};
use crate::syntax::{self, ElementId, Parse};

/// Makes the model of a text that was read before: of all that can be understood, also when the text is no well-formed
/// XML, or has other errors. `None` when its root is no `composite`.
///
/// ```
/// use saoms_lang::{diagnostic::Diagnostics, load::load_file, source::Sources};
///
/// let text = r#"<composite xmlns="http://www.osoa.org/xmlns/sca/1.0" name="fleet" targetNamespace="urn:fleet">
///     <component name="Robot001"><implementation.java class="robot.Robot001"/></component>
/// </composite>"#;
/// let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
/// let file = sources.add("fleet.composite", text);
/// let fleet = load_file(file, &sources, &mut diagnostics).unwrap();
/// assert!(diagnostics.is_empty());
/// assert_eq!(fleet.components[0].class().unwrap(), &"robot.Robot001");
/// ```
pub fn load_file(file: FileId, sources: &Sources, diagnostics: &mut Diagnostics) -> Option<Composite> {
    let text = sources.get(file).text();
    if text.trim_start_matches('\u{feff}').trim().is_empty() {
        diagnostics.push(read::empty(file));
        return None;
    }
    let Parse { document, faults } = syntax::parse(file, text);
    if !faults.is_empty() {
        damage::add(&document, diagnostics);
    }
    let mut loader = Loader::new(Version::Osoa10, "", diagnostics);
    loader.faults = faults.iter().map(|fault| fault.location.span).collect();
    let composite = loader.root(document.root()).then(|| {
        let document = Arc::new(document);
        let composite = loader.composite(&document);
        loader.similar_namespaces(&document);
        composite
    });
    push_faults(faults, sources, diagnostics);
    encoding::contradiction(file, text).into_iter().for_each(|one| diagnostics.push(one));
    composite
}

/// Adds the faults of a text to what is wrong in the model of it.
fn push_faults(faults: Vec<Diagnostic>, sources: &Sources, diagnostics: &mut Diagnostics) {
    for fault in faults {
        if !contradicts(&fault, sources, diagnostics) {
            diagnostics.push(fault);
        }
    }
}

/// True if a fault is that an end tag does not fit a start tag, and the name of the start tag is reported, with that of
/// the end tag as the right one.
fn contradicts(fault: &Diagnostic, sources: &Sources, diagnostics: &Diagnostics) -> bool {
    if fault.code != &codes::XML_TAG_MISMATCH {
        return false;
    }
    let end = sources.snippet(fault.location);
    let right = end.strip_prefix("</").and_then(|name| name.strip_suffix('>')).unwrap_or(end).trim_end();
    let is_name = |one: &&Diagnostic| [&codes::UNKNOWN_ELEMENT, &codes::ROOT].contains(&one.code);
    diagnostics.iter().filter(is_name).any(|one| {
        let mut edits = one.suggestions.iter().flat_map(|suggestion| &suggestion.edits);
        fault.labels.iter().any(|label| label.location == one.location)
            && edits.any(|edit| edit.location == one.location && edit.replacement == right)
    })
}

/// An attribute that is not read, since its namespace is only nearly that of SAOMS.
struct PassedOver {
    namespace: String,
    name: String,
    /// What it says, as in "its attribute `saoms:count` ...".
    meaning: &'static str,
}

/// The state that the parts of the loader share.
struct Loader<'d> {
    version: Version,
    /// The namespace that counts as that of SCA: that of the version, but for a root in an unknown one.
    namespace: String,
    diagnostics: &'d mut Diagnostics,
    /// The attributes of SCA 1.1 in a file of 1.0 that were reported.
    newer: Vec<&'static str>,
    /// The misspelt attributes that were reported: their elements, the names that are meant, and those that are
    /// written.
    meant: Vec<(ElementId, &'static str, String)>,
    /// The attributes of the element at hand that it cannot have, which is an error.
    refused: Vec<Span>,
    /// The first attribute without which there is another fleet, and that is passed over for its namespace.
    passed_over: Option<PassedOver>,
    /// The places of the faults of the text.
    faults: Vec<Span>,
    /// The severity settings.
    severities: Vec<SeverityRule>,
}

impl<'d> Loader<'d> {
    /// For one document.
    fn new(version: Version, namespace: &str, diagnostics: &'d mut Diagnostics) -> Self {
        Self {
            version,
            namespace: namespace.to_owned(),
            diagnostics,
            newer: Vec::new(),
            meant: Vec::new(),
            refused: Vec::new(),
            passed_over: None,
            faults: Vec::new(),
            severities: Vec::new(),
        }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}
