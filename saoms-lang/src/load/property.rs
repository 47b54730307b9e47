//! Properties.

use super::Loader;
use super::children::Family;
use super::vocabulary::{COMPONENT, COMPOSITE, Kind, OWN_ELEMENTS};
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::model::{ComponentProperty, Origin, Part, Property, PropertyDetails, SAOMS_NAMESPACE};
use crate::source::{Located, Span, Text};
use crate::syntax::{Element, ElementId};

impl Loader<'_> {
    pub(super) fn property(&mut self, element: Element<'_>, kind: &'static Kind) -> Property {
        self.check_attributes(element, kind);
        let name = self.name(element);
        let mut values = Vec::new();
        let mut content = Vec::new();
        for child in element.children() {
            let is_sca = child.namespace() == self.namespace;
            match child.local_name() {
                "value" if is_sca => values.push(value(child)),
                other if is_sca && self.is_slip(other) => {
                    if self.is_wrapper(child, kind) {
                        values.extend(child.children().map(value));
                        continue;
                    }
                    if self.unexpected(child, kind, Family::Sca) == Some("value") {
                        values.push(value(child));
                    }
                }
                // What is of SAOMS is no value of a user's.
                own if child.namespace() == SAOMS_NAMESPACE && OWN_ELEMENTS.contains(&own) => {
                    _ = self.unexpected(child, kind, Family::Own);
                }
                _ => content.push(child.id()),
            }
        }
        let mut text = element.trimmed_text();
        if let Some(first) = values.first()
            && let Some(span) = element.text_span()
        {
            text = None;
            let at = span.in_file(element.document().file());
            let message = format!("the property {} is given a value in two ways", quoted(&name));
            let one = Diagnostic::new(&codes::VALUE_IN_TWO_WAYS, at, message);
            self.report(one.label(first.tag(), "the other value").help("keep one of them"));
        }
        let value = self.optional(element, "value");
        let details = self.details(element, kind, values, content);
        let details = (details != PropertyDetails::default()).then(|| Box::new(details));
        Property { origin: Origin::of(element), name, value, text, details }
    }

    fn details(
        &mut self,
        element: Element<'_>,
        kind: &'static Kind,
        values: Vec<ComponentProperty>,
        content: Vec<ElementId>,
    ) -> PropertyDetails {
        // A property of a composite has none: one is reported, and not read.
        let has_file = kind.attributes.iter().any(|known| known.name == "file");
        let (r#type, of) = (self.optional(element, "type"), self.optional(element, "element"));
        PropertyDetails {
            r#type,
            element: of,
            many: self.boolean(element, "many"),
            must_supply: self.boolean(element, "mustSupply"),
            source: self.optional(element, "source"),
            file: if has_file { self.optional(element, "file") } else { None },
            env: self.variable(element, "env"),
            from_file: None,
            document: None,
            values,
            content,
        }
    }

    /// The name of an environment variable. What no program can set is reported.
    pub(super) fn variable(&mut self, element: Element<'_>, attribute: &str) -> Option<Text> {
        let named = self.own(element, attribute)?;
        let is_name = |name: &str| {
            let is_letter = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
            name.chars().all(is_letter) && !name.starts_with(|letter: char| letter.is_ascii_digit())
        };
        if is_name(&named) {
            return Some(named);
        }
        let attribute = element.attribute_in(SAOMS_NAMESPACE, attribute)?;
        let message = format!(
            "{} is not a name of an environment variable: use letters, digits and `_`, and no digit first",
            quoted(&named)
        );
        self.value_fault(attribute, message, named.strip_prefix('$').filter(|name| is_name(name)));
        None
    }

    /// True if an element of SCA in a property is a mistake. Any other is a value of the user's own, since a default
    /// namespace makes those elements of SCA too.
    fn is_slip(&self, name: &str) -> bool {
        let structural = [&COMPOSITE, &COMPONENT].into_iter().flat_map(|kind| kind.children);
        let is_structural = |known: &&str| *known == name || known.ends_with('.') && name.starts_with(known);
        structural.into_iter().any(is_structural) || (self.version.is_1_1() && nearest(name, ["value"]).is_some())
    }
}

fn value(element: Element<'_>) -> ComponentProperty {
    let at = Span::empty(element.start_tag_span().end).in_file(element.document().file());
    let text = element.trimmed_text().unwrap_or_else(|| -> Text { Located::new("".into(), at) });
    let content = element.children().map(Element::id).collect();
    ComponentProperty { origin: Origin::of(element), text, content }
}
