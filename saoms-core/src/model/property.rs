//! Properties of components and composites.

use super::origin::parts;
use super::{Origin, Policy};
use crate::source::{Located, Location, Text};
use crate::xml::ElementId;

/// A property: of a component, where it gives a value, or of a composite, where it is declared.
///
/// A well-made one has its value in one way alone; the model keeps all that the file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// Where it comes from.
    pub origin: Origin,
    /// `name`; empty, at the tag, when the file has none.
    pub name: Text,
    /// `type`: the QName of an XML Schema type.
    pub r#type: Option<Text>,
    /// `element`: the QName of a global XML Schema element.
    pub element: Option<Text>,
    /// `many`: whether it can have several values.
    pub many: Option<Located<bool>>,
    /// `mustSupply`, of a composite's property.
    pub must_supply: Option<Located<bool>>,
    /// `source`: where in a composite's property the value comes from, as `$currency` or `$order/total`.
    pub source: Option<Text>,
    /// `file`: a file that holds the value.
    pub file: Option<Text>,
    /// `value`: the value as an attribute.
    pub value: Option<Text>,
    /// The text inside, trimmed; `None` when there is none but white space.
    pub text: Option<Text>,
    /// Its `<value>` elements.
    pub values: Vec<PropertyValue>,
    /// Other elements inside: a complex value.
    pub content: Vec<ElementId>,
    /// Intents and policy sets.
    pub policy: Policy,
}

/// A `<value>` of a property.
#[derive(Clone, Debug, PartialEq)]
pub struct PropertyValue {
    /// Where it comes from.
    pub origin: Origin,
    /// The text inside, trimmed; empty, at the end of the start tag, when there is none.
    pub text: Text,
    /// Elements inside: a complex value.
    pub content: Vec<ElementId>,
}

parts!(Property, PropertyValue);

impl Property {
    /// Every simple value that is given, in the order attribute, text, `<value>` elements.
    pub fn simple_values(&self) -> impl Iterator<Item = &Text> {
        let listed = self.values.iter().filter(|value| value.content.is_empty()).map(|value| &value.text);
        self.value.iter().chain(&self.text).chain(listed)
    }

    /// The one simple value, when exactly one is given and it stands in the property itself.
    pub fn simple_value(&self) -> Option<&Text> {
        let mut all = self.simple_values();
        let first = all.next()?;
        (all.next().is_none() && self.content.is_empty()).then_some(first)
    }

    /// Whether the property gives a value in any way: directly, by `source`, or by `file`.
    pub fn has_value(&self) -> bool {
        self.value.is_some()
            || self.text.is_some()
            || !self.values.is_empty()
            || !self.content.is_empty()
            || self.source.is_some()
            || self.file.is_some()
    }

    /// Where its value is, for a diagnostic about it; its tag when it has none.
    pub fn value_location(&self) -> Location {
        let first = self.simple_values().next().or(self.source.as_ref()).or(self.file.as_ref());
        first.map_or(self.origin.tag, |text| text.location)
    }
}
