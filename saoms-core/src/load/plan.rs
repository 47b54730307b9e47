//! Plans: where the parts of a component are in its element.
//!
//! Most components of a large file are of one form: written as one before them but for values and texts. Of the first of a form that says
//! what most say, and has nothing to be told of, the loader keeps where each part stands. The others are put together by that, where their
//! values need no closer look either.

use super::Loader;
use crate::model::{
    Component, Composite, Implementation, ImplementationKind, Origin, Policy, Property, Reference, Service,
};
use crate::source::{Located, Text};
use crate::xml::{Alike, Attribute, Document, Element, ElementId};

/// What the components of one form consist of.
#[derive(Debug)]
struct Plan {
    /// The last of them among the components of the composite; `None` where that was read part by part.
    last: Option<usize>,
    name: Place,
    class: Place,
    properties: Vec<(Place, Value)>,
    services: Vec<Place>,
    references: Vec<(Place, Option<Place>)>,
}

/// An attribute.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Its element, counted from that of the component.
    element: u32,
    /// Its place among the attributes of that.
    at: u32,
    /// Its bit among all of the component.
    bit: u64,
}

/// Where a property has its value.
#[derive(Clone, Copy, Debug)]
enum Value {
    Attribute(Place),
    /// In the text of its element.
    Text,
}

/// The plans of a document, by form.
#[derive(Debug, Default)]
pub(super) struct Plans(Vec<Option<Plan>>);

/// How much the loader has told and noted so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Told([usize; 5]);

impl Plans {
    /// Makes the component of an element as the last one of its form. `None` where its parts are to be looked at one by one.
    pub(super) fn make(
        &mut self,
        alike: Alike,
        document: &Document,
        composite: &Composite,
    ) -> Option<Component> {
        let plan = self.0.get_mut(alike.form as usize)?.as_mut()?;
        let last = plan.last.take().and_then(|last| composite.components.get(last))?;
        let made = plan.make(&Copy { alike, document, last })?;
        plan.last = Some(composite.components.len());
        Some(made)
    }
}

impl Loader<'_> {
    /// To find out later whether more was told or noted.
    pub(super) fn told(&self) -> Told {
        let Self { diagnostics, newer, severities, outside, .. } = self;
        let told = [diagnostics.iter().len(), diagnostics.errors() + diagnostics.warnings()];
        Told([told[0], told[1], newer.len(), severities.len(), outside.len()])
    }

    /// Takes the component at a place of its composite, which was read part by part, and of which nothing was told, for the last of its form.
    pub(super) fn plan(
        &mut self,
        plans: &mut Plans,
        form: u32,
        place: usize,
        (element, read): (Element<'_>, &Component),
    ) {
        let form = form as usize;
        if plans.0.len() <= form {
            plans.0.resize_with(form + 1, || None);
        }
        match &mut plans.0[form] {
            Some(plan) => plan.last = Some(place),
            None if self.tangle.is_some() => {}
            new => *new = self.regular(element, read, place),
        }
    }

    /// The plan of a component that has nothing but what most have.
    fn regular(&mut self, element: Element<'_>, read: &Component, last: usize) -> Option<Plan> {
        let Component { implementation, properties, services, references, details: None, .. } = read else {
            return None;
        };
        let implementation = implementation.as_ref().filter(|one| one.policy == Policy::NONE)?;
        let (ImplementationKind::Java { class: Some(_) }
        | ImplementationKind::Rust { class: Some(_), library: None }) = implementation.kind
        else {
            return None;
        };
        let count = element.descendants().count();
        if count != 2 + properties.len() + services.len() + references.len() {
            return None;
        }
        let first = element.id().0;
        let mut place = |part: ElementId, names: &[&str], name: &str| {
            let part = element.document().element(part);
            let at = self.only_of(part, names, name)?;
            let bit = 1_u64.checked_shl(part.values_behind(element) + at as u32).unwrap_or_default();
            Some(Place { element: part.id().0 - first, at: at as u32, bit })
        };
        let name = place(element.id(), &["name"], "name")?;
        let class = place(implementation.origin.element, &["class"], "class")?;
        let of_property = |one: &Property| {
            let at = one.origin.element;
            if one.details.is_some() || one.simple.is_none() {
                return None;
            }
            Some(if one.is_attribute {
                let names = ["name", "value"];
                (place(at, &names, "name")?, Value::Attribute(place(at, &names, "value")?))
            } else {
                (place(at, &["name"], "name")?, Value::Text)
            })
        };
        let properties = properties.iter().map(of_property).collect::<Option<_>>()?;
        let of_service = |one: &Service| {
            let is_plain = one.promote.is_none() && one.contract.is_none();
            place(one.origin.element, &["name"], "name").filter(|_| is_plain)
        };
        let services = services.iter().map(of_service).collect::<Option<_>>()?;
        let of_reference = |one: &Reference| {
            let at = one.origin.element;
            let target = place(at, &["name", "target"], "target");
            let is_plain =
                one.details.is_none() && one.contract.is_none() && target.is_some() != one.targets.is_empty();
            place(at, &["name", "target"], "name").filter(|_| is_plain).map(|name| (name, target))
        };
        let references = references.iter().map(of_reference).collect::<Option<_>>()?;
        Some(Plan { last: Some(last), name, class, properties, services, references })
    }
}

/// An element that becomes a component as the last of its form did.
struct Copy<'c> {
    alike: Alike,
    document: &'c Document,
    last: &'c Component,
}

impl Plan {
    fn make(&self, copy: &Copy<'_>) -> Option<Component> {
        let last = copy.last;
        let name = copy.name(self.name, &last.name)?;
        if memchr::memchr(b'$', name.as_bytes()).is_some() {
            return None;
        }
        let implementation = last.implementation.as_ref()?;
        let class = Some(copy.word(self.class, last.class()?)?);
        let kind = match &implementation.kind {
            ImplementationKind::Java { .. } => ImplementationKind::Java { class },
            _ => ImplementationKind::Rust { class, library: None },
        };
        let implementation = Implementation { origin: copy.origin(self.class), kind, policy: Policy::NONE };
        let mut properties = Vec::with_capacity(self.properties.len());
        for ((place, value), last) in self.properties.iter().zip(&last.properties) {
            let name = copy.name(*place, &last.name)?;
            let simple = match value {
                Value::Attribute(place) => copy.value(*place, last.simple.as_ref()?),
                Value::Text => copy.element(*place).trimmed_text()?,
            };
            let (origin, is_attribute) = (copy.origin(*place), last.is_attribute);
            properties.push(Property { origin, name, simple: Some(simple), is_attribute, details: None });
        }
        let mut services = Vec::with_capacity(self.services.len());
        for (place, last) in self.services.iter().zip(&last.services) {
            let (origin, name) = (copy.origin(*place), copy.name(*place, &last.name)?);
            services.push(Service { origin, name, promote: None, contract: None });
        }
        let mut references = Vec::with_capacity(self.references.len());
        for ((place, target), last) in self.references.iter().zip(&last.references) {
            let (origin, name) = (copy.origin(*place), copy.name(*place, &last.name)?);
            let targets = match target {
                Some(target) => vec![copy.word(*target, last.targets.first()?)?],
                None => Vec::new(),
            };
            references.push(Reference { origin, name, targets, details: None, contract: None });
        }
        let (origin, implementation) = (copy.origin(self.name), Some(implementation));
        Some(Component { origin, name, implementation, properties, services, references, details: None })
    }
}

impl Copy<'_> {
    fn element(&self, place: Place) -> Element<'_> {
        self.document.element(ElementId(self.alike.element.0 + place.element))
    }

    fn origin(&self, place: Place) -> Origin {
        Origin::of(self.element(place))
    }

    fn attribute(&self, place: Place) -> Attribute<'_> {
        self.element(place).nth_attribute(place.at as usize)
    }

    /// What the last one had at this place, where it is the same and had no white space around it.
    #[inline]
    fn again(&self, place: Place, last: &Text) -> Option<Text> {
        if self.alike.same & place.bit == 0 {
            return None;
        }
        let location = self.attribute(place).value_location();
        let is_whole = location.span.len() == last.location.span.len();
        is_whole.then(|| Located::new(last.value.clone(), location))
    }

    /// A name that is told nothing of.
    #[inline]
    fn name(&self, place: Place, last: &Text) -> Option<Text> {
        self.again(place, last).or_else(|| {
            let attribute = self.attribute(place);
            let name = attribute.plain_name()?;
            let is_told = matches!(name.as_bytes(), [b'0'..=b'9' | b'-' | b'.', ..]);
            (!is_told).then(|| attribute.as_it_is(name))
        })
    }

    /// A value of one word.
    #[inline]
    fn word(&self, place: Place, last: &Text) -> Option<Text> {
        self.again(place, last).or_else(|| self.attribute(place).only_word())
    }

    #[inline]
    fn value(&self, place: Place, last: &Text) -> Text {
        self.again(place, last).unwrap_or_else(|| self.attribute(place).trimmed())
    }
}
