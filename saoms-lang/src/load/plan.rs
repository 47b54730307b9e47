//! Plans: where the parts of a component are in its element.
//!
//! Most components of a large file are of one form: written as one before them but for values and texts. Of the first of a form that says
//! what most say, and has nothing to be told of, the loader keeps where each part stands. The others are put together by that, where their
//! values need no closer look either.

use std::sync::Arc;

use super::Loader;
use crate::model::{
    Component, Composite, Copied, Implementation, ImplementationKind, Pair, Pattern, Place, Policy,
    Properties, Property, Reference, Service, Value,
};
use crate::source::{Located, Text};
use crate::xml::{Alike, Attribute, Document, Element, ElementId};

/// What the components of one form consist of.
struct Plan {
    /// The last of them among the components of the composite; `None` where that was read part by part.
    last: Option<usize>,
    name: Place,
    class: Place,
    /// Where its properties are, and whether those of the last one are called as it says.
    pattern: Arc<Pattern>,
    has_names: bool,
    services: Vec<Place>,
    references: Vec<(Place, Option<Place>)>,
    /// All names, its own included.
    names: Vec<Place>,
}

/// What is known of a form.
enum Known {
    /// None of it was read yet that is nothing to be told of.
    Nothing,
    /// Those of it are read part by part.
    Irregular,
    Regular(Plan),
}

/// What is known of the forms of a document.
#[derive(Default)]
pub(super) struct Plans(Vec<Known>);

/// How much the loader has told and noted so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Told([usize; 5]);

impl Plans {
    /// Makes the component of an element as the last one of its form. `None` where its parts are to be looked at one by one.
    pub(super) fn make(
        &mut self,
        alike: Alike,
        element: Element<'_>,
        composite: &Composite,
    ) -> Option<Component> {
        let Known::Regular(plan) = self.0.get_mut(alike.form as usize)? else { return None };
        let last = plan.last.take().and_then(|last| composite.components.get(last))?;
        let made = plan.make(&Next { copy: Copied::new(element), alike, last })?;
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
        number: u32,
        place: usize,
        (element, read): (Element<'_>, &Component),
        document: &Arc<Document>,
    ) {
        let form = number as usize;
        if plans.0.len() <= form {
            plans.0.resize_with(form + 1, || Known::Nothing);
        }
        match &mut plans.0[form] {
            Known::Regular(plan) => {
                // An expression in its name makes one a replica.
                plan.last = (read.details.is_none() && read.has_plain_parts).then_some(place);
                plan.has_names = plan.pattern.names(&read.properties);
            }
            new @ Known::Nothing if self.tangle.is_none() => {
                let plan = self.regular((number, element), read, place, document);
                *new = plan.map_or(Known::Irregular, Known::Regular);
            }
            _ => {}
        }
    }

    /// The plan of a component that has nothing but what most have.
    fn regular(
        &mut self,
        (form, element): (u32, Element<'_>),
        read: &Component,
        last: usize,
        document: &Arc<Document>,
    ) -> Option<Plan> {
        let Component {
            implementation,
            properties,
            services,
            references,
            details: None,
            has_plain_parts: true,
            ..
        } = read
        else {
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
        let mut place = |part: ElementId, names: &[&str], name: &str| {
            let part = element.document().element(part);
            let at = self.only_of(part, names, name)?;
            Some(Place::of(element, part, at))
        };
        let name = place(element.id(), &["name"], "name")?;
        let class = place(implementation.origin.element, &["class"], "class")?;
        let of_property = |one: &Property| {
            let at = one.origin.element;
            let name = one.name.value.clone();
            Some(if one.is_attribute {
                let names = ["name", "value"];
                let value = Value::Attribute(place(at, &names, "value")?);
                Pair { name, name_at: place(at, &names, "name")?, value }
            } else {
                let name_at = place(at, &["name"], "name")?;
                Pair { name, name_at, value: Value::Text(document.text_in(form, name_at.element)) }
            })
        };
        let properties: Vec<Pair> = properties.iter().map(of_property).collect::<Option<_>>()?;
        let of_service = |one: &Service| place(one.origin.element, &["name"], "name");
        let services: Vec<Place> = services.iter().map(of_service).collect::<Option<_>>()?;
        let of_reference = |one: &Reference| {
            let at = one.origin.element;
            let target = place(at, &["name", "target"], "target");
            let is_plain = target.is_some() != one.targets.is_empty();
            place(at, &["name", "target"], "name").filter(|_| is_plain).map(|name| (name, target))
        };
        let references: Vec<_> = references.iter().map(of_reference).collect::<Option<_>>()?;
        let mut names = vec![name];
        names.extend(properties.iter().map(|one| one.name_at));
        names.extend(&services);
        names.extend(references.iter().map(|(name, _)| *name));
        let pattern = Arc::new(Pattern::new(document, properties));
        Some(Plan { last: Some(last), name, class, pattern, has_names: true, services, references, names })
    }
}

/// An element that becomes a component as the last of its form did.
struct Next<'c> {
    copy: Copied<'c>,
    alike: Alike,
    last: &'c Component,
}

impl Plan {
    /// Whether a component of the form has nothing in other places than the last one that is to be told of, or read in another way.
    fn is_plain(&self, next: &Next<'_>) -> bool {
        let has_expression =
            |place| memchr::memchr(b'$', next.copy.attribute(place).raw_value().as_bytes()).is_some();
        let is_word = |place| next.copy.attribute(place).plain_word().is_some();
        let mut names = self.names.iter().filter(|place| !next.is_same(**place));
        names.all(|place| is_silent_name(next.copy.attribute(*place)))
            && (next.is_same(self.name) || !has_expression(self.name))
            && (next.is_same(self.class) || is_word(self.class))
            && self.references.iter().all(|(_, target)| target.is_none_or(is_word))
    }

    /// The properties of a component. Where some are called otherwise than in the first one they are a list at once.
    fn properties(&mut self, next: &Next<'_>) -> Properties {
        if self.pattern.properties().is_empty() {
            return Properties::default();
        }
        if self.has_names && self.pattern.has_names_of(next.alike.same) {
            return Properties::placed(&self.pattern, next.copy.element());
        }
        let made = self.pattern.make(next.copy.element().id());
        self.has_names = self.pattern.names(&made);
        made.into()
    }

    fn make(&mut self, next: &Next<'_>) -> Option<Component> {
        if !self.is_plain(next) {
            return None;
        }
        let properties = self.properties(next);
        let last = next.last;
        let class = Some(next.word(self.class, last.class()?));
        let kind = match &last.implementation.as_ref()?.kind {
            ImplementationKind::Java { .. } => ImplementationKind::Java { class },
            _ => ImplementationKind::Rust { class, library: None },
        };
        let services = self.services.iter().zip(&last.services).map(|(name, last)| Service {
            origin: next.copy.origin(*name),
            name: next.word(*name, &last.name),
            promote: None,
            contract: None,
        });
        let references = self.references.iter().zip(&last.references).map(|((name, target), last)| {
            let target = target.and_then(|target| Some(vec![next.word(target, last.targets.first()?)]));
            Reference {
                origin: next.copy.origin(*name),
                name: next.word(*name, &last.name),
                targets: target.unwrap_or_default(),
                details: None,
                contract: None,
            }
        });
        Some(Component {
            origin: next.copy.origin(self.name),
            name: next.word(self.name, &last.name),
            implementation: Some(Implementation {
                origin: next.copy.origin(self.class),
                kind,
                policy: Policy::NONE,
            }),
            properties,
            services: services.collect(),
            references: references.collect(),
            details: None,
            has_plain_parts: true,
        })
    }
}

/// Whether an attribute is a name of which nothing is told.
fn is_silent_name(attribute: Attribute<'_>) -> bool {
    let name = attribute.plain_name();
    name.is_some_and(|name| !starts_wrongly(name))
}

/// Whether a name starts with what can stand further behind in one alone (Namespaces in XML 1.0, production 4).
pub(super) fn starts_wrongly(name: &str) -> bool {
    matches!(name.as_bytes(), [b'0'..=b'9' | b'-' | b'.', ..])
}

impl Next<'_> {
    /// Whether the value at a place is as the last one had it.
    fn is_same(&self, place: Place) -> bool {
        self.alike.same & place.bit != 0
    }

    /// What stands at a place, white space at its ends left out.
    #[inline(always)]
    fn text(&self, place: Place, last: &Text) -> Text {
        let location = self.copy.value(place).in_file(last.location.file);
        match self.is_same(place) && location.span.len() == last.location.span.len() {
            true => Located::new(last.value.clone(), location),
            false => self.copy.attribute(place).trimmed(),
        }
    }

    /// The same for what was found to be a word where it differs.
    #[inline(always)]
    fn word(&self, place: Place, last: &Text) -> Text {
        match self.is_same(place) {
            true => self.text(place, last),
            false => {
                let attribute = self.copy.attribute(place);
                attribute.as_it_is(attribute.raw_value())
            }
        }
    }
}
