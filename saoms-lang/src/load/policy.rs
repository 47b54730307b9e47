//! Elements of SCA that the model does not keep, and the names of intents and policy sets.

use super::Loader;
use super::attributes::is_first;
use super::vocabulary::{EXTENSIONS, INTENTS, OPERATION, POLICY_SET};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::OutsideKind;
use crate::source::{Location, Text};
use crate::xml::{Attribute, Element};

impl Loader<'_> {
    /// Checks an element that stands beside the parts of the model: whether this version has it, and what it has to say.
    pub(super) fn beside(&mut self, element: Element<'_>) {
        self.of_version(element);
        match element.local_name() {
            "requires" => {
                self.parts_of(element, &INTENTS);
                match element.attribute("intents") {
                    // The schema lets the list be empty.
                    Some(_) => {
                        for name in self.list(element, "intents") {
                            self.outside(element, &name, OutsideKind::Intent);
                        }
                    }
                    None => _ = self.required(element, "intents"),
                }
            }
            "policySetAttachment" => {
                self.parts_of(element, &POLICY_SET);
                if let Some(name) = self.required(element, "name") {
                    self.outside(element, &name, OutsideKind::PolicySet);
                }
            }
            "operation" => {
                self.name(element);
                self.no_text(element);
                self.leaf(element, &OPERATION);
            }
            "extensions" => self.parts_of(element, &EXTENSIONS),
            _ => {}
        }
    }

    /// Warns of what cannot be a name with a prefix (QName, Namespaces in XML 1.0, 4).
    pub(super) fn prefixed_name(&mut self, name: &Text) {
        let is_name = |part: &str| part.starts_with(is_first) && part.chars().all(is_in_name);
        let mut parts = name.split(':');
        let is_well_made = parts.next().is_some_and(is_name) && parts.next().is_none_or(is_name);
        if is_well_made && parts.next().is_none() || name.contains("${") {
            return;
        }
        let message = format!("{} is no name with a prefix", quoted(name));
        self.no_xml(
            name.location,
            message,
            "write `prefix:name`, with a prefix that is bound to the namespace",
        );
    }

    /// Warns of a name of a binding that is none of XML. In SCA 1.0 it can have a prefix.
    pub(super) fn binding_name(&mut self, name: &Text, attribute: Attribute<'_>) {
        let is_inner = |letter: char| is_in_name(letter) || letter == ':' && !self.version.is_1_1();
        if name.starts_with(is_first) && name.chars().all(is_inner) || name.contains("${") {
            return;
        }
        let (message, at) = match name.as_str() {
            // Nothing can be seen between two quotes.
            "" => ("the name of a binding is empty".to_owned(), attribute.location()),
            _ => (format!("{} is no name of XML", quoted(name)), name.location),
        };
        self.no_xml(at, message, "a name is letters, digits, `_`, `-` and `.`");
    }

    fn no_xml(&mut self, at: Location, message: String, help: &str) {
        if self.diagnostics.skip(&codes::ATTRIBUTE_VALUE, Severity::Warning, at) {
            return;
        }
        let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, at, message);
        self.report(one.severity(Severity::Warning).help(help).help("other programs refuse it"));
    }
}

fn is_in_name(letter: char) -> bool {
    letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.') || !letter.is_ascii()
}
