//! Properties of components and composites.

use std::sync::Arc;

use super::Origin;
use super::details::details;
use super::origin::parts;
use crate::source::{Located, Text};
use crate::syntax::{Document, ElementId};

/// A property: of a component, where it gives a value, or of a composite, where it is declared.
///
/// A well-made one has its value in one way alone; the model keeps all that the file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// The origin in its file.
    pub origin: Origin,
    /// `name`; empty, at the tag, when the file has none.
    pub name: Text,
    /// The value as an attribute; where there is none, the text inside.
    pub(crate) simple: Option<Text>,
    /// True if that is the attribute.
    pub(crate) is_attribute: bool,
    /// Rarely needed fields, boxed; the methods give them.
    pub details: Option<Box<PropertyDetails>>,
}

details! {
    /// Rarely needed fields of properties.
    PropertyDetails of Property {
        /// The text inside, where there is an attribute `value`, too.
        hidden inside: Text,
        /// `type`: the QName of an XML Schema type.
        optional r#type: Text,
        /// `element`: the QName of a global XML Schema element.
        optional element: Text,
        /// `many`: whether it can have several values.
        copied many: Located<bool>,
        /// `mustSupply`, of a composite's property.
        copied must_supply: Located<bool>,
        /// `source`: where in a composite's property the value comes from, as `$currency` or `$order/total`.
        optional source: Text,
        /// `file`: a file that holds the value.
        optional file: Text,
        /// `env`, in the namespace of SAOMS, of a composite's property: an environment variable that holds the value.
        optional env: Text,
        /// The content of that file; `None` until [`read_values`](crate::contribution::read_values), and where it
        /// cannot be read.
        optional from_file: Text,
        /// The same, where it is XML that is more than a text.
        optional document: ValueDocument,
        /// Its `<value>` elements.
        list values: ComponentProperty,
        /// Other elements inside: a complex value.
        list content: ElementId,
    }
}

/// The XML of a file that a property takes its value from.
#[derive(Clone, Debug)]
pub struct ValueDocument {
    /// All of it.
    pub document: Arc<Document>,
    /// True if its root is `values` of SCA, which holds each value in an element.
    pub is_list: bool,
}

impl PartialEq for ValueDocument {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.document, &other.document)
    }
}

/// A `<value>` of a property.
#[derive(Clone, Debug, PartialEq)]
pub struct ComponentProperty {
    /// The origin in its file.
    pub origin: Origin,
    /// The text inside, trimmed; empty, at the end of the start tag, when there is none.
    pub text: Text,
    /// Elements inside: a complex value.
    pub content: Vec<ElementId>,
}

parts!(Property, ComponentProperty);

impl Property {
    /// `value`: the value as an attribute.
    pub fn value(&self) -> Option<&Text> {
        self.simple.as_ref().filter(|_| self.is_attribute)
    }

    /// The text inside, trimmed; `None` when there is none but white space.
    pub fn text(&self) -> Option<&Text> {
        if self.is_attribute { self.details.as_ref()?.inside.as_ref() } else { self.simple.as_ref() }
    }

    /// Every simple value that is given, in the order attribute, text, `<value>` elements.
    pub fn simple_values(&self) -> impl Iterator<Item = &Text> {
        let listed = self.values().iter().filter(|value| value.content.is_empty()).map(|value| &value.text);
        self.value().into_iter().chain(self.text()).chain(listed)
    }

    /// The one simple value, when exactly one is given and it stands in the property itself.
    pub fn simple_value(&self) -> Option<&Text> {
        let mut all = self.simple_values();
        let first = all.next()?;
        (all.next().is_none() && self.content().is_empty()).then_some(first)
    }

    /// The one text that it gives directly, where it gives nothing else and leads nowhere: what most properties are.
    pub(crate) fn only_text(&self) -> Option<&Text> {
        if self.details.is_none() { self.simple.as_ref() } else { None }
    }

    /// True if the property gives a value in any way: directly, by `source`, or by `file`.
    pub fn has_value(&self) -> bool {
        self.simple.is_some()
            || !self.values().is_empty()
            || !self.content().is_empty()
            || self.source().is_some()
            || self.file().is_some()
    }
}
