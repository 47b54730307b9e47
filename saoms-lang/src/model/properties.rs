//! The properties of components.

use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, OnceLock};

use smol_str::SmolStr;

use super::{Copied, Place, Property};
use crate::hash::Set;
use crate::source::{Location, Span, Text};
use crate::xml::{Document, Element, ElementId};

/// The properties of a component, in order: a list of [`Property`].
///
/// Most components of a large file are written as one before them, but for names and values. Theirs become a list when somebody looks at it:
/// until then it is known where they are written, which takes a tenth of the memory.
///
/// ```
/// use saoms_lang::{diagnostic::Diagnostics, load::load_file, source::Sources};
///
/// let text = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet" targetNamespace="urn:fleet">
///     <component name="Robot001"><implementation.rust class="saoms.Robot"/><property name="ID" value="R1"/></component>
///     <component name="Robot002"><implementation.rust class="saoms.Robot"/><property name="ID" value="R2"/></component>
/// </composite>"#;
/// let mut sources = Sources::new();
/// let file = sources.add("fleet.composite", text);
/// let fleet = load_file(file, &sources, &mut Diagnostics::new()).unwrap();
/// for (component, id) in fleet.components.iter().zip(["R1", "R2"]) {
///     assert_eq!(component.properties.len(), 1);
///     assert_eq!(component.properties[0].value().unwrap(), &id);
/// }
/// ```
#[derive(Clone)]
pub struct Properties(Kept);

#[derive(Clone)]
enum Kept {
    List(Vec<Property>),
    Placed(Box<Placed>),
}

impl Properties {
    /// Those of an element in which they stand as a pattern says.
    pub(crate) fn placed(pattern: &Arc<Pattern>, element: Element<'_>) -> Self {
        let (element, value) = (element.id(), element.first_value());
        Self(Kept::Placed(Box::new(Placed {
            pattern: Arc::clone(pattern),
            element,
            value,
            made: OnceLock::new(),
        })))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match &self.0 {
            Kept::List(list) => list.len(),
            Kept::Placed(placed) => placed.pattern.properties.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where they stand, for those that are no list yet.
    pub(crate) fn as_placed(&self) -> Option<&Placed> {
        match &self.0 {
            Kept::List(_) => None,
            Kept::Placed(placed) => Some(placed),
        }
    }
}

impl Default for Properties {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl From<Vec<Property>> for Properties {
    fn from(list: Vec<Property>) -> Self {
        Self(Kept::List(list))
    }
}

impl Deref for Properties {
    type Target = Vec<Property>;

    fn deref(&self) -> &Vec<Property> {
        match &self.0 {
            Kept::List(list) => list,
            Kept::Placed(placed) => placed.made.get_or_init(|| placed.pattern.make(placed.element)),
        }
    }
}

impl DerefMut for Properties {
    fn deref_mut(&mut self) -> &mut Vec<Property> {
        if let Kept::Placed(placed) = &mut self.0 {
            let made = placed.made.take().unwrap_or_else(|| placed.pattern.make(placed.element));
            self.0 = Kept::List(made);
        }
        match &mut self.0 {
            Kept::List(list) => list,
            // What was no list was made one above.
            Kept::Placed(_) => unreachable!("properties that were placed are a list"),
        }
    }
}

impl<'p> IntoIterator for &'p Properties {
    type Item = &'p Property;
    type IntoIter = std::slice::Iter<'p, Property>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl PartialEq for Properties {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for Properties {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(out)
    }
}

/// The properties of a component whose parts stand as in another one.
#[derive(Clone)]
pub(crate) struct Placed {
    pattern: Arc<Pattern>,
    element: ElementId,
    /// The first of the values of the component in its document.
    value: u32,
    made: OnceLock<Vec<Property>>,
}

impl Placed {
    /// Where they stand in each such component.
    pub(crate) fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// The value of a property as it is written, and where; `None` where it is a text with more than letters in it.
    #[inline]
    pub(crate) fn raw(&self, property: &Pair) -> Option<(&str, Location)> {
        let nth = match property.value {
            Value::Attribute(place) => place.nth,
            Value::Text(nth) => nth?,
        };
        let document = &*self.pattern.document;
        let Span { start, end } = document.values_from(self.value)[nth as usize];
        let mut raw = &document.text()[start as usize..end as usize];
        if let Value::Text(_) = property.value {
            // It starts with no white space.
            raw = raw.trim_ascii_end();
        }
        let span = Span::new(start, start + raw.len() as u32);
        Some((raw, span.in_file(document.file())))
    }

    /// The value of a property.
    pub(crate) fn text(&self, property: &Pair) -> Option<Text> {
        property.value.text(&Copied::new(self.pattern.document.element(self.element)), property.name_at)
    }
}

/// Where the properties of components stand that are written alike, each with a name of its own and a text.
pub(crate) struct Pattern {
    document: Arc<Document>,
    properties: Vec<Pair>,
    /// Whether each name is there once.
    has_distinct_names: bool,
    /// The bits of the places of all names; `None` where some have none.
    names: Option<u64>,
}

/// A property with its value.
pub(crate) struct Pair {
    pub(crate) name: SmolStr,
    pub(crate) name_at: Place,
    pub(crate) value: Value,
}

impl Pattern {
    pub(crate) fn new(document: &Arc<Document>, properties: Vec<Pair>) -> Self {
        let mut names = Set::default();
        let has_distinct_names = properties.iter().all(|one| names.insert(one.name.as_str()));
        let bits = properties.iter().map(|one| Some(one.name_at.bit).filter(|bit| *bit != 0));
        let names = bits.reduce(|all, bit| Some(all? | bit?)).unwrap_or(Some(0));
        Self { document: Arc::clone(document), properties, has_distinct_names, names }
    }

    /// The properties in order.
    pub(crate) fn properties(&self) -> &[Pair] {
        &self.properties
    }

    /// Whether each name is there once.
    pub(crate) fn has_distinct_names(&self) -> bool {
        self.has_distinct_names
    }

    /// Whether all names are as in the component before, of which these values are the same.
    pub(crate) fn has_names_of(&self, same: u64) -> bool {
        self.names.is_some_and(|names| names & !same == 0)
    }

    /// Whether properties are called as it says.
    pub(crate) fn names(&self, properties: &[Property]) -> bool {
        self.properties.iter().map(|one| &one.name).eq(properties.iter().map(|one| &one.name.value))
    }

    /// The properties of the component that an element is.
    pub(crate) fn make(&self, element: ElementId) -> Vec<Property> {
        let component = Copied::new(self.document.element(element));
        let made = self.properties.iter().map(|one| Property {
            origin: component.origin(one.name_at),
            name: component.attribute(one.name_at).trimmed(),
            simple: one.value.text(&component, one.name_at),
            is_attribute: matches!(one.value, Value::Attribute(_)),
            details: None,
        });
        made.collect()
    }
}

/// Where a property has its value.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Value {
    Attribute(Place),
    /// In the text of its element: among the values of the component, where it is one piece.
    Text(Option<u32>),
}

impl Value {
    /// The value of the property whose name is at a place of a component.
    fn text(&self, component: &Copied<'_>, name: Place) -> Option<Text> {
        match self {
            Self::Attribute(place) => Some(component.attribute(*place).trimmed()),
            Self::Text(_) => component.element().inner(name.element).trimmed_text(),
        }
    }
}
