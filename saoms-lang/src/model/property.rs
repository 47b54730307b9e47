//! Properties of components and composites.

use std::sync::Arc;

use super::Origin;
use crate::source::{Located, Text};
use crate::syntax::{Document, ElementId};

/// Makes the struct of the fields that few elements have, and the methods that give them: `optional` ones by reference,
/// `copied` ones by value, and a `list` as a slice.
macro_rules! details {
    ($(#[$meta:meta])* $Details:ident of $Owner:ident {
        $($(#[$doc:meta])* $how:ident $field:ident: $Type:ty,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $Details {
            $($(#[$doc])* pub $field: details!(@type $how $Type),)*
        }

        impl $Owner {
            $(details!(@get $how $(#[$doc])* $field: $Type);)*
        }
    };
    (@type list $Type:ty) => { Vec<$Type> };
    (@type $how:ident $Type:ty) => { Option<$Type> };
    (@get optional $(#[$doc:meta])* $field:ident: $Type:ty) => {
        $(#[$doc])*
        pub fn $field(&self) -> Option<&$Type> {
            self.details.as_ref()?.$field.as_ref()
        }
    };
    (@get copied $(#[$doc:meta])* $field:ident: $Type:ty) => {
        $(#[$doc])*
        pub fn $field(&self) -> Option<$Type> {
            self.details.as_ref()?.$field
        }
    };
    (@get list $(#[$doc:meta])* $field:ident: $Type:ty) => {
        $(#[$doc])*
        pub fn $field(&self) -> &[$Type] {
            self.details.as_ref().map_or(&[], |details| &details.$field)
        }
    };
}

/// A property: of a component, where it gives a value, or of a composite, where it is declared.
///
/// A well-made one has its value in one way alone; the model keeps all that the file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// The origin in its file.
    pub origin: Origin,
    /// `name`; empty, at the tag, when the file has none.
    pub name: Text,
    /// `value`: the value as an attribute.
    pub value: Option<Text>,
    /// The text inside, trimmed; `None` when there is none but white space.
    pub text: Option<Text>,
    /// Rarely needed fields, boxed: a composite may have very many properties. The methods give them.
    pub details: Option<Box<PropertyDetails>>,
}

details! {
    /// Rarely needed fields of properties.
    PropertyDetails of Property {
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
    /// Every simple value that is given, in the order attribute, text, `<value>` elements.
    pub fn simple_values(&self) -> impl Iterator<Item = &Text> {
        let listed = self.values().iter().filter(|value| value.content.is_empty()).map(|value| &value.text);
        self.value.iter().chain(&self.text).chain(listed)
    }

    /// The one simple value, when exactly one is given and it stands in the property itself.
    pub fn simple_value(&self) -> Option<&Text> {
        let mut all = self.simple_values();
        let first = all.next()?;
        (all.next().is_none() && self.content().is_empty()).then_some(first)
    }

    /// The one text that it gives directly, where it gives nothing else and has no source, as most properties.
    pub(crate) fn only_text(&self) -> Option<&Text> {
        match (&self.value, &self.text, &self.details) {
            (Some(one), None, None) | (None, Some(one), None) => Some(one),
            _ => None,
        }
    }

    /// True if the property gives a value in any way: directly, by `source`, or by `file`.
    pub fn has_value(&self) -> bool {
        self.value.is_some()
            || self.text.is_some()
            || !self.values().is_empty()
            || !self.content().is_empty()
            || self.source().is_some()
            || self.file().is_some()
    }
}
